"""Version of hydrostat, and the command that installs its extras."""

from pathlib import Path

__version__ = "0.1.0"


def install_command(extra: str) -> str:
    """Return the pip command for an extra: for the clone that this package lies in, else for the installed package."""
    is_clone = (Path(__file__).resolve().parents[1] / "pyproject.toml").is_file()
    return f'pip install -e ".[{extra}]"' if is_clone else f'pip install "hydrostat[{extra}]"'
