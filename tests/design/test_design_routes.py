"""Whole designs by routes. Oracles: counts asked for, the checks of `buildable`, bodies that are symmetric, hashes."""

from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from builders import gallery_robot, mesh_body, strip_mesh, strip_robot

from hydrostat.design import Constraints, DesignRequest, Network, TreeOptions, design_cables
from hydrostat.design.buildable import pulls, violations
from hydrostat.design.network import RouteTrace
from hydrostat.design.region import Region
from hydrostat.design.request import RouteOptions
from hydrostat.design.routes import design_routes as routes
from hydrostat.design.routes import final_judgement, finalists
from hydrostat.design.routes.deadline import Deadline
from hydrostat.design.zone import Zone
from hydrostat.errors import HydrostatError, InputError
from hydrostat.fabrication import Demand, find_refusals
from hydrostat.ik import solve_ik
from hydrostat.progress import no_progress
from hydrostat.robot import Marker, Mount, Pin, PoseTarget, Robot, Winch, robot_hash
from hydrostat.simulation import BodyPhysics, Simulation

UP = PoseTarget(name="up", targets={"tip": (0.18, 0.06)})
DOWN = PoseTarget(name="down", targets={"tip": (0.185, -0.05)})
PINCH = PoseTarget(name="pinch", targets={"tip": (0.085, 0.045), "low": (0.085, -0.045)})
SPREAD = PoseTarget(name="spread", targets={"tip": (0.095, 0.055), "low": (0.095, -0.055)})
SMALL = RouteOptions(starts=1, exchanges=0, refine_steps=4, trials=2, steps=3, max_edges=8)


def strip() -> Robot:
    """With two cables of its own: one above, one below the middle."""
    return strip_robot(columns=10, rows=3)


def bare() -> Robot:
    return strip().with_network((), ())


def deep(robot: Robot | None = None) -> Robot:
    """So thick that two units lie one above the other: no winches are pushed apart for a kit, which takes longest."""
    robot = robot or strip()
    return replace(robot, body=replace(robot.body, thickness=0.045))


def deep_and_bare() -> Robot:
    return deep().with_network((), ())


def plate() -> Robot:
    """200 x 120 mm about the origin, held at its left side."""
    mesh = strip_mesh(10, 8, size=(0.2, 0.12))
    return replace(
        bare(),
        body=mesh_body(replace(mesh, nodes=mesh.nodes - np.array([0.1, 0.0]))),
        pins=(Pin(box=((-0.101, -1.0), (-0.099, 1.0))),),
        markers=(Marker(name="tip", at=(0.1, 0.04)), Marker(name="low", at=(0.1, -0.04))),
    )


@dataclass(frozen=True)
class Case:
    winches: int = 2
    cables: int = 4
    poses: tuple[PoseTarget, ...] = (UP, DOWN)
    robot: Robot = field(default_factory=bare)
    warm_start: bool = False


def near_the_edge() -> Robot:
    """With one winch 2 mm inside the edge, and no cable."""
    return strip().with_network([Winch(name="mine", at=(0.02, 0.023))], [])


def over_the_body() -> Robot:
    """With one winch in the world over the body, which each good cable would pass on its way back; and no cable."""
    return strip().with_network([Winch(name="mine", at=(0.06, 0.0), mount=Mount.WORLD)], [])


