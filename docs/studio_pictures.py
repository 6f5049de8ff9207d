"""Pictures of the studio for the docs, one of each stage, taken in a real browser.

    python docs/studio_pictures.py      # writes docs/pictures/studio_*.png

It needs the extra `test` and Debian's chromium.
"""

import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from os import environ
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageDraw, ImageFilter
from playwright.sync_api import Browser, Page, sync_playwright

from hydrostat.robot import gallery_folder, load_robot

PICTURES = Path(__file__).parent / "pictures"

FLAGS = ["--no-sandbox", "--enable-unsafe-swiftshader"]

SIZE = {"width": 1280, "height": 800}

COLORS = 128
"""Of a picture; felt and paper are few."""


@contextmanager
def studio(robot: str | None, *options: str) -> Iterator[list[str]]:
    """A studio that runs; its address, and that of the teacher of a class."""
    command = [sys.executable, "-c", "from hydrostat.cli.main import main; main()", "studio", "--no-browser", *options]
    command += [] if robot is None else [str(gallery_folder(robot))]
    with (
        TemporaryDirectory() as state,
        subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, env={**environ, "XDG_STATE_HOME": state}, cwd=state
        ) as process,
    ):
        assert process.stdout is not None
        found: list[str] = []
        while len(found) < 1 + ("--class" in options):
            found += [word for word in process.stdout.readline().split() if word.startswith("http://")]
        try:
            yield found
        finally:
            process.terminate()


@contextmanager
def window(browser: Browser, robot: str | None, *, dark: bool = False) -> Iterator[Page]:
    """A window on a studio."""
    with studio(robot) as (address,):
        context = browser.new_context(viewport=SIZE, color_scheme="dark" if dark else "light")
        context.add_init_script("localStorage.setItem('hydrostat-tour', '1')")
        page = context.new_page()
        page.set_default_timeout(240_000)
        page.goto(address)
        if robot is not None:
            page.wait_for_function("window.__app && window.__app.painted > 0")
        yield page
        context.close()


def go(page: Page, stage: str) -> None:
    """Show a stage."""
    page.get_by_test_id(f"stage-{stage}").click()


def settle(page: Page) -> None:
    """Wait until nothing has been painted for a while."""
    before = -1
    while (now := page.evaluate("window.__app ? __app.painted : 0")) != before:
        before = now
        page.wait_for_timeout(1200)


def drag(page: Page, key: str, dx: float, dy: float) -> None:
    """Drag a sign by so many pixels."""
    page.wait_for_function("key => __app.items.some(t => t.key === key)", arg=key)
    at = page.evaluate("key => __app.items.find(t => t.key === key)", key)
    page.mouse.move(at["x"], at["y"])
    page.mouse.down()
    for step in range(1, 13):
        page.mouse.move(at["x"] + dx * step / 12, at["y"] + dy * step / 12)
        page.wait_for_timeout(60)
    page.mouse.up()


def keep(page: Page, name: str) -> None:
    """Write what is seen."""
    page.mouse.move(640, 795)
    settle(page)
    file = PICTURES / f"studio_{name}.png"
    page.screenshot(path=file)
    few = Image.open(file).convert("RGB").quantize(COLORS, dither=Image.Dither.NONE)
    few.save(file, optimize=True)
    print(f"{file.name}: {file.stat().st_size / 1e3:.0f} kB")


def take_start(browser: Browser) -> None:
    """The gallery."""
    with window(browser, None) as page:
        page.get_by_text("Gallery").wait_for()
        page.wait_for_timeout(1500)
        keep(page, "start")


def photograph(folder: Path) -> Path:
    """A picture as from a telephone: the gallery's pig, cut from blue felt, with its shadow on grey paper."""
    ring = load_robot(gallery_folder("pig")).body.outline
    assert ring is not None
    low, high = ring.exterior.min(axis=0), ring.exterior.max(axis=0)
    scale = 800 / float(max(high - low))
    points = [(120 + scale * (x - low[0]), 110 + scale * (high[1] - y)) for x, y in ring.exterior]
    wide, tall = (int(scale * value) + 240 for value in high - low)
    image, shade = Image.new("RGB", (wide, tall), (226, 223, 218)), Image.new("L", (wide, tall), 0)
    ImageDraw.Draw(shade).polygon([(x + 16, y + 20) for x, y in points], fill=150)
    image.paste((70, 68, 66), mask=shade.filter(ImageFilter.GaussianBlur(9)))
    ImageDraw.Draw(image).polygon(points, fill=(52, 92, 168))
    file = folder / "pig.jpg"
    image.save(file, quality=92)
    return file


def take_photo(browser: Browser) -> None:
    """A photograph, the outline that was read from it, and how it is read."""
    with TemporaryDirectory() as folder, window(browser, None) as page:
        page.locator("[data-testid=upload] input[type=file]").set_input_files(str(photograph(Path(folder))))
        page.locator(".start-photo svg").wait_for()
        page.wait_for_timeout(1500)
        keep(page, "photo")


