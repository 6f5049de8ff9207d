"""Binary glTF scenes, read by a small parser of the tests and by trimesh."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import trimesh
from builders import box_mesh, box_robot, strip_mesh
from plot.films import flat_film, frames_of, space_film
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from hydrostat.errors import InputError
from hydrostat.plot import Frame, save_glb
from hydrostat.plot import solids as shapes
from hydrostat.plot.scene import MAX_KEYS
from hydrostat.robot import Robot

FILMS = {"space": space_film, "flat": flat_film}
COUNTS = {"SCALAR": 1, "VEC3": 3}


@dataclass
class Scene:
    """A file taken apart by what the standard says: head, JSON chunk, binary chunk."""

    document: dict
    numbers: bytes

    @classmethod
    def read(cls, path: Path) -> "Scene":
        whole = path.read_bytes()
        head = np.frombuffer(whole, "<u4", 5)
        assert whole[:4] == b"glTF"
        assert head[1] == 2
        assert head[2] == len(whole)
        assert whole[16:20] == b"JSON"
        start = 20 + int(head[3])
        size = int(np.frombuffer(whole, "<u4", 1, start)[0])
        assert whole[start + 4 : start + 8] == b"BIN\0"
        assert start + 8 + size == len(whole)
        assert size % 4 == 0
        document = json.loads(whole[20:start])
        assert document["buffers"] == [{"byteLength": size}]
        return cls(document, whole[start + 8 :])

    def array(self, index: int) -> np.ndarray:
        accessor = self.document["accessors"][index]
        view = self.document["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5125: "<u4"}[accessor["componentType"]]
        count = accessor["count"] * COUNTS[accessor["type"]]
        assert view["byteLength"] == 4 * count
        return np.frombuffer(self.numbers, kind, count, view["byteOffset"]).reshape(accessor["count"], -1)

    def node(self, name: str) -> int:
        return [node["name"] for node in self.document["nodes"]].index(name)

    def mesh(self, name: str) -> dict:
        (primitive,) = self.document["meshes"][self.document["nodes"][self.node(name)]["mesh"]]["primitives"]
        return primitive

    def channel(self, name: str, path: str) -> tuple[np.ndarray, np.ndarray]:
        (animation,) = self.document["animations"]
        wanted = {"node": self.node(name), "path": path}
        (number,) = (entry["sampler"] for entry in animation["channels"] if entry["target"] == wanted)
        sampler = animation["samplers"][number]
        return self.array(sampler["input"])[:, 0], self.array(sampler["output"])


def scene(kind: str, folder: Path) -> Scene:
    robot, made = FILMS[kind]()
    return Scene.read(save_glb(robot, made.frames, folder / "a.glb", step=made.step))


def at_time(read: Scene, name: str, attribute: str, time: float) -> np.ndarray:
    """What a program shows: the mesh and its targets, each with its weight, which go evenly between instants."""
    primitive = read.mesh(name)
    times, weights = read.channel(name, "weights")
    weights = weights.reshape(len(times), len(primitive["targets"]))
    now = np.array([np.interp(time, times, column) for column in weights.T])
    total = read.array(primitive["attributes"][attribute]).astype(float)
    for weight, target in zip(now, primitive["targets"], strict=True):
        total = total + weight * read.array(target[attribute])
    return total


@pytest.mark.parametrize("kind", FILMS)
def test_at_the_time_of_a_frame_the_body_is_where_the_simulation_says(kind: str, tmp_path: Path) -> None:
    """Oracle: the boundary nodes of each frame; of a flat body at half its thickness before and behind."""
    robot, made = FILMS[kind]()
    read = scene(kind, tmp_path)
    for number in (0, 3, 6, 9, 12):
        places = at_time(read, "body", "POSITION", number * made.step)
        nodes = made.frames[number].nodes
        if kind == "flat":
            assert np.abs(places[:, 2]) == pytest.approx(robot.body.thickness / 2)  # pyright: ignore[reportOptionalOperand]
            places = places[:, :2]
        expected = nodes[robot.body.mesh.boundary_nodes]
        assert cKDTree(places).query(expected)[0].max() < 2e-7
        assert cKDTree(nodes).query(places)[0].max() < 2e-7


def test_one_target_with_weight_one_is_one_pose(tmp_path: Path) -> None:
    """Oracle: the furthest frame of the film, an equilibrium of the simulation."""
    _, made = space_film()
    read = scene("space", tmp_path)
    primitive = read.mesh("body")
    base = read.array(primitive["attributes"]["POSITION"]).astype(float)
    pose = made.frames[6].nodes
    off = [
        float(cKDTree(pose).query(base + read.array(target["POSITION"]))[0].max()) for target in primitive["targets"]
    ]
    assert min(off) < 2e-7
    times, weights = read.channel("body", "weights")
    shown = weights.reshape(len(times), -1)[int(np.argmin(np.abs(times - 6 * made.step)))]
    assert shown.argmax() == int(np.argmin(off))
    assert shown.sum() == 1


@pytest.mark.parametrize("kind", FILMS)
def test_least_and_largest_numbers_are_true(kind: str, tmp_path: Path) -> None:
    """Oracle: the numbers; the standard wants bounds of every position, and of the times."""
    read = scene(kind, tmp_path)
    bounded = [index for index, entry in enumerate(read.document["accessors"]) if "min" in entry]
    for index in bounded:
        entry, values = read.document["accessors"][index], read.array(index)
        assert np.float32(entry["min"]).tolist() == values.min(axis=0).tolist()
        assert np.float32(entry["max"]).tolist() == values.max(axis=0).tolist()
    for mesh in read.document["meshes"]:
        (primitive,) = mesh["primitives"]
        positions = [primitive["attributes"]["POSITION"]]
        positions += [target["POSITION"] for target in primitive.get("targets", [])]
        assert set(positions) <= set(bounded)


@pytest.mark.parametrize("kind", FILMS)
def test_normals_have_length_one_and_indices_are_in_range(kind: str, tmp_path: Path) -> None:
    read = scene(kind, tmp_path)
    for mesh in read.document["meshes"]:
        (primitive,) = mesh["primitives"]
        normals = read.array(primitive["attributes"]["NORMAL"]).astype(float)
        for target in [None, *primitive.get("targets", [])]:
            now = normals if target is None else normals + read.array(target["NORMAL"])
            assert np.linalg.norm(now, axis=1) == pytest.approx(1, abs=1e-5)
        indices = read.array(primitive["indices"])
        assert indices.max() < len(normals)
        assert len(indices) % 3 == 0


@pytest.mark.parametrize("kind", FILMS)
def test_another_program_finds_the_volume_of_the_body(kind: str, tmp_path: Path) -> None:
    """Oracle: trimesh's volume of what it read against that of the mesh; a hole or a turned triangle would show."""
    robot, made = FILMS[kind]()
    loaded = trimesh.load(save_glb(robot, made.frames, tmp_path / "a.glb", step=made.step), process=False)
    volume = float(robot.body.mesh.volumes.sum()) * (1.0 if kind == "space" else robot.body.thickness or 0.0)
    assert loaded.geometry["body"].volume == pytest.approx(volume, rel=1e-5)  # pyright: ignore[reportAttributeAccessIssue]


