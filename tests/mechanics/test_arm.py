"""The core's kernels on ARM, by a cross-compiler and an emulator. Oracle: the same source on this processor."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
NATIVE = HERE.parents[1] / "native"
ARM = "aarch64-linux-gnu-g++", "qemu-aarch64"
INSTALL = "g++, g++-aarch64-linux-gnu and qemu-user (Debian, Ubuntu: sudo apt install)"
FLAGS = "-std=c++17", "-Wno-psabi", "-DLEVEL=base", f"-I{NATIVE}"


def numbers(folder: Path, compiler: str, *emulator: str) -> tuple[list[str], np.ndarray]:
    """Names and numbers that check_kernels.cpp prints."""
    program = folder / compiler
    flags = [*FLAGS, "-O2", "-ffp-contract=fast", "-fno-math-errno", "-static"]
    sources = [str(HERE / "check_kernels.cpp"), str(NATIVE / "kernels.cpp")]
    subprocess.run([compiler, *flags, *sources, "-o", str(program)], check=True)
    lines = subprocess.run([*emulator, str(program)], capture_output=True, text=True, check=True).stdout.splitlines()
    return [line.split()[0] for line in lines], np.array([float(line.split()[1]) for line in lines])


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("g++"), reason="install g++")
def test_the_program_for_arm_fits_the_kernels() -> None:
    """Also where the test below is skipped. Oracle: the compiler."""
    program = str(HERE / "check_kernels.cpp")
    ended = subprocess.run(["g++", *FLAGS, "-fsyntax-only", program], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr


@pytest.mark.slow
@pytest.mark.skipif(not all(map(shutil.which, (*ARM, "g++"))), reason=f"install {INSTALL}")
def test_kernels_on_arm(tmp_path: Path) -> None:
    """Elements, factors and right-hand sides with the two lanes of NEON, to 1e-10 of the largest number of each."""
    names, here = numbers(tmp_path, "g++")
    others, there = numbers(tmp_path, ARM[0], ARM[1])
    assert names == others
    assert np.isfinite(here).all()
    for name in set(names):
        own = np.array([each == name for each in names])
        assert np.abs(here[own] - there[own]).max() <= 1e-10 * np.abs(here[own]).max(), name
