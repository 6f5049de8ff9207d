"""`hydrostat new` in space. Oracles: the robot read back, files of trimesh and meshio, what is left over."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import hydrostat as hs
from hydrostat.robot import find_risks

Run = Callable[..., tuple[int, str, str]]
DRAWING = b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 30"><path d="M0 0H60V30H0Z"/></svg>'


@pytest.fixture
def bar(tmp_path: Path) -> Path:
    """A bar of 90 x 20 x 20 mm, as binary STL of trimesh."""
    return _exported(tmp_path / "my bar.stl")


def _exported(path: Path) -> Path:
    from trimesh.creation import box

    box((90, 20, 20)).export(path)
    return path


def _sides(folder: Path) -> np.ndarray:
    return np.ptp(hs.load_robot(folder).body.mesh.nodes, axis=0)


def _only(folder: Path, *names: str) -> None:
    assert sorted(path.name for path in folder.iterdir()) == sorted(names)


@pytest.mark.slow
def test_a_scan_becomes_a_robot_that_can_be_checked_and_pulled(run: Run, tmp_path: Path, bar: Path) -> None:
    folder = tmp_path / "sub" / "bar"
    code, out, err = run("new", folder, "--from", bar, "--nodes", 150)
    assert (code, err) == (0, "")
    robot = hs.load_robot(folder)
    assert len(robot.body.mesh.nodes) == pytest.approx(150, rel=0.1)
    assert f"Created {folder}: 90 mm, {len(robot.body.mesh.nodes)} nodes, {len(robot.body.mesh.elements)} tetra" in out
    assert "the surface is clean" in out
    assert out.count("warning: body: no room for the motor") == 1, "a bar of 20 mm has no room for motors"
    assert [f"warning: {risk}" in out for risk in find_risks(robot)] == [True] * (out.count("warning: ") - 1)
    _only(folder, "robot.toml", "my_bar.stl", "rest.png")
    _only(folder.parent, "bar")
    assert (folder / "rest.png").read_bytes().startswith(b"\x89PNG")
    assert _sides(folder) == pytest.approx([0.09, 0.02, 0.02], abs=0.002)
    assert run("check", folder)[0] == 1
    command = out.splitlines()[-1].removeprefix("Next: hydrostat ").split()
    assert command[:2] == ["simulate", str(folder)]
    assert run(*command[:-1], tmp_path / "out")[0] == 0


@pytest.mark.slow
def test_a_stout_bar_with_a_screw_hole_passes_the_check(run: Run, tmp_path: Path) -> None:
    """Oracle: what stands in the surface: a hole of 4 mm, which elements of 12 mm fill, so no limbs grew together."""
    from trimesh.creation import box, cylinder

    bar, hole = box((200, 60, 50)), cylinder(2, 100)
    bar.difference(hole, engine="manifold").export(tmp_path / "bar.stl")
    code, out, _ = run("new", tmp_path / "bar", "--from", tmp_path / "bar.stl", "--nodes", 500)
    assert code == 0
    assert "1 hole" in out
    assert "warning: " not in out
    code, out, _ = run("check", tmp_path / "bar")
    assert (code, out.splitlines()[-1]) == (0, "OK: 0 errors, 0 warnings.")
    assert "turn too sharp" not in out


@pytest.mark.slow
def test_sizes_and_elements(run: Run, tmp_path: Path) -> None:
    source = _exported(tmp_path / "bar.obj")
    arguments = ("--size", "180 mm", "--element-size", "20 mm", "--material", "polyurethane foam")
    assert run("new", tmp_path / "bar", "--from", source, *arguments)[0] == 0
    robot = hs.load_robot(tmp_path / "bar")
    assert robot.body.element_size == 0.02
    assert robot.body.size == 0.18
    assert robot.body.material.name == "polyurethane foam"
    assert _sides(tmp_path / "bar") == pytest.approx([0.18, 0.04, 0.04], abs=0.004)


@pytest.mark.slow
def test_a_ready_mesh(run: Run, tmp_path: Path) -> None:
    import meshio
    from builders import box_mesh

    mesh = box_mesh((8, 2, 2), size=(80.0, 20.0, 16.0))
    meshio.write(tmp_path / "a.vtu", meshio.Mesh(mesh.nodes, {"tetra": mesh.elements}))
    assert run("new", tmp_path / "a", "--from", tmp_path / "a.vtu", "--size", "160 mm")[0] == 0
    robot = hs.load_robot(tmp_path / "a")
    assert _sides(tmp_path / "a") == pytest.approx([0.16, 0.04, 0.032])
    assert len(robot.body.mesh.elements) == len(mesh.elements)
    for option in ("--nodes", "--element-size", "--thickness", "--inflate"):
        value = "300" if option == "--nodes" else "9 mm"
        code, _, err = run("new", tmp_path / "b", "--from", tmp_path / "a.vtu", option, value)
        assert code == 2
        assert err.startswith(f"Error: {option}: ") or f"{option}: " in err
    assert not (tmp_path / "b").exists()


def test_a_mesh_of_one_layer_is_held(tmp_path: Path) -> None:
    """No node lies inside; the ball that holds it reaches nodes about which the body cannot turn."""
    import meshio
    from builders import box_mesh

    mesh = box_mesh((6, 4, 1), size=(60.0, 40.0, 4.0))
    meshio.write(tmp_path / "a.vtu", meshio.Mesh(mesh.nodes, {"tetra": mesh.elements}))
    assert len(hs.new_robot(tmp_path / "a.vtu").pins) == 1


@pytest.mark.slow
def test_a_drawing_is_blown_up(run: Run, tmp_path: Path) -> None:
    """As thick in the middle as asked for; whether it can be sewn is told at once."""
    (tmp_path / "a.svg").write_bytes(DRAWING)
    arguments = ("--size", "120 mm", "--inflate", "40 mm", "--nodes", 300)
    code, out, _ = run("new", tmp_path / "pillow", "--from", tmp_path / "a.svg", *arguments)
    assert code == 0
    assert "\nskin: 2 patches, cloth with " in out
    assert _sides(tmp_path / "pillow") == pytest.approx([0.12, 0.06, 0.04], rel=0.06)
    assert len(hs.load_robot(tmp_path / "pillow").body.mesh.nodes) == pytest.approx(300, rel=0.1)
    _only(tmp_path / "pillow", "robot.toml", "a.ply", "rest.png")


@pytest.mark.slow
def test_a_gallery_robot_of_other_elements(run: Run, tmp_path: Path) -> None:
    assert run("new", tmp_path / "mine", "--from", "gallery:starfish", "--nodes", 150)[0] == 0
    mine, theirs = hs.load_robot(tmp_path / "mine"), hs.load_robot(Path("examples/starfish"))
    assert len(mine.body.mesh.nodes) == pytest.approx(150, rel=0.1)
    assert mine.cables == theirs.cables
    assert mine.poses == theirs.poses


@pytest.mark.slow
def test_a_dirty_scan_is_healed_told_and_drawn(run: Run, tmp_path: Path, bar: Path) -> None:
    """A hole and flipped triangles: both are in the report, which is on the screen and in the folder."""
    import trimesh

    dirty = trimesh.load(bar)
    faces = np.array(dirty.faces)[1:]
    faces[3:6] = faces[3:6, ::-1]
    trimesh.Trimesh(dirty.vertices, faces, process=False).export(tmp_path / "dirty.ply")
    code, out, _ = run("new", tmp_path / "whole", "--from", tmp_path / "dirty.ply", "--element-size", "10 mm")
    assert code == 0
    _only(tmp_path / "whole", "robot.toml", "dirty_healed.ply", "healing.txt", "healing.png", "rest.png")
    report = (tmp_path / "whole" / "healing.txt").read_text().splitlines()
    assert [line in out for line in report] == [True] * len(report)
    assert any(line.startswith("found: ") and "hole" in line for line in report)
    assert any("flipped" in line for line in report)
    assert (tmp_path / "whole" / "healing.png").read_bytes().startswith(b"\x89PNG")
    assert "." + "whole" not in out  # no name of a temporary folder
    assert hs.load_robot(tmp_path / "whole").body.mesh.volumes.sum() == pytest.approx(36e-6, rel=0.03)


WRONG = [
    (("--nodes", 5), "the number of nodes must be from 10 to 200000, not 5"),
    (("--nodes", 300, "--element-size", "5 mm"), "--nodes and --element-size: mutually exclusive. Give one of them."),
    (("--element-size", "1 m"), "elements of 1000 mm are too large for a body of 36 cm^3: take "),
    (("--element-size", "0.1 mm"), "elements of 0.1 mm would be about "),
    (("--element-size", "-1 mm"), "--element-size -1 mm: must be above 0, e.g. 12 mm"),
    (("--element-size", "12"), "--element-size 12: "),
    (("--size", "nan mm"), "--size nan mm: "),
    (("--thickness", "12 mm"), "--thickness: is only for drawings; leave it out"),
    (("--inflate", "12 mm"), "--inflate: is only for drawings; leave it out"),
    (("--material", "steel"), "unknown material"),
    (("--from", "starfish"), "starfish: is a robot of the gallery; write gallery:starfish"),
]


@pytest.mark.parametrize(("options", "words"), WRONG, ids=[" ".join(map(str, options)) for options, _ in WRONG])
def test_wrong_options_are_one_line_and_leave_nothing(
    run: Run, tmp_path: Path, bar: Path, options: tuple, words: str
) -> None:
    code, out, err = run("new", tmp_path / "bar", "--from", bar, *options)
    assert code == 2
    assert words in err
    assert err.count("\n") == 1
    assert not out
    _only(tmp_path, "my bar.stl")


@pytest.mark.parametrize("content", [b"", b"solid\nendsolid\n", b"\0" * 84, b"solid x\nvertex nan 0 0\n"])
def test_a_bad_file_leaves_nothing(run: Run, tmp_path: Path, content: bytes) -> None:
    (tmp_path / "bad.stl").write_bytes(content)
    code, _, err = run("new", tmp_path / "a", "--from", tmp_path / "bad.stl")
    assert code == 2
    assert "bad.stl" in err
    assert err.count("\n") == 1
    _only(tmp_path, "bad.stl")


@pytest.mark.slow
def test_an_empty_folder_is_filled_and_stays_when_that_fails(run: Run, tmp_path: Path, bar: Path) -> None:
    (tmp_path / "bar").mkdir()
    assert run("new", tmp_path / "bar", "--from", bar, "--element-size", "1 m")[0] == 2
    _only(tmp_path / "bar")
    assert run("new", tmp_path / "bar", "--from", bar, "--element-size", "12 mm")[0] == 0
    _only(tmp_path / "bar", "robot.toml", "my_bar.stl", "rest.png")
    code, _, err = run("new", tmp_path / "bar", "--from", bar)
    assert code == 2
    assert "already exists" in err


@pytest.mark.slow
def test_a_winch_without_room_at_the_held_end_moves_to_a_thicker_place(run: Run, tmp_path: Path) -> None:
    """A bar of 27 mm, held at its end, with 44 mm further on. Oracle: `hydrostat check` finds no error."""
    from manifold3d import Manifold
    from trimesh import Trimesh

    bar = Manifold.cube([160, 27, 27]).translate([0, -13.5, -13.5])
    solid = (bar + Manifold.cube([60, 44, 44], True).translate([110, 0, 0])).to_mesh()
    Trimesh(np.array(solid.vert_properties)[:, :3], np.array(solid.tri_verts)).export(tmp_path / "bell.stl")
    folder = tmp_path / "bell"
    assert "warning" not in run("new", folder, "--from", tmp_path / "bell.stl")[1]
    robot = hs.load_robot(folder)
    assert 0.08 < robot.winches[0].at[0] < 0.14
    assert robot.cables[0].points[0] == robot.winches[0].at
    assert run("check", folder)[0] == 0
