"""The browser opens messages as they were packed. Oracle: the Python that packs them."""

from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot
from view_modules import needs_node, run

from hydrostat.studio.view.picture import Picture, packet, parse_message
from hydrostat.studio.view.robot_items import robot_items

SCRIPT = """
import { readFileSync } from "node:fs";
import { opened } from "./view/packet.js";
const bytes = readFileSync(given[0]);
const { head, arrays } = opened(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
const tables = {};
for (const [name, a] of Object.entries(arrays)) tables[name] = [a.constructor.name, a.rows, a.columns, [...a]];
console.log(JSON.stringify({ head, tables }));
"""


def check(folder: Path, message: bytes) -> None:
    file = folder / "message"
    file.write_bytes(message)
    found = run(folder, SCRIPT, file)
    head, arrays = parse_message(message)
    assert found["head"] == head
    assert list(found["tables"]) == list(arrays)
    for name, array in arrays.items():
        kind, rows, columns, numbers = found["tables"][name]
        assert kind == {"f": "Float32Array", "u": "Uint32Array"}[array.dtype.kind]
        assert (rows, columns) == array.shape
        assert np.array_equal(np.array(numbers, dtype=array.dtype).reshape(array.shape), array)


@needs_node
@pytest.mark.parametrize("word", ["", "a", "ab", "abc", "größe ✂"])
def test_words_of_any_length_and_tables_of_any_size(tmp_path: Path, word: str) -> None:
    arrays = {
        "none": np.zeros((0, 3)),
        "row": np.array([1.5, -2.25]),
        "whole": np.array([[0, 7], [2**32 - 1, 3]], dtype=np.uint32),
        "ghost:rest": np.arange(6.0).reshape(2, 3),
    }
    check(tmp_path, packet({"kind": "scene", "name": word, "items": [{"chosen": True}]}, arrays))


@needs_node
def test_frame_of_a_robot(tmp_path: Path) -> None:
    robot = gallery_robot("fish_tail")
    items = robot_items(robot)
    picture = Picture(robot, items, 3)
    check(tmp_path, picture.frame(robot.body.mesh.nodes, items, {"stamp": 12.5}))
