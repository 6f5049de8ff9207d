"""Print what to install if the compiled core cannot be built here; print nothing if it can."""

import os
import shlex
import subprocess
import sys
import sysconfig
from pathlib import Path

PROGRAM = "#include <optional>\nint main() { if (std::optional<int> value = 0; value) return *value; }\n"
"""C++17 with its library."""

INSTALL = {
    "linux": "sudo apt install g++ python3-dev (Debian, Ubuntu), sudo dnf install gcc-c++ python3-devel (Fedora)",
    "darwin": "xcode-select --install",
    "win32": "Visual Studio Build Tools with its component C++ Clang tools for Windows (clang-cl)",
}


def has_compiler(command: str) -> bool:
    """Tell whether a command compiles C++17. Running it matters: macOS has a c++ that only asks for its tools."""
    words = [*shlex.split(command), "-std=c++17", "-x", "c++", "-fsyntax-only", "-"]
    try:
        return subprocess.run(words, input=PROGRAM, text=True, capture_output=True, check=False).returncode == 0
    except OSError:
        return False


def find_problem() -> str:
    """Name the missing tool and how to install it, in one line; empty if nothing is missing.

    On Windows CMake finds the compiler of Visual Studio, thus nothing is checked here.
    """
    if sys.platform == "win32":
        return ""
    given = os.environ.get("CXX", "")
    if not any(has_compiler(command) for command in ([given] if given else ["c++", "g++", "clang++"])):
        needed = f"a C++17 compiler (CXX={given} is none)" if given else "a C++17 compiler"
    elif not (Path(sysconfig.get_path("include")) / "Python.h").is_file():
        needed = "Python's headers (Python.h)"
    else:
        return ""
    return f"hydrostat needs {needed}. Install: {INSTALL.get(sys.platform, 'GCC or Clang')}"


if __name__ == "__main__":
    if problem := find_problem():
        print(problem)
