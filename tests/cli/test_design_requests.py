"""Requests for a design, typed and wished for in the studio. Oracle: the record that both of them fill."""

from dataclasses import replace
from pathlib import Path

import pytest
from builders import gallery_robot, strip_robot

from hydrostat.cli.design import warn_of_mirror
from hydrostat.cli.design_arguments import DesignArguments, parse_request
from hydrostat.design import BuildTolerances, DesignMethod, DesignRequest, RouteOptions, TreeOptions
from hydrostat.project import Wishes
from hydrostat.robot import PoseTarget, Robot
from hydrostat.studio import wished_request

UP = PoseTarget(name="up", targets={"tip": (0.18, 0.06)})


def robot() -> Robot:
    return replace(strip_robot(), poses={"up": UP})


def test_nothing_typed_and_nothing_wished_is_what_the_record_says(unchecked: None) -> None:
    usual = DesignRequest(poses=(UP,))
    assert parse_request(robot(), DesignArguments()) == usual
    assert wished_request(robot(), Wishes()) == usual
    assert (usual.winches, usual.cables, usual.options) == (2, 6, RouteOptions())
    assert DesignRequest(poses=(UP,), method=DesignMethod.TREES).options == TreeOptions()


def test_the_same_typed_and_wished_is_the_same_request(unchecked: None) -> None:
    typed = DesignArguments(
        winches="auto",
        cables=4,
        tolerance="2 mm",
        tension="12 N",
        clearance="4 mm",
        slack="3 mm",
        stepped_spools=True,
        lock_winch=["up"],
    )
    lengths = {"tolerance": 0.002, "clearance": 0.004, "slack": 0.003}
    wishes = Wishes.of(winches=0, cables=4, tension=12.0, stepped=True, kept_winches=("up",), **lengths)
    assert parse_request(robot(), typed) == wished_request(robot(), wishes)


def test_limits_of_the_robot_hold_unless_another_is_typed(capsys: pytest.CaptureFixture) -> None:
    limited = replace(robot(), max_tension=8.0, max_torque=0.05)
    own = parse_request(limited, DesignArguments()).constraints
    assert (own.tension, own.torque) == (8.0, 0.05)
    assert "limits of robot.toml: tension 8 N, torque 50 N mm" in capsys.readouterr().out
    typed = parse_request(limited, DesignArguments(tension="12 N")).constraints
    assert (typed.tension, typed.torque) == (12.0, None)
    other = parse_request(limited, DesignArguments(motor="sts3215")).constraints
    assert (other.tension, other.torque) == (20.0, None)


def test_knobs_of_the_thesis_have_the_same_names_everywhere() -> None:
    starfish = gallery_robot("starfish")
    knobs = {"threshold": 40, "distance": 2.5, "steps": 8, "phi": 0.3}
    typed = DesignArguments(method="chang2018", tree_option=[f"{name}={value}" for name, value in knobs.items()])
    wished = wished_request(starfish, Wishes.of(method=DesignMethod.CHANG2018, **knobs))
    assert wished == parse_request(starfish, typed)


def test_measured_tolerances_are_taken_unless_a_file_is_given(tmp_path: Path) -> None:
    measured, given = tmp_path / "tolerances.toml", tmp_path / "limits.toml"
    assert parse_request(robot(), DesignArguments(), measured=measured).uncertainty is None
    measured.write_text("[tolerances]\nyoung = 0.02\n")
    given.write_text("[tolerances]\nyoung = 0.3\n")
    for typed, young in (
        (DesignArguments(), 0.02),
        (DesignArguments(constraints=given), 0.3),
    ):
        uncertainty = parse_request(robot(), typed, measured=measured).uncertainty
        assert uncertainty is not None
        assert uncertainty.young == young
    exact = parse_request(robot(), DesignArguments(ideal=True), measured=measured).uncertainty
    assert exact == BuildTolerances.none()


def test_poses_that_a_symmetric_network_may_miss_are_named_before_the_search(
    unchecked: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Oracle: a tip on the mirror line that is lifted; with the pose that lowers it as much it is an image."""
    down = replace(UP, name="down", targets={"tip": (0.18, -0.06)})
    file = tmp_path / "limits.toml"
    file.write_text('mirror = "y"\n')
    for poses, told in (((UP,), "no pose mirrors pose up about y. A symmetric network may miss it."), ((UP, down), "")):
        source = replace(robot(), poses={pose.name: pose for pose in poses})
        for typed, cause in (
            (DesignArguments(symmetric="y"), "--symmetric"),
            (DesignArguments(constraints=file), f'mirror = "y" from {file}'),
        ):
            warn_of_mirror(source, parse_request(source, typed), typed)
            words = f"warning: {told} Remove {cause}, or add the mirror image as a pose\n"
            assert capsys.readouterr().err == (words if told else "")
        warn_of_mirror(source, parse_request(source, DesignArguments()), DesignArguments())
        assert capsys.readouterr().err == ""