LIMITS: dict[str, tuple[Case, dict[str, Any]]] = {
    "usual": (Case(robot=deep_and_bare()), {}),
    "still across, with slack": (
        Case(1, 2, (UP,)),
        {"passive_zones": (Zone(box=((0.05, -0.03), (0.1, 0.03))),), "slack": 0.004},
    ),
    "still and small, with a short travel": (
        Case(1, 2, (UP,)),
        {"passive_zones": (Zone(at=(0.1, 0.015), radius=0.006),), "travel": 0.008},
    ),
    "keep out, on like spools": (
        Case(1, 2, (UP,)),
        {"keep_out": (Zone(at=(0.1, 0.015), radius=0.006),), "spool_ratio": 1.5},
    ),
    "keep out of a slot, winches not built in": (
        Case(1, 2, (UP,)),
        {"keep_out": (Zone(box=((0.09, 0.01), (0.094, 0.02))),), "built_in": False},
    ),
    "winch zones and clearance": (
        Case(2, 2, robot=deep_and_bare()),
        {"winch_zones": (Zone(box=((0.09, -0.01), (0.15, 0.01))),), "winch_clearance": 0.016},
    ),
    "winches as near to the edge as cables, which may cross": (
        Case(1, 2, (UP,)),
        {"winch_clearance": 0.0, "cable_gap": 0.0},
    ),
    "winch gap": (Case(2, 2), {"winch_gap": 0.09}),
    "gaps": (Case(2, 3, robot=deep_and_bare()), {"hole_gap": 0.015, "cable_gap": 0.009}),
    "turn and clearance": (Case(1, 2, (UP,)), {"max_turn": 20.0, "clearance": 0.012}),
    "bend radius and length": (Case(1, 2, (UP,)), {"bend_radius": 0.06, "max_length": 0.08}),
    "tension": (Case(2, 3, robot=deep_and_bare()), {"tension": 4.0}),
    "torque": (Case(2, 4, robot=deep_and_bare()), {"torque": 0.05, "cables_per_winch": 2}),
    "release, no leads": (Case(2, 3, robot=deep_and_bare()), {"release": 0.01, "leads": False}),
    "two ways": (Case(1, 3), {"two_way": True}),
    "mirror, one winch": (Case(1, 2, (PINCH,), plate()), {"mirror": "y"}),
    "mirror, two winches": (Case(2, 4, (PINCH, SPREAD), plate()), {"mirror": "y", "cables_per_winch": 2}),
    "locked winch": (Case(2, 2, robot=deep()), {"locked_winches": ("up",)}),
    "locked winch at the edge": (Case(1, 1, (UP,), near_the_edge()), {"locked_winches": ("mine",)}),
    "locked cable": (Case(2, 3, robot=deep()), {"locked_cables": ("down 1",)}),
    "locked cable alone": (Case(1, 1, robot=strip()), {"locked_cables": ("down 1",)}),
    "world": (Case(1, 2, (UP,), strip_robot(columns=10, rows=3, mount=Mount.WORLD)), {"mount": Mount.WORLD}),
    "world, over the body": (Case(1, 2, (UP,), over_the_body()), {"mount": Mount.WORLD}),
    "improved beside a locked cable": (Case(2, 2, robot=deep(), warm_start=True), {"locked_cables": ("down 1",)}),
}


@cache
def designed(name: str) -> Network:
    case, limits = LIMITS[name]
    return design_cables(
        case.robot, case.poses, winches=case.winches, cables=case.cables, constraints=Constraints(**limits),
        options=SMALL, warm_start=case.warm_start,
    )  # fmt: skip


def broken(network: Network) -> list[str]:
    limits = network.constraints
    region = Region.of_body(network.robot.body, limits.clearance)
    return [
        *violations(network.robot, limits, region),
        *pulls(network.robot, network.ik_results, limits),
    ]


def at_rest(robot: Robot, poses: tuple[PoseTarget, ...]) -> float:
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    squares = [np.mean([np.sum((places[n] - at) ** 2) for n, at in pose.targets.items()]) for pose in poses]
    return float(np.sqrt(np.mean(squares)))


