"""Frames of the page of `hydrostat share` while a marker is dragged, in Chromium without a graphics card.

Each frame solves for contractions, computes all points and draws. Prints processor times of a frame: of the page's
script, of its thread (script, layout, painting), and of the process that draws pixels in software, which a graphics
card would do; 60 frames a second allow 16.7 ms. Then the frames that the browser showed, and its wall time of the work
in a frame. Arguments: robots of the gallery.
"""

import argparse
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from machine import machine
from playwright.sync_api import CDPSession, Page, sync_playwright

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


def read_times(page: CDPSession, browser: CDPSession) -> np.ndarray:
    """Processor times until now of the script, of its thread and of the process that draws [s]."""
    told = {each["name"]: each["value"] for each in page.send("Performance.getMetrics")["metrics"]}
    processes = browser.send("SystemInfo.getProcessInfo")["processInfo"]
    drawing = sum(each["cpuTime"] for each in processes if each["type"] == "GPU")
    return np.array([told["ScriptDuration"], told["TaskDuration"], drawing])


def measure(page: Page, browser: CDPSession, seconds: float) -> str:
    """Drag a marker; what a frame took, in words."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    page.evaluate(DRAG, 1.0)  # compiles the script
    before = read_times(session, browser)
    found = page.evaluate(DRAG, seconds)
    script, thread, drawing = 1e3 * (read_times(session, browser) - before) / len(found["work"])
    middle, slow = np.quantile(found["work"], (0.5, 0.95))
    return (
        f"script {script:.1f} ms, thread {thread:.1f} ms, drawing {drawing:.1f} ms of processor a frame; "
        f"{found['frames']:.0f} frames/s shown, work a frame {middle:.1f} ms, 95 % below {slow:.1f} ms"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robots", nargs="*", default=["starfish", "extended_hand"])
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
        session = browser.new_browser_cdp_session()
        for name in given.robots:
            robot = replace(load_robot(f"gallery:{name}"), poses={})
            shape = learn_shape(sample_shapes(robot, given.samples), Simulation(robot).rest.nodes, steps=500)
            file = Path(folder) / f"{name}.html"
            text = toy_page(robot, shape)
            file.write_text(text, encoding="utf-8")
            for width, height in ((1280, 800), (390, 844)):
                page = browser.new_page(viewport={"width": width, "height": height})
                page.goto(file.as_uri())
                print(f"{name} {width} x {height}: {len(text) / 1e6:.2f} MB, {measure(page, session, given.seconds)}")
                page.close()
        browser.close()


if __name__ == "__main__":
    main()
