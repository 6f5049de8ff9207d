"""The gallery: ready robots that come with hydrostat."""

from importlib.resources import files
from pathlib import Path
from typing import TypeGuard

from hydrostat.errors import InputError

GALLERY = "gallery:"
"""Prefix of the name of a gallery robot, instead of a folder."""


def is_of_gallery(source: object) -> TypeGuard[str]:
    """Return True if a source names a robot of the gallery, such as "gallery:starfish"."""
    return isinstance(source, str) and source.startswith(GALLERY)


def list_gallery() -> list[str]:
    """Names of the robots in the gallery, sorted."""
    return sorted(folder.name for folder in _shelf().iterdir() if (folder / "robot.toml").is_file())


def gallery_folder(name: str) -> Path:
    """Folder of a gallery robot (InputError: the gallery has no robot of this name)."""
    if name not in list_gallery():
        raise InputError(f'unknown gallery robot "{name}". Available: {", ".join(list_gallery())}.')
    return _shelf() / name


def _shelf() -> Path:
    """Folder of the gallery: inside an installed package, or next to it in a checkout."""
    package = Path(str(files("hydrostat")))
    inside = package / "examples"
    return inside if inside.is_dir() else package.parent / "examples"
