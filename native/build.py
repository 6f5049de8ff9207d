"""Build the compiled core with the wheel, or beside the sources of an editable install; leave it out if that fails."""

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
        """Build before the files are gathered; without a core the package is pure Python, and slower."""
        if self.target_name != "wheel":
            return
        package = Path(self.root) / "hydrostat"
        for old in package.glob("_native.*"):
            old.unlink()
        with tempfile.TemporaryDirectory() as folder:
            try:
                run("cmake", "-S", self.root, "-B", folder, *ninja(), f"-DPython_EXECUTABLE={sys.executable}")
                run("cmake", "--build", folder, "--config", "Release", "--parallel")
                run("cmake", "--install", folder, "--config", "Release", "--prefix", self.root)
            except (OSError, subprocess.CalledProcessError) as error:
                output = getattr(error, "stdout", None) or str(error)
                self.app.display_warning(f"hydrostat is installed without its compiled core, and slower:\n{output}")
        if any(package.glob("_native.*")):
            build_data["artifacts"].append("hydrostat/_native.*")
            build_data.update(pure_python=False, infer_tag=True)


def ninja() -> list[str]:
    """Ninja where it is, but on Windows: there Visual Studio finds its own tools."""
    return ["-G", "Ninja"] if shutil.which("ninja") and sys.platform != "win32" else []


def run(*command: str) -> None:
    """Run a command; its output is kept for the message."""
    subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