def test_winches_and_markers_are_carried_and_targets_come_and_go(tmp_path: Path) -> None:
    """Oracle: the marker of each frame by its element's weights; the target's place, and the frames it is shown in."""
    from hydrostat.plot.frame import Attachments

    robot, made = space_film()
    read = scene("space", tmp_path)
    times, places = read.channel("marker tip", "translation")
    for time, place in zip(times, places, strict=True):
        nodes = made.frames[round(float(time) / made.step)].nodes
        assert place == pytest.approx(Attachments(robot).markers(nodes)[0], abs=1e-6)
    name = "target nod: tip"
    assert read.document["nodes"][read.node(name)]["translation"] == pytest.approx([0.11, 0.03, 0.03])
    times, sizes = read.channel(name, "scale")
    for time, size in zip(times, sizes, strict=True):
        frame = made.frames[round(float(time) / made.step)]
        assert size.tolist() == ([1.0] * 3 if frame.target is not None else [0.0] * 3)
    assert {"winch one", "winch two", "stopper 1", "stopper 2"} <= {node["name"] for node in read.document["nodes"]}


def test_cables_wear_the_color_of_their_tension(tmp_path: Path) -> None:
    """Oracle: the scale of tension, as light."""
    from hydrostat.plot.tension_scale import TensionScale

    _, made = space_film()
    read = scene("space", tmp_path)
    scale = TensionScale.of(np.concatenate([frame.tensions for frame in made.frames]))
    for number in (0, 6):
        colors = at_time(read, "cables", "COLOR_0", number * made.step)
        half = len(colors) // 2
        for index, color in enumerate((colors[0], colors[half])):
            words = scale.color(float(made.frames[number].tensions[index]))
            screen = np.where(color <= 0.0031308, 12.92 * color, 1.055 * np.abs(color) ** (1 / 2.4) - 0.055)
            wanted = [int(words[start : start + 2], 16) for start in (1, 3, 5)]
            assert np.round(255 * screen).tolist() == wanted


