"""The public face: names, light imports, and the layers."""

import subprocess
import sys
from importlib import import_module
from types import ModuleType

import pytest

import hydrostat as hs

ROOMS = ["control", "design", "fabrication", "geometry", "grasp", "ik", "learning", "mechanics", "plot"]
ROOMS += ["robot", "shapes", "simulation", "teleop"]


def test_every_public_name_exists() -> None:
    """Oracle: `__all__` itself; a name that does not load is a broken promise."""
    for name in hs.__all__:
        assert getattr(hs, name) is not None
    assert set(hs.__all__) <= set(dir(hs))


@pytest.mark.parametrize("room", ["", *ROOMS])
def test_a_door_lists_what_it_imports(room: str) -> None:
    """Oracle: the names in `__all__`, beside those that the door imports for type checkers."""
    door = import_module(f"hydrostat{room and '.'}{room}")
    assert sorted(door.__all__) == door.__all__ or not room
    assert set(door.__all__) - {"__version__"} == set(door._homes)
    assert not any(isinstance(getattr(door, name), ModuleType) for name in door.__all__)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'octopus'"):
        _ = hs.octopus


@pytest.mark.parametrize(
    "statement", ["import hydrostat", "import hydrostat.cli.main", "import hydrostat as hs; hs.load_robot"]
)
def test_import_stays_light(statement: str) -> None:
    """Oracle: the modules of a fresh interpreter; heavy ones load where they are used."""
    heavy = "matplotlib torch ray ezdxf svgelements meshio pint rich.progress"
    if "load_robot" not in statement:
        heavy += " numpy scipy shapely pydantic"
    code = f"{statement}; import sys; print(*[name for name in '{heavy}'.split() if name in sys.modules])"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert loaded == []
