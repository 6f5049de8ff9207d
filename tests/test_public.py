"""The public face: names, light imports, and the layers."""

import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.robot import gallery_folder

ROOMS = ["control", "design", "drawing", "fabrication", "geometry", "grasp", "ik", "learning", "mechanics", "plot"]
ROOMS += ["robot", "simulation", "studio", "teleop", "testing"]


def test_every_public_name_exists() -> None:
    """Oracle: `__all__` itself; a name that does not load is a broken promise."""
    for name in hs.__all__:
        assert getattr(hs, name) is not None
    assert set(hs.__all__) <= set(dir(hs))


@pytest.mark.parametrize("room", ["", *ROOMS])
def test_a_door_lists_what_it_imports(room: str) -> None:
    """Oracle: the names in `__all__`, beside those that the door imports for type checkers."""
    door = import_module(f"hydrostat{room and '.'}{room}")
    assert len(set(door.__all__)) == len(door.__all__)
    assert set(door.__all__) - {"__version__"} == set(door._homes)
    assert not any(isinstance(_public(door, name), ModuleType) for name in door.__all__)


def test_type_checkers_read_functions_not_modules() -> None:
    """Oracle: mypy 2.4, which takes `from hydrostat.ik import solve_ik` at the door for the module of that name."""
    homes = {f"{module}.{name}" for module, name in hs._homes.values()}
    assert [each for each in homes if (Path(hs.__file__).parents[1] / f"{each.replace('.', '/')}.py").exists()] == []


def _public(door: ModuleType, name: str) -> object:
    """A public name; None if it needs an extra that is not installed."""
    try:
        return getattr(door, name)
    except InputError:
        return None


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'octopus'"):
        _ = hs.octopus
    with pytest.raises(AttributeError, match=r"'Simulatoin'\. Did you mean 'Simulation'"):
        _ = hs.Simulatoin


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


NEVER = "torch ray ezdxf svgelements meshio pint nicegui joblib typst jax scipy.stats scipy.interpolate scipy.ndimage"
NEVER += " hydrostat.learning hydrostat.training hydrostat.studio jaxtyping asyncio unittest.mock pstats "
"""Modules that no command of everyday loads."""


@pytest.mark.parametrize(
    ("command", "heavy"),
    [
        (
            "simulate R --contract left=12mm --out pose",
            "scipy.optimize scipy.spatial scipy.sparse scipy.linalg hydrostat.ik.inverse_kinematics hydrostat.design",
        ),
        ("simulate H --out pose", "igl scipy.sparse scipy.spatial numpy.f2py scipy.optimize scipy.linalg"),
        ("pose R --pose wave --out pose", "scipy.sparse scipy.linalg urllib.request hydrostat.design"),
        (
            "new other --from gallery:starfish",
            "urllib.request scipy hydrostat.design hydrostat.simulation.simulation",
        ),
        ("check R", "scipy.optimize scipy.linalg scipy.sparse.csgraph scipy.spatial matplotlib"),
    ],
)
def test_a_command_loads_what_it_needs(
    command: str, heavy: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Oracle: the modules of a fresh interpreter after the command, whose body is in a cache of its own."""
    monkeypatch.setenv("HYDROSTAT_CACHE", str(tmp_path / "cache"))
    robots = {"R": gallery_folder("starfish"), "H": gallery_folder("cupping_hand")}
    words = [str(robots.get(word, word)) for word in command.split()]
    names = (NEVER + heavy).split()
    code = "import sys; from hydrostat.cli.main import app; app(sys.argv[1:], standalone_mode=False); "
    code += f"print('loaded:', *[name for name in {names} if name in sys.modules])"
    line = [sys.executable, "-c", code, *words]
    for name in ("first", "again"):  # the first fills the cache
        (tmp_path / name).mkdir()
        run = subprocess.run(line, capture_output=True, text=True, check=True, cwd=tmp_path / name)
    assert run.stdout.splitlines()[-1].split() == ["loaded:"]


def test_the_modules_of_igl_under_other_licenses_are_never_imported() -> None:
    """Oracle: the text of the package, and what `import igl` loads."""
    import igl

    assert igl.__name__ == "igl"
    assert not {"igl.copyleft", "igl.triangle"} & set(sys.modules)
    texts = [file.read_text(encoding="utf-8") for file in Path(hs.__file__).parent.rglob("*.py")]
    assert not [text for text in texts if re.search(r"igl\.(copyleft|triangle)|from igl\b", text)]