@pytest.mark.parametrize("name", LIMITS)
@pytest.mark.slow
def test_every_constraint_is_kept(name: str, unchecked: None) -> None:
    network, (case, _) = designed(name), LIMITS[name]
    assert broken(network) == []
    robot = network.robot
    counts = {winch.name: sum(cable.winch == winch.name for cable in robot.cables) for winch in robot.winches}
    asked = [one for one in network.alternatives if len(one.robot.winches) == case.winches]
    if len(robot.winches) < case.winches:  # then no kit could be made of those with as many as were asked for
        assert asked
        assert all(find_refusals(one.robot, Demand.of_results(one.robot, one.ik_results)) for one in asked)
    assert len(robot.winches) <= case.winches
    assert len(robot.winches) <= len(robot.cables) <= case.cables
    assert max(counts.values()) <= network.constraints.cables_per_winch
    assert network.rms_error < at_rest(case.robot, case.poses)
    assert network.complete
    assert [reached.target for reached in network.ik_results] == list(case.poses)


def test_every_constraint_has_a_case() -> None:
    """But a depth under the skin, which designs of bodies in space keep (`test_skin_region`), a motor
    (`test_winch_room`), and a distance from drawn shapes (`test_drawn_shapes`).
    """
    asked = {key for _, limits in LIMITS.values() for key in limits}
    assert asked == set(Constraints.__dataclass_fields__) - {"spool_radius", "depth", "motor", "drawing_gap"}


@pytest.mark.parametrize("name", ["usual", "tension", "mirror, two winches"])
@pytest.mark.slow
def test_the_error_told_is_what_its_user_finds(name: str, unchecked: None) -> None:
    """Oracle: inverse kinematics of a fresh simulation."""
    network = designed(name)
    limits = network.constraints.limits
    for reached in network.ik_results:
        fresh = solve_ik(Simulation(network.robot), reached.target, limits=limits)
        assert reached.rms_error == pytest.approx(fresh.rms_error, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["usual", "gaps", "release, no leads"])
def test_more_cables_do_no_harm(name: str, unchecked: None) -> None:
    """Cables that spoil what there was are left out: by two cables the strip is brought within a few millimeters."""
    assert designed(name).rms_error < 0.2 * at_rest(bare(), (UP, DOWN))


@pytest.mark.slow
def test_a_network_whose_kit_fits_comes_first(monkeypatch: pytest.MonkeyPatch, unchecked: None) -> None:
    """Where no kit can be made of the refined networks, the best one on the way is taken: here one of 3 cables."""
    for module in (final_judgement, finalists):
        monkeypatch.setattr(module, "kit_fits", lambda network: len(network.robot.cables) == 3)
    network = design_cables(bare(), [UP, DOWN], winches=2, cables=4, options=SMALL)
    assert len(network.robot.cables) == 3


def test_a_time_limit_gives_the_best_network_so_far(unchecked: None) -> None:
    """Also where it is over before the first network: that one is waited for."""
    network = design_cables(bare(), [UP, DOWN], winches=2, cables=2, seconds=1e-3)
    assert network.timed_out
    assert not network.complete
    assert broken(network) == []
    with pytest.raises(InputError, match="seconds must be finite and above 0 s, or None for no limit, not 0"):
        DesignRequest(poses=(UP, DOWN), seconds=0)


@pytest.mark.parametrize("allowed", [15, 40])
def test_search_and_judgement_end_with_their_time(
    allowed: int, monkeypatch: pytest.MonkeyPatch, unchecked: None
) -> None:
    """Oracle: a clock that ticks with each layout. No kit fits, so the judgement tries layouts for its second."""
    for module in (final_judgement, finalists):
        monkeypatch.setattr(module, "kit_fits", lambda network: False)
    request, deadline = DesignRequest(poses=(UP, DOWN), winches=2, cables=4), Deadline(allowed)
    robot = bare()
    search = routes.RouteSearch(robot, request, BodyPhysics(robot), no_progress, deadline=deadline)
    deadline.clock = lambda: float(search.evaluator.solves)
    network = search.run()
    assert (network.timed_out, network.complete) == (True, False)
    assert network.num_evaluated == allowed + 1


