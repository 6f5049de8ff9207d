"""Frames of the page of `hydrostat share` while a marker is dragged, in Chromium without a graphics card.

Each frame solves for contractions, computes all points and draws. Prints times of the work in a frame, which 60 frames
a second allow 16.7 ms, and the frames that the browser showed. Arguments: robots of the gallery.
"""

import argparse
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from machine import machine
from playwright.sync_api import sync_playwright

from hydrostat.robot import load_robot
from hydrostat.simulation import Simulation
from hydrostat.toy import learn_shape, sample_shapes, toy_page

DRAG = """async (seconds) => {
  const { model, reach, data, shown } = toy, { sight } = shown();
  const [, first] = data.groups.find(([kind]) => kind === "marker");
  const canvas = document.getElementById("above"), box = canvas.getBoundingClientRect();
  const send = (kind, x, y) => canvas.dispatchEvent(new PointerEvent(kind,
    { pointerId: 1, clientX: box.left + x, clientY: box.top + y, bubbles: true }));
  canvas.setPointerCapture = () => {};
  const ask = window.requestAnimationFrame, work = [];
  window.requestAnimationFrame = (call) => ask((now) => {
    const begin = performance.now();
    call(now);
    work.push(performance.now() - begin);
  });
  const [x, y] = sight.see(shown().points, data.dim * first);
  send("pointerdown", x, y);
  const began = performance.now();
  let frames = 0;
  while (performance.now() - began < 1000 * seconds) {
    const angle = (performance.now() - began) / 300;
    send("pointermove", x + 40 * Math.sin(angle), y + 40 * Math.sin(1.7 * angle));
    await new Promise((done) => ask(done));
    frames++;
  }
  send("pointerup", x, y);
  return { work, frames: frames / seconds };
}"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robots", nargs="*", default=["starfish", "cupping_hand"])
    parser.add_argument("--samples", type=int, default=60, help="poses to learn from; the size of the page is the same")
    parser.add_argument("--seconds", type=float, default=4.0)
    given = parser.parse_args()
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if not chromium:
        raise SystemExit("there is no Chromium; install Debian's package chromium")
    print(machine())
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        browser = playwright.chromium.launch(
            executable_path=chromium, args=["--no-sandbox", "--enable-unsafe-swiftshader"]
        )
        for name in given.robots:
            robot = replace(load_robot(f"gallery:{name}"), poses={})
            shape = learn_shape(sample_shapes(robot, given.samples), Simulation(robot).rest.nodes, steps=500)
            file = Path(folder) / f"{name}.html"
            text = toy_page(robot, shape)
            file.write_text(text, encoding="utf-8")
            for width, height in ((1280, 800), (390, 844)):
                page = browser.new_page(viewport={"width": width, "height": height})
                page.goto(file.as_uri())
                found = page.evaluate(DRAG, given.seconds)
                page.close()
                middle, slow = np.quantile(found["work"], (0.5, 0.95))
                print(
                    f"{name} {width} x {height}: {len(text) / 1e6:.2f} MB, median {middle:.1f} ms of work a frame, "
                    f"95 % below {slow:.1f} ms, {found['frames']:.0f} frames/s shown"
                )
        browser.close()


if __name__ == "__main__":
    main()
