"""`Glb`: a binary glTF 2.0 file, which Blender, browsers, three.js and Windows open."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hydrostat.arrays import Bool, Float, Int

FLOAT, UNSIGNED = 5126, 5125  # kinds of numbers in glTF: 32 bits each
VERTICES, INDICES = 34962, 34963  # what an array is used for


@dataclass(frozen=True, kw_only=True, eq=False)
class GlbPart:
    """An object of triangles that changes its shape."""

    name: str  # that a program shows
    triangles: Int[np.ndarray, "triangles 3"]  # corners of each, counter-clockwise seen from outside, (triangles, 3)
    places: Float[np.ndarray, "keys vertices 3"]  # of the vertices in every key, (keys, vertices, 3) [m]
    normals: Float[np.ndarray, "keys vertices 3"]  # of length 1, (keys, vertices, 3)
    colors: Float[np.ndarray, "some vertices 3"]  # linear red, green, blue, in every key or one for all
    opacity: float = 1.0  # 1, or less for what parts within shine through


class Glb:
    """A scene with one animation, built part by part.

    The first key is the mesh itself; each further key is a morph target, of which an animation mixes one after the
    other. Lengths are meters, and y is up after the turn of the scene.
    """

    def __init__(self, name: str, *, turn: tuple[float, float, float, float]) -> None:
        """An empty scene: the name of its root, and its turn as a quaternion (x, y, z, w)."""
        self._bytes = bytearray()
        self._keys = 1
        self._morphed: list[int] = []
        self._carried: dict[int, np.ndarray] = {}
        self._seen: dict[int, np.ndarray] = {}
        self._document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "hydrostat"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": name, "rotation": list(turn), "children": []}],
            "meshes": [],
            "materials": [],
            "accessors": [],
            "bufferViews": [],
        }

    def add(self, shape: GlbPart) -> None:
        """Put a shape into the scene."""
        node = self._node({"name": shape.name, "mesh": self._mesh(shape)})
        if len(shape.places) > 1:
            self._keys = len(shape.places)
            self._morphed.append(node)

    def add_copies(
        self,
        shape: GlbPart,
        places: Float[np.ndarray, "some copies 3"],
        names: Sequence[str],
        seen: Bool[np.ndarray, "frames copies"] | None = None,
    ) -> None:
        """Put a rigid shape to places [m], in every key or one for all; `seen` tells when each copy is there."""
        mesh = self._mesh(shape)
        for index, name in enumerate(names):
            begin = [float(value) for value in places[0, index]]
            node = self._node({"name": name, "mesh": mesh, "translation": begin})
            if (places[:, index] != places[0, index]).any():
                self._carried[node] = places[:, index]
            if seen is not None:
                self._seen[node] = seen[:, index]

    def _node(self, node: dict[str, Any]) -> int:
        nodes = self._document["nodes"]
        nodes[0]["children"].append(len(nodes))
        nodes.append(node)
        return len(nodes) - 1

    def _mesh(self, shape: GlbPart) -> int:
        attributes = {
            "POSITION": self._array(shape.places[0], bounds=True),
            "NORMAL": self._array(shape.normals[0]),
            "COLOR_0": self._array(shape.colors[0]),
        }
        corners = shape.triangles.astype("<u4").reshape(-1, 1)
        indices = self._accessor(corners, UNSIGNED, bounds=False, use=INDICES)
        mesh: dict[str, Any] = {
            "name": shape.name,
            "primitives": [{"attributes": attributes, "indices": indices, "material": self._material(shape)}],
        }
        if len(shape.places) > 1:
            mesh["primitives"][0]["targets"] = [self._target(shape, key) for key in range(1, len(shape.places))]
            mesh["weights"] = [0.0] * (len(shape.places) - 1)
        self._document["meshes"].append(mesh)
        return len(self._document["meshes"]) - 1

    def animate(self, times: Float[np.ndarray, " instants"], order: Sequence[int], *, name: str) -> None:
        """Go from one key to the next in their order, evenly between instants [s]."""
        source = self._array(times[:, None], bounds=True, use=None)
        samplers: list[dict[str, Any]] = []
        channels: list[dict[str, Any]] = []

        def change(nodes: Sequence[int], path: str, values: np.ndarray, between: str = "LINEAR") -> None:
            channels.extend({"sampler": len(samplers), "target": {"node": node, "path": path}} for node in nodes)
            samplers.append({"input": source, "interpolation": between, "output": self._array(values, use=None)})

        if self._morphed:
            weights = np.eye(self._keys)[list(order)][:, 1:]
            change(self._morphed, "weights", weights.reshape(-1, 1))
        for node, places in self._carried.items():
            change([node], "translation", places[list(order)])
        for node, shown in self._seen.items():
            change([node], "scale", np.repeat(shown[:, None], 3, axis=1), "STEP")
        if channels:
            self._document["animations"] = [{"name": name, "samplers": samplers, "channels": channels}]

    def content(self) -> bytes:
        """The whole file: a head, the description as JSON, and the numbers."""
        document = {**self._document, "buffers": [{"byteLength": len(self._bytes)}]}
        words = json.dumps(document, separators=(",", ":"), ensure_ascii=True).encode()
        words += b" " * (-len(words) % 4)
        length = 12 + 8 + len(words) + 8 + len(self._bytes)
        sizes = [np.uint32(size).tobytes() for size in (2, length, len(words), len(self._bytes))]
        return b"".join([b"glTF", *sizes[:2], sizes[2], b"JSON", words, sizes[3], b"BIN\0", bytes(self._bytes)])

    def _target(self, shape: GlbPart, key: int) -> dict[str, int]:
        """Morph target of a key: accessors of the differences from the first key."""
        base = shape.places[0].astype(np.float32)
        target = {
            "POSITION": self._array(shape.places[key] - base, bounds=True),
            "NORMAL": self._array(shape.normals[key] - shape.normals[0].astype(np.float32)),
        }
        if len(shape.colors) > 1:
            target["COLOR_0"] = self._array(shape.colors[key] - shape.colors[0].astype(np.float32))
        return target

    def _material(self, shape: GlbPart) -> int:
        look = {"baseColorFactor": [1.0, 1.0, 1.0, shape.opacity], "metallicFactor": 0.0, "roughnessFactor": 0.85}
        material: dict[str, Any] = {"name": shape.name, "pbrMetallicRoughness": look}
        if shape.opacity < 1:
            material["alphaMode"] = "BLEND"
        self._document["materials"].append(material)
        return len(self._document["materials"]) - 1

    def _array(self, values: np.ndarray, *, bounds: bool = False, use: int | None = VERTICES) -> int:
        numbers = np.ascontiguousarray(values, dtype="<f4") + np.float32(0)
        return self._accessor(numbers, FLOAT, bounds=bounds, use=use)

    def _accessor(self, numbers: np.ndarray, kind: int, *, bounds: bool, use: int | None) -> int:
        """Append numbers, all of 4 bytes and so in step, and describe them."""
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self._bytes), "byteLength": numbers.nbytes}
        if use is not None:
            view["target"] = use
        self._bytes += numbers.tobytes()
        self._document["bufferViews"].append(view)
        accessor: dict[str, Any] = {
            "bufferView": len(self._document["bufferViews"]) - 1,
            "componentType": kind,
            "count": len(numbers),
            "type": "SCALAR" if numbers.shape[1] == 1 else "VEC3",
        }
        if bounds:
            accessor["min"] = [float(value) for value in numbers.min(axis=0)]
            accessor["max"] = [float(value) for value in numbers.max(axis=0)]
        self._document["accessors"].append(accessor)
        return len(self._document["accessors"]) - 1
