"""Run the commands of the tutorials, and draw their pictures.

    python docs/run_tutorials.py [NAME ...]

Each page runs in a folder of its own: blocks after "Save this as `NAME`" are written, blocks of `sh` are run by bash.
Pages whose packages are missing say so. The pictures in `PICTURES` are copied to docs/pictures.
"""

import re
import shlex
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from PIL import Image

HERE = Path(__file__).resolve().parent
RUN = [sys.executable, "-c", "import sys; sys.argv[0] = 'hydrostat'; import hydrostat.cli.main as m; m.main()"]
PICTURES = {
    "first_plush": {"tutorial_rest.png": "gingerbread/rest.png", "tutorial_cheer.png": "cheer/pose.png"},
    "own_cables": {"tutorial_tentacle.png": "bent/pose.png"},
    "scan_to_hand": {"tutorial_index.png": "index/pose.png"},
}
NEEDS = {"surrogate_model": "torch"}
WIDTH = 1000
"""Largest width of a picture in the docs [pixels]."""

FENCE = re.compile(r"(?:Save this as `(?P<name>[^`]+)`[^`]*?)?^```(?P<language>\w+)\n(?P<text>.*?)^```", re.M | re.S)


def run_page(page: Path, folder: Path) -> None:
    """Write the files of a page into a folder and run its commands there; the first failure ends it."""
    command = f'hydrostat() {{ {shlex.join(RUN)} "$@"; }}\nset -e\n'
    for block in FENCE.finditer(page.read_text(encoding="utf-8")):
        if block["name"]:
            (folder / block["name"]).write_text(block["text"], encoding="utf-8")
        elif block["language"] == "sh":
            subprocess.run(["bash", "-c", command + block["text"]], cwd=folder, check=True)


def main() -> None:
    """Run the pages named, or all."""
    for page in sorted((HERE / "tutorials").glob("*.md")):
        if sys.argv[1:] and page.stem not in sys.argv[1:]:
            continue
        print(f"== {page.stem}", flush=True)
        if page.stem in NEEDS and find_spec(NEEDS[page.stem]) is None:
            print(f"skipped: {NEEDS[page.stem]} is not installed")
            continue
        with tempfile.TemporaryDirectory() as folder:
            run_page(page, Path(folder))
            for picture, source in PICTURES.get(page.stem, {}).items():
                with Image.open(Path(folder) / source) as image:
                    image.thumbnail((WIDTH, WIDTH))
                    image.save(HERE / "pictures" / picture, optimize=True)


if __name__ == "__main__":
    main()
