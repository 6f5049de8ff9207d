"""The core's kernels on ARM, by a cross-compiler and an emulator. Oracle: the same source on this processor."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
NATIVE = HERE.parents[1] / "native"
ARM = "aarch64-linux-gnu-g++", "qemu-aarch64"


def numbers(folder: Path, compiler: str, *emulator: str) -> tuple[list[str], np.ndarray]:
    """Names and numbers that check_kernels.cpp prints."""
    program = folder / compiler
    flags = ["-std=c++17", "-O2", "-ffp-contract=fast", "-fno-math-errno", "-Wno-psabi", "-static", "-DLEVEL=base"]
    sources = [str(HERE / "check_kernels.cpp"), str(NATIVE / "kernels.cpp")]
    subprocess.run([compiler, *flags, f"-I{NATIVE}", *sources, "-o", str(program)], check=True)
    lines = subprocess.run([*emulator, str(program)], capture_output=True, text=True, check=True).stdout.splitlines()
    return [line.split()[0] for line in lines], np.array([float(line.split()[1]) for line in lines])


@pytest.mark.slow
@pytest.mark.skipif(not all(map(shutil.which, (*ARM, "g++"))), reason=f"needs {', '.join(ARM)} and g++")
def test_kernels_on_arm(tmp_path: Path) -> None:
    """Elements, factors and right-hand sides with the two lanes of NEON, to 1e-10 of the largest number of each."""
    names, here = numbers(tmp_path, "g++")
    others, there = numbers(tmp_path, ARM[0], ARM[1])
    assert names == others
    assert np.isfinite(here).all()
    for name in set(names):
        own = np.array([each == name for each in names])
        assert np.abs(here[own] - there[own]).max() <= 1e-10 * np.abs(here[own]).max(), name