def take_starfish(browser: Browser) -> None:
    """Edit, pose, design, drive, export of a flat robot."""
    with window(browser, "starfish") as page:
        drag(page, "marker:right", -50, -70)
        drag(page, "marker:left", 40, -60)
        keep(page, "pose")
        go(page, "edit")
        page.wait_for_function("__app.items.some(t => t.key === 'via:0:2')")
        page.keyboard.press("b")
        page.get_by_role("button", name="circle", exact=True).wait_for()
        at = page.evaluate("__app.body(0, 0.05)")
        page.mouse.move(at["x"], at["y"])
        page.mouse.down()
        page.mouse.move(at["x"] + 36, at["y"], steps=6)
        page.mouse.up()
        page.get_by_text("Region", exact=True).wait_for()
        keep(page, "edit")
        page.keyboard.press("z")
        go(page, "design")
        page.get_by_test_id("design-go").click()
        page.get_by_test_id("design-card").first.wait_for()
        page.get_by_test_id("design-go").wait_for()
        page.get_by_test_id("design-show-pose").first.click()
        keep(page, "design")
        page.get_by_test_id("design-accept").click()
        go(page, "drive")
        for time, left, right in ((0.0, 0, 0), (1.0, 20, 5), (2.2, 4, 24), (3.2, 18, 18), (4.0, 0, 0)):
            line = page.locator("svg[aria-label=Timeline]").bounding_box()
            assert line is not None
            page.mouse.click(line["x"] + 18 + (line["width"] - 36) * time / 4.0, line["y"] + 12)
            page.wait_for_timeout(400)
            for winch, value in (("winch_1", left), ("winch_2", right)):
                box = page.get_by_label(f"{winch}, millimeters")
                box.fill(str(value))
                box.press("Enter")
            page.get_by_text("Add").first.click()
            page.wait_for_timeout(400)
        keep(page, "drive")


def take_proposal(browser: Browser) -> None:
    """A network that is proposed for a pose."""
    with window(browser, "cupping_hand") as page:
        page.get_by_role("button", name="Muscles", exact=True).click()
        page.get_by_text("Propose cables while dragging").click()
        drag(page, "marker:index", 40, 90)
        drag(page, "marker:thumb", -40, -10)
        page.get_by_text("mm as-built error").wait_for()
        page.wait_for_timeout(8000)
        keep(page, "proposal")


def take_kit(browser: Browser) -> None:
    """A kit, with its pages."""
    with window(browser, "starfish") as page:
        go(page, "export")
        page.get_by_test_id("make-kit").click()
        page.locator("[data-testid^=download-]").first.wait_for()
        keep(page, "export")


def take_hand(browser: Browser) -> None:
    """A body in space, in the dark, colored by strain."""
    with window(browser, "cupping_hand", dark=True) as page:
        drag(page, "marker:index", 30, 110)
        page.get_by_label("Colors").click()
        page.get_by_text("Strain", exact=True).click()
        page.keyboard.press("Escape")
        keep(page, "hand")


def take_class(browser: Browser) -> None:
    """The wall of a class."""
    pupils = {"Ada": ("top", 90), "Bo & Carl": ("left", 60), "Dilek": ("right", -80), "Émile": ("top", -120)}
    with studio("starfish", "--class", "--host", "127.0.0.1") as (link, teacher):
        contexts = []
        for name, (marker, dx) in pupils.items():
            context = browser.new_context(viewport=SIZE)
            contexts.append(context)
            context.add_init_script("localStorage.setItem('hydrostat-tour', '1')")
            page = context.new_page()
            page.set_default_timeout(240_000)
            page.goto(link)
            page.get_by_label("Nickname").fill(name)
            page.get_by_text("Start").click()
            page.wait_for_function("window.__app && window.__app.painted > 0")
            drag(page, f"marker:{marker}", dx, 40)
            settle(page)
        page = browser.new_page(viewport={"width": 1280, "height": 420})
        page.goto(teacher)
        page.get_by_text("Émile").wait_for()
        page.wait_for_timeout(4000)
        keep(page, "class")
        for context in contexts:
            context.close()


TAKES = {
    "start": take_start,
    "photo": take_photo,
    "starfish": take_starfish,
    "proposal": take_proposal,
    "kit": take_kit,
    "hand": take_hand,
    "class": take_class,
}


def main() -> None:
    """Take all pictures."""
    chromium = shutil.which("chromium")
    if chromium is None:
        raise SystemExit("docs/studio_pictures.py needs a Chromium; install Debian's package chromium")
    wanted = sys.argv[1:] or list(TAKES)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        for name in wanted:
            TAKES[name](browser)
        browser.close()


if __name__ == "__main__":
    main()
