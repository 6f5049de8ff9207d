"""Installation where the compiled core cannot be built. Oracle: a PATH that holds no compiler."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from hydrostat import version

ROOT = Path(__file__).parents[1]
TOOLS = str(ROOT / "native" / "check_tools.py")

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="CMake finds the compiler of Visual Studio")


def check(*command: str, **environment: str) -> subprocess.CompletedProcess[str]:
    kept = {name: value for name, value in os.environ.items() if name != "CXX"}
    return subprocess.run(command, capture_output=True, text=True, check=False, env=kept | environment)


def test_one_line_says_what_to_install(tmp_path: Path) -> None:
    found = check(sys.executable, TOOLS, PATH=str(tmp_path))
    assert found.stdout.startswith("hydrostat needs a C++17 compiler. Install: ")
    assert found.stdout.count("\n") == 1


def test_a_compiler_that_fails_is_none(tmp_path: Path) -> None:
    """As c++ of macOS without its tools."""
    for name in ("c++", "g++", "clang++"):
        (tmp_path / name).symlink_to("/bin/false")
    assert "a C++17 compiler" in check(sys.executable, TOOLS, PATH=str(tmp_path)).stdout


def test_make_stops_with_that_line(tmp_path: Path) -> None:
    make = shutil.which("make")
    if make is None:
        pytest.skip("no make")
    for name in ("sh", "python3"):
        (tmp_path / name).symlink_to(str(shutil.which(name)))
    clone = tmp_path / "clone"
    (clone / "native").mkdir(parents=True)
    for name in ("Makefile", "pyproject.toml", "constraints.txt", "native/check_tools.py"):
        shutil.copy(ROOT / name, clone / name)
    command = [make, "-C", str(clone), "--no-print-directory", "demo", f"PYTHON={sys.executable}"]
    found = check(*command, PATH=str(tmp_path))
    assert found.returncode == 2
    assert "hydrostat needs a C++17 compiler. Install: " in found.stderr.splitlines()[-1]
    assert not (clone / ".venv").exists()


@pytest.mark.skipif(shutil.which("c++") is None, reason="no compiler")
def test_nothing_is_said_where_nothing_is_missing() -> None:
    assert check(sys.executable, TOOLS).stdout == ""


def test_the_command_for_an_extra_fits_the_installation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert version.install_command("cad") == 'pip install -e ".[cad]"'
    monkeypatch.setattr(version, "__file__", str(tmp_path / "site-packages" / "hydrostat" / "version.py"))
    assert version.install_command("cad") == 'pip install "hydrostat[cad]"'


def test_the_studio_without_its_extra_is_one_line() -> None:
    """Oracle: a process in which none of the packages of the extra can be imported."""
    program = (
        "import sys; sys.modules |= dict.fromkeys('nicegui segno fastapi starlette uvicorn'.split());"
        "sys.argv = ['hydrostat', 'studio']; from hydrostat.cli.main import main; main()"
    )
    found = check(sys.executable, "-c", program)
    assert found.returncode == 2
    assert found.stderr.startswith("hydrostat: error: studio: package starlette not found. Install it: pip install ")
    assert found.stderr.count("\n") == 1