@pytest.mark.parametrize("gravity", [None, (0.0, -9.81, 0.0), (9.81, 0.0, 0.0), (0.0, 0.0, 9.81), (1.0, 2.0, -3.0)])
def test_against_gravity_is_y(gravity: tuple[float, float, float] | None, tmp_path: Path) -> None:
    """Oracle: scipy's turn of the way up by the quaternion of the root."""
    robot = heavy(gravity)
    read = Scene.read(save_glb(robot, frames_of(robot, 1), tmp_path / "a.glb", step=0.1))
    up = np.array([0.0, 0, 1]) if gravity is None else -np.array(gravity) / np.linalg.norm(gravity)
    turn = Rotation.from_quat(read.document["nodes"][0]["rotation"])
    assert turn.apply(up) == pytest.approx([0, 1, 0], abs=1e-6)
    assert "animations" not in read.document


def heavy(gravity: tuple[float, float, float] | None) -> Robot:
    from dataclasses import replace

    return replace(box_robot(), gravity=gravity)


def test_frames_that_come_again_are_one_key_and_long_films_have_not_too_many(tmp_path: Path) -> None:
    """Oracle: there and back is as many keys as there; of 300 different frames no more than the most."""
    robot, made = space_film()
    ways = [*made.frames[:7], *made.frames[5::-1]]
    read = Scene.read(save_glb(robot, ways, tmp_path / "a.glb", step=0.1))
    assert len(read.mesh("body")["targets"]) == len({frame.nodes.tobytes() for frame in made.frames[:7]}) - 1
    step = made.frames[6].nodes - made.frames[0].nodes
    long = [Frame(nodes=made.frames[0].nodes + share * step, tensions=np.zeros(2)) for share in np.linspace(0, 1, 300)]
    read = Scene.read(save_glb(robot, long, tmp_path / "b.glb", step=0.1))
    assert len(read.mesh("body")["targets"]) < MAX_KEYS
    last = at_time(read, "body", "POSITION", 29.9)
    assert cKDTree(made.frames[6].nodes).query(last)[0].max() < 2e-7


def test_the_same_frames_give_the_same_bytes(tmp_path: Path) -> None:
    robot, made = space_film()
    one, two = (save_glb(robot, made.frames, tmp_path / f"{name}.glb", step=0.1).read_bytes() for name in "ab")
    assert one == two


@pytest.mark.parametrize("step", [0.0, -1.0, np.inf, np.nan])
def test_one_clear_line(step: float, tmp_path: Path) -> None:
    robot, made = space_film()
    with pytest.raises(InputError, match="above 0 s"):
        save_glb(robot, made.frames, tmp_path / "a.glb", step=step)


def volume_of(solid: shapes.Solid) -> float:
    triangles, places, normals = solid
    a, b, c = (places[0][corner] for corner in triangles.T)
    flat = np.cross(b - a, c - a)
    assert (np.einsum("td,tcd->tc", flat, normals[0][triangles]) > -1e-12).all()
    return float(np.einsum("td,td->", a, flat) / 6)


def test_solids_are_closed_and_turned_outward() -> None:
    """Oracle: exact volumes of the polyhedra; of a sphere, that of the ball less what facets cut off."""
    mesh = box_mesh((2, 2, 2), size=(0.1, 0.2, 0.3))
    assert volume_of(shapes.skin(mesh, mesh.nodes[None])) == pytest.approx(0.006)
    flat = strip_mesh(4, 2)
    assert volume_of(shapes.slab(flat, flat.nodes[None], 0.03)) == pytest.approx(0.2 * 0.05 * 0.03)
    assert 0.6 < volume_of(shapes.sphere(1.0)) / (4 / 3 * np.pi) < 1
    drum, sides = np.array([0.36, 1.0, 1.0]), 16
    area = sides / 2 * np.sin(2 * np.pi / sides)
    assert volume_of(shapes.spool(np.array([1.0, 2, 3]), 1.0)) == pytest.approx(area * (drum @ [0.6, 0.2, 0.2]))
    assert volume_of(shapes.cross(2.0)) == pytest.approx(3 * 8 * 0.16**2)


def test_a_tube_keeps_its_radius_and_does_not_twist_as_it_bends() -> None:
    """Oracle: distance of every vertex to its point; ring by ring the vertices move as the points do."""
    along = np.linspace(0, 1, 9)
    straight = np.stack([along, 0 * along, 0 * along], axis=1)
    bent = np.stack([np.sin(along), 1 - np.cos(along), 0 * along], axis=1)
    points = np.stack([straight, bent])
    _, places, normals = shapes.tube(points, 0.1)
    rings = places.reshape(2, 9, shapes.SIDES, 3)
    assert np.linalg.norm(rings - points[:, :, None], axis=3) == pytest.approx(0.1)
    assert np.linalg.norm(normals, axis=2) == pytest.approx(1)
    upright = rings[:, :, :, 2]
    assert upright[0] == pytest.approx(upright[1], abs=1e-9)


def test_a_tube_through_a_point_twice_is_no_trouble() -> None:
    points = np.array([[[0.0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 0, 0]]])
    _, places, normals = shapes.tube(points, 0.1)
    assert np.isfinite(places).all()
    assert np.isfinite(normals).all()