def test_winches_move_apart_where_their_units_meet(unchecked: None) -> None:
    """Oracle: the kit, which refuses units of 25 x 25 x 40 mm as near as the constraints alone would let them be."""
    network = design_cables(bare(), [UP, DOWN], winches=2, cables=2)
    assert len(network.robot.winches) == 2
    assert find_refusals(network.robot, Demand.of_results(network.robot, network.ik_results)) == ()
    one, other = (np.array(winch.at) for winch in network.robot.winches)
    assert np.linalg.norm(one - other) > Constraints().winch_gap


@pytest.mark.slow
def test_winches_move_apart_for_motors_that_hold_for_long(monkeypatch: pytest.MonkeyPatch, unchecked: None) -> None:
    """Oracle: the distance at which the stronger motors fit, just above that of the network without them."""

    def far(robot: Robot) -> float:
        return float(np.linalg.norm(np.subtract(*(winch.at for winch in robot.winches))))

    usual = designed("usual")
    enough, torque = 1.05 * far(usual.robot), usual.constraints.torque
    monkeypatch.setattr(
        final_judgement,
        "find_holding_torque",
        lambda robot, *_, **__: None if far(robot) >= enough else 0.5 * (torque or 1.0),
    )
    held = designed.__wrapped__("usual")
    assert far(held.robot) >= enough
    assert held.expected_error < 1.15 * usual.expected_error
    assert broken(held) == []


@pytest.mark.slow
def test_the_same_twice(unchecked: None) -> None:
    again = designed.__wrapped__("usual")
    first = designed("usual")
    assert robot_hash(again.robot) == robot_hash(first.robot)
    assert again.rms_error == first.rms_error
    assert again.num_evaluated == first.num_evaluated
    assert again.trace.certificate == first.trace.certificate  # type: ignore[union-attr]


@pytest.mark.slow
def test_what_is_locked_comes_back_as_it_was(unchecked: None) -> None:
    own = strip()
    assert designed("locked winch").robot.winch("up") == own.winch("up")
    for name in ("locked cable", "locked cable alone", "improved beside a locked cable"):
        robot = designed(name).robot
        assert own.cables[1] in robot.cables
        assert robot.winch("down") == own.winch("down")
    assert designed("locked cable alone").robot.cables == own.cables[1:]


def test_a_certificate_of_a_network_with_locked_cables(unchecked: None) -> None:
    """Locks name cables, which keep their names in the new network, wherever they stand there."""
    assert [cable.name for cable in designed("locked cable alone").robot.cables] == ["down 1"]
    trace = designed("locked cable alone").trace
    assert isinstance(trace, RouteTrace)
    assert trace.certificate is not None
    assert trace.certificate.descent_rate < 1e-4  # nothing may move, and the contraction is at its best
    assert trace.certificate.further < designed("locked cable alone").rms_error


@pytest.mark.parametrize("name", ["mirror, one winch", "mirror, two winches"])
def test_symmetric_designs_are_symmetric(name: str, unchecked: None) -> None:
    robot, flip = designed(name).robot, np.array([1.0, -1.0])
    routes = [np.array(cable.points) for cable in robot.cables]
    for route in routes:
        assert any(other.shape == route.shape and np.abs(flip * other - route).max() < 1e-9 for other in routes)
    places = np.array([winch.at for winch in robot.winches])
    assert np.abs(np.sort(places[:, 1]) + np.sort(places[:, 1])[::-1]).max() < 1e-9


@pytest.mark.slow
def test_improving_a_symmetric_network_keeps_it_symmetric(unchecked: None) -> None:
    start = designed("mirror, two winches")
    limits = replace(start.constraints, clearance=0.006)
    targets = {"tip": (0.08, 0.05), "low": (0.08, -0.05)}
    network = design_cables(
        start.robot, [PoseTarget(name="other", targets=targets)], winches=2, cables=len(start.robot.cables),
        constraints=limits, options=SMALL, warm_start=True,
    )  # fmt: skip
    assert broken(network) == []


