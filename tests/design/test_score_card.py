"""The score card. Oracle: JSON there and back, and the network's own numbers."""

import json
from dataclasses import replace

import numpy as np
import pytest
from plot.designs import hostile_network, plain_network

from hydrostat.design import Constraints, Zone, score_card
from hydrostat.robot import Mount, robot_hash

ZONED = Constraints(
    winch_zones=(Zone(box=((0.0, 0.0), (0.1, 0.1))),),
    keep_out=(Zone(at=(0.0, 0.0), radius=0.01),),
    passive_zones=(Zone(outline=((0.0, 0.0), (0.1, 0.0), (0.0, 0.1))),),
    mount=Mount.WORLD,
    locked_cables=("up 1",),
)


def test_a_grown_network_as_json() -> None:
    network = replace(plain_network(), request=replace(plain_network().request, constraints=ZONED))
    card = score_card(network, version="1.2.3")
    read = json.loads(json.dumps(card, allow_nan=False))
    assert read["rms_error"] == network.rms_error
    assert read["poses"]["up"]["errors"] == dict(network.ik_results[0].errors)
    assert read["poses"]["up"]["tensions"] == network.ik_results[0].pose.tensions.tolist()
    assert read["poses"]["up"]["contractions"] == {"up": 0.01, "down": 0.0}
    constraints = read["request"]["constraints"]
    assert constraints["keep_out"] == [{"at": [0.0, 0.0], "radius": 0.01, "box": None, "outline": []}]
    assert constraints["passive_zones"][0]["outline"] == [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]]
    assert constraints["mount"] == "world"
    assert [stage["rms_error"] for stage in read["stages"]] == [0.03 / number for number in range(1, 12)]
    assert [stage["cables"] for stage in read["stages"]] == [1] * 5 + [2] * 6
    assert read["certificate"] == {"further": 0.0021, "paths": 12345, "descent_rate": 0.0123}
    assert [other["rms_error"] for other in read["alternatives"]] == [0.0345, 0.0456]
    assert [other["robot"] for other in read["alternatives"]] == [
        robot_hash(other.robot) for other in network.alternatives
    ]
    assert (read["request"]["method"], read["version"], read["complete"]) == ("routes", "1.2.3", True)
    assert (read["request"]["poses"], read["request"]["options"]["max_edges"]) == (["up"], 14)
    assert (read["robot"], read["source_robot"]) == (robot_hash(network.robot), robot_hash(network.source))


def test_lengths_of_cables_and_their_sheaths() -> None:
    network = hostile_network()
    card = score_card(network, version="")
    first, second = card["cables"]
    spans = np.linalg.norm(np.diff(np.array(network.robot.cables[0].points), axis=0), axis=1)
    assert first["length"] == pytest.approx(spans.sum())
    assert first["sheathed"] == pytest.approx(spans[0])
    assert second["sheathed"] == 0.0
    assert first["via_points"] == len(spans) - 1
    assert card["tree_score"] == 0.5
    assert card["request"]["options"]["fibres"] == "edges"


def test_a_stepped_spool_is_told() -> None:
    network = plain_network()
    one, two = network.robot.cables
    stepped = network.robot.with_network(network.robot.winches, (replace(one, spool_radius=0.009), two))
    cables = score_card(replace(network, robot=stepped), version="")["cables"]
    assert [cable["spool_ratio"] for cable in cables] == pytest.approx([1.5, 1.0])
