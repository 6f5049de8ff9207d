"""Build the compiled core with the wheel, or beside the sources of an editable install."""

import os
import runpy
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CompiledCore(BuildHookInterface):
    """Run CMake, which puts the core into the package."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build before the files are gathered; stop with one line if a tool is missing."""
        if self.target_name != "wheel":
            return
        tools = runpy.run_path(str(Path(self.root) / "native" / "check_tools.py"))
        if problem := tools["find_problem"]():
            self.app.abort(problem)
        for old in (Path(self.root) / "hydrostat").glob("_native.*"):
            old.unlink()
        with tempfile.TemporaryDirectory() as folder:
            try:
                more = shlex.split(os.environ.get("CMAKE_ARGS", ""))  # of a cross-build: arm_wheel.py
                run("cmake", "-S", self.root, "-B", folder, *ninja(), f"-DPython_EXECUTABLE={sys.executable}", *more)
                run("cmake", "--build", folder, "--config", "Release", "--parallel")
                run("cmake", "--install", folder, "--config", "Release", "--prefix", self.root)
            except (OSError, subprocess.CalledProcessError) as error:
                output = getattr(error, "stdout", None) or str(error)
                needed = tools["INSTALL"].get(sys.platform, "GCC or Clang")
                self.app.abort(f"{output}\nhydrostat's compiled core was not built (output above). It needs: {needed}")
        build_data["artifacts"].append("hydrostat/_native.*")
        build_data.update(pure_python=False, infer_tag=True)


def ninja() -> list[str]:
    """Ninja where it is, but on Windows: there Visual Studio finds its own tools."""
    return ["-G", "Ninja"] if shutil.which("ninja") and sys.platform != "win32" else []


def run(*command: str) -> None:
    """Run a command; its output is kept for the message."""
    subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