@pytest.mark.parametrize("poses", [(UP,), (UP, DOWN)])
def test_improving_never_does_worse(poses: tuple[PoseTarget, ...], unchecked: None) -> None:
    """Oracle: the first stage, the robot's own network moved into the constraints, solved afresh."""
    limits = Constraints()
    network = design_cables(
        strip(), poses, winches=2, cables=2, constraints=limits, options=replace(SMALL, refine_steps=3), warm_start=True
    )
    stage = network.trace.stages[0]  # type: ignore[union-attr]
    assert stage.words == "as it was"
    reach = limits.limits
    errors = [solve_ik(Simulation(stage.robot), pose, limits=reach).rms_error for pose in poses]
    assert network.rms_error <= float(np.sqrt(np.mean(np.square(errors)))) * (1 + 1e-6)


def test_improving_keeps_what_cables_are_made_of(unchecked: None) -> None:
    own = deep(strip_robot(columns=10, rows=3, stiffness=2e3))
    network = design_cables(
        own, [UP, DOWN], winches=2, cables=2, options=replace(SMALL, refine_steps=1), warm_start=True
    )
    assert [cable.stiffness for cable in network.robot.cables] == [2e3, 4e3]


class Stopped:
    """Ctrl-C at one of the calls."""

    def __init__(self, at: int) -> None:
        self.at, self.calls = at, 0

    def __call__(self, stage: str, done: int, total: int) -> None:
        assert 0 <= done <= total
        self.calls += 1
        if self.calls == self.at:
            raise KeyboardInterrupt


@pytest.mark.parametrize("at", [1, 2])
def test_ctrl_c_before_the_first_network(at: int, unchecked: None) -> None:
    with pytest.raises(KeyboardInterrupt):
        design_cables(bare(), [UP, DOWN], winches=2, cables=2, options=SMALL, progress=Stopped(at))


@pytest.mark.parametrize("at", [3, 4])
def test_ctrl_c_returns_the_best_so_far(at: int, unchecked: None) -> None:
    network = design_cables(bare(), [UP, DOWN], winches=2, cables=2, options=SMALL, progress=Stopped(at))
    assert not network.complete
    assert isinstance(network.trace, RouteTrace)
    assert network.trace.certificate is None
    assert broken(network) == []
    assert network.expected_error <= 1.01 * min(stage.error for stage in network.trace.stages)


def test_progress_comes_to_its_end(unchecked: None) -> None:
    calls: list[tuple[str, int, int]] = []
    design_cables(bare(), [UP], winches=1, cables=2, options=SMALL, progress=lambda *call: calls.append(call))
    counts = [(done, total) for _, done, total in calls]
    assert counts[-1][0] == counts[-1][1]


@pytest.mark.slow
def test_a_design_with_all_shapes_checked() -> None:
    options = replace(SMALL, max_edges=5, refine_steps=1, steps=1)
    network = design_cables(bare(), [UP], winches=1, cables=2, constraints=Constraints(slack=0.002), options=options)
    assert broken(network) == []


def error_of(text: str, **asked: Any) -> None:
    given: dict[str, Any] = {"robot": strip(), "poses": [UP], "winches": 2, "cables": 2, **asked}
    with pytest.raises(HydrostatError) as caught:
        design_cables(given.pop("robot"), given.pop("poses"), **given)
    assert str(caught.value) == text
    assert isinstance(caught.value, InputError)


