"""Runs pieces of the view's JavaScript in Node, where there is one."""

import json
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from hydrostat.studio.face.viewport import MODULES

NODE = shutil.which("node")

needs_node = pytest.mark.skipif(NODE is None, reason="there is no node, which runs the view's JavaScript")


def run(folder: Path, script: str, *arguments: Path) -> Any:
    """What a script prints as JSON; it imports the view's modules from "./view/", its arguments are in `given`.

    Args:
        folder: where the modules are copied to, with the three.js that NiceGUI brings.
        script: an ES module.
        arguments: paths of files.
    """
    assert NODE is not None
    shutil.copytree(MODULES, folder / "view")
    (folder / "package.json").write_text('{"type": "module"}')
    three = folder / "node_modules" / "nicegui-scene"
    three.mkdir(parents=True)
    spec = find_spec("nicegui")
    assert spec is not None
    assert spec.origin is not None
    shutil.copy(Path(spec.origin).parent / "elements" / "scene" / "dist" / "index.js", three / "index.js")
    (three / "package.json").write_text('{"type": "module", "main": "index.js"}')
    (folder / "script.js").write_text("const given = process.argv.slice(2);\n" + script)
    command = [NODE, str(folder / "script.js"), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