def test_what_is_asked_for_wrongly() -> None:
    error_of("no pose to design for. Add a [[pose]] to robot.toml.", poses=[])
    error_of('method must be one of routes, trees, chang2018, not "magic"', method="magic")
    error_of('options of method "routes" must be RouteOptions, not TreeOptions', options=TreeOptions())
    error_of('options of method "trees" must be TreeOptions, not RouteOptions', options=SMALL, method="trees")
    error_of(
        'method "trees" needs a number of winches and cannot improve a network. Use method "routes".',
        method="trees", warm_start=True,
    )  # fmt: skip
    error_of("winches must be a whole number from 1 to 20 or \"auto\", not 'two'", winches="two")
    error_of("cables must be a whole number from 1 to 60, not True", cables=True)
    error_of("3 winches need at least 3 cables, got 2. Ask for more cables or fewer winches.", winches=3)
    error_of(
        "2 winches can pull at most 4 cables, got 5. Ask for more winches or raise cables_per_winch.",
        cables=5, constraints=Constraints(cables_per_winch=2),
    )  # fmt: skip
    error_of(
        "2 cables of the robot are locked, more than the 1 asked for; ask for at least 2".replace("cables", "winches"),
        winches=1, cables=1, constraints=Constraints(locked_cables=("up 1", "down 1")),
    )  # fmt: skip
    error_of(
        "2 winches of the robot are to be improved, more than the 1 asked for; ask for at least 2",
        winches=1, warm_start=True,
    )  # fmt: skip
    error_of(
        "1 cable: a mirrored network has its cables in pairs; ask for at least 2 cables",
        robot=plate(), poses=[PINCH], winches=1, cables=1, constraints=Constraints(mirror="y"),
    )  # fmt: skip


def test_a_network_that_cannot_be_improved_says_why() -> None:
    """A cable sheathed in the middle stays, and its winch stands 10 mm inside the edge."""
    error_of(
        "the robot's own network cannot be moved into what the constraints allow (winch[0] up: low clearance (10 mm "
        "inside the edge). Minimum winch_clearance: 12 mm. Move it inward); relax them, or design without improving it",
        robot=strip_robot(columns=10, rows=3, sheathed=((2, 4),)), warm_start=True,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"starts": 0}, "RouteOptions.starts must be a whole number, at least 1, not 0"),
        ({"exchanges": 1.5}, "RouteOptions.exchanges must be a whole number, at least 0, not 1.5"),
        ({"tolerance": float("nan")}, "RouteOptions.tolerance must be above 0 and at most 1 m, not nan"),
        ({"spacing": "2"}, "RouteOptions.spacing must be finite and at least 0.5, not '2'"),
    ],
)
def test_options_out_of_range(unchecked: None, wrong: dict[str, object], words: str) -> None:
    with pytest.raises(InputError) as caught:
        RouteOptions(**wrong)  # type: ignore[arg-type]
    assert str(caught.value) == words


@pytest.fixture
def bodies(monkeypatch: pytest.MonkeyPatch) -> list[Robot]:
    """A robot for each time that the energies of a body are made, from now on."""
    made: list[Robot] = []
    begin = BodyPhysics.__init__

    def counted(self: BodyPhysics, robot: Robot) -> None:
        made.append(robot)
        begin(self, robot)

    monkeypatch.setattr(BodyPhysics, "__init__", counted)
    return made


@pytest.mark.parametrize("asked", [{}, {"winches": "auto"}, {"method": "trees", "options": TreeOptions(trials=2)}])
def test_a_design_builds_its_body_once(asked: dict[str, Any], unchecked: None, bodies: list[Robot]) -> None:
    """Oracle: how often its energies are made, over all networks that are solved."""
    given: dict[str, Any] = {"winches": 1, "cables": 2, "options": SMALL} | asked
    network = design_cables(bare(), [UP], **given)
    assert len(bodies) == 1
    assert network.num_evaluated > 1


def test_a_design_of_the_starfish_builds_its_body_once(unchecked: None, bodies: list[Robot]) -> None:
    """Oracle: as above, over all networks that are solved for one of its poses."""
    robot = gallery_robot("starfish")
    network = design_cables(robot, [robot.poses["wave"]], winches=1, cables=1, options=SMALL)
    assert len(bodies) == 1
    assert network.num_evaluated > 1


@pytest.mark.slow
def test_a_body_that_cables_hardly_bend_ends_with_a_network(unchecked: None) -> None:
    """The linear model draws no line along it, so nothing is sketched and cables are grown."""
    network = design_cables(bare().with_material("tpu 85a"), [UP], winches=1, cables=1, options=SMALL)
    assert len(network.robot.cables) == 1
    assert broken(network) == []
