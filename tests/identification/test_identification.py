"""Parameters from measurements. Oracles: central differences, and robots whose parameters are known."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_mesh
from scipy.optimize import brentq
from scipy.stats import norm

from hydrostat.errors import InputError
from hydrostat.identification import (
    IdentifiedRobot,
    Measurements,
    fit_model,
    identified_tolerances,
    identify,
    read_measurements,
)
from hydrostat.identification.find_faults import Swap, find_slip, find_swaps, is_mirrored
from hydrostat.identification.fit import robust_scale
from hydrostat.identification.identified_robot import start_of
from hydrostat.identification.kinds import named_model
from hydrostat.identification.marker_predictor import MarkerPredictor
from hydrostat.robot import (
    Cable,
    Load,
    LoadDrive,
    Marker,
    Material,
    Membrane,
    Mount,
    Pin,
    PinDrive,
    PrandtlElement,
    Robot,
    Rod,
    Winch,
)
from hydrostat.simulation import Simulation

UPPER = ((0.0083, 0.0137), (0.0587, 0.0161), (0.1129, 0.0147), (0.1833, 0.0143))
LOWER = ((0.0087, -0.0143), (0.0921, -0.0157), (0.1827, -0.0139))


def strip() -> Robot:
    """A flat strip with a cable on each side of its middle, a hung mass and weight."""
    return Robot(
        name="strip",
        body=mesh_body(strip_mesh(8, 2)),
        pins=(Pin(box=((-0.001, -1.0), (0.001, 1.0)), stiffness=3e3),),
        gravity=(0.0, -9.81),
        winches=(Winch(name="up", at=UPPER[0]), Winch(name="down", at=LOWER[0])),
        cables=(
            Cable(winch="up", points=UPPER, slack=0.001),
            Cable(winch="down", points=LOWER, slack=0.001, spool_radius=0.011),
        ),
        markers=(Marker(name="tip", at=(0.2, 0.0)), Marker(name="middle", at=(0.1, 0.0))),
        loads=(Load(name="nut", marker="tip", mass=0.005),),
        poses={},
    )


def box() -> Robot:
    """A box in space with a rod and a cable whose winch stands in the world."""
    points = ((-0.02, 0.013, 0.037), (0.0523, 0.0117, 0.0313), (0.1031, 0.0107, 0.0289))
    return Robot(
        name="box",
        body=mesh_body(box_mesh((4, 2, 2), size=(0.12, 0.04, 0.04))),
        pins=(Pin(box=((-0.001, -1.0, -1.0), (0.001, 1.0, 1.0))),),
        winches=(Winch(name="one", at=points[0], mount=Mount.WORLD),),
        cables=(Cable(winch="one", points=points, slack=0.001),),
        markers=(Marker(name="tip", at=(0.12, 0.02, 0.02)),),
        rods=(
            Rod(
                name="wire",
                points=((0.0, 0.021, 0.019), (0.12, 0.021, 0.019)),
                axial_stiffness=50.0,
                bending_stiffness=2e-3,
            ),
        ),
        poses={},
    )


def measured(robot: Robot, commands: np.ndarray) -> Measurements:
    """Rows without places."""
    names = tuple(marker.name for marker in robot.markers)
    places = np.zeros((len(commands), len(names), robot.body.mesh.dim))
    return Measurements(commands=commands, markers=names, places=places)


@pytest.mark.parametrize(
    ("robot", "kinds"),
    [
        (strip(), ("young", "poisson", "density", "thickness", "stiffness", "zero", "gain", "pins", "gravity")),
        (strip(), ("frame", "scale", "force")),
        (box(), ("young", "stiffness", "zero", "gain", "rods", "frame", "scale", "force", "routes")),
    ],
    ids=["flat", "flat frame", "space"],
)
def test_slopes_are_those_of_central_differences(robot: Robot, kinds: tuple[str, ...], unchecked: None) -> None:
    model = named_model(robot, kinds)
    rows = np.full((1, len(robot.winches)), 0.009) * np.linspace(1.0, 0.3, len(robot.winches))
    predictor = MarkerPredictor(model, replace(measured(robot, rows), forces=np.zeros_like(rows)))
    numbers = 0.3 * np.random.default_rng(1).standard_normal(len(model.parameters))
    exact = predictor.predict(numbers, with_jacobian=True)
    for index, parameter in enumerate(model.parameters):
        step = 1e-3 * np.eye(len(numbers))[index]
        less, more = (predictor.predict(numbers + sign * step, with_jacobian=False) for sign in (-1, 1))
        for name, slopes in (("places", exact.jacobian), ("forces", exact.force_jacobian)):
            assert slopes is not None
            found = (getattr(more, name) - getattr(less, name)) / 2e-3
            scale = max(np.abs(found).max(), 1e-6)
            assert np.abs(slopes[..., index] - found).max() < 2e-4 * scale, (parameter.name, name)


def test_hidden_parameters_of_a_heavy_strip_are_found() -> None:
    robot, rng = strip(), np.random.default_rng(2)
    model = named_model(robot, ("young", "zero", "gain", "frame"))
    truth = model.start | {"body.young": 1.4 * model.start["body.young"], "up.zero": 0.6, "down.gain": 1.04}
    truth |= {"frame.x": 2.0, "frame.about z": 1.5}
    hidden = np.array([parameter.to_fitted(truth[parameter.name]) for parameter in model.parameters])
    rows = rng.uniform(0.001, 0.012, (12, 2))
    asked = measured(robot, rows)
    noise = 1e-4
    seen = MarkerPredictor(model, asked).predict(hidden, with_jacobian=False).places + noise * rng.standard_normal(
        (12, 2, 2)
    )
    seen[3, 0] = np.nan
    found = fit_model(model, replace(asked, places=seen))
    assert found.num_failed == 0
    assert found.noise == pytest.approx(noise, rel=0.4)
    inside = [low <= truth[name] <= high for name, (low, high) in found.intervals.items()]
    assert sum(inside) >= len(inside) - 1
    assert found.values["body.young"] == pytest.approx(truth["body.young"], rel=0.1)
    assert found.information_gains["body.young"] > 0.5


def test_what_measurements_do_not_show_is_said() -> None:
    """Pulled by displacements and without weight, a shape does not show the body's modulus."""
    robot = replace(strip(), gravity=None, loads=())
    model = named_model(robot, ("young", "gain"))
    rows = np.random.default_rng(3).uniform(0.002, 0.01, (10, 2))
    asked = measured(robot, rows)
    seen = MarkerPredictor(model, asked).predict(np.full(3, 0.2), with_jacobian=False).places
    seen += 2e-4 * np.random.default_rng(4).standard_normal(seen.shape)
    found = identify(robot, replace(asked, places=seen), fit=("young", "gain", "pins"))
    assert "pin 1.stiffness" in found.unknown
    assert "up.gain" not in found.unknown
    assert found.robot.winch("up").spool_radius != robot.winch("up").spool_radius
    assert len(found.held_out) == 2


def test_a_board_printed_too_small_is_found() -> None:
    """Oracle: places that a robot of known scale and thickness has; rulers do not shrink with the board."""
    robot, rows = strip(), np.random.default_rng(3).uniform(0.001, 0.012, (6, 2))
    model = named_model(robot, ("thickness", "frame", "scale"))
    hidden = model.start | {"thickness": 1.2 * model.start["thickness"], "frame.scale": 1.015, "frame.x": 3.0}
    numbers = np.array([parameter.to_fitted(hidden[parameter.name]) for parameter in model.parameters])
    asked = measured(robot, rows)
    seen = replace(asked, places=MarkerPredictor(model, asked).predict(numbers, with_jacobian=False).places)
    found = identify(robot, seen, fit=("thickness", "frame", "scale"))
    assert found.fitted.values["frame.scale"] == pytest.approx(1.015, abs=1e-4)
    assert found.robot.body.thickness == pytest.approx(1e-3 * hidden["thickness"], rel=0.01)
    with pytest.raises(InputError, match="scale: ruler distances"):
        identify(robot, replace(seen, pairs=((0, 1),), lengths=np.full((6, 1), 0.1)), fit=("frame", "scale"))
    with pytest.raises(InputError, match='"scale" needs "frame"'):
        named_model(robot, ("scale",))


def test_a_hung_mass_tells_modulus_and_density_apart() -> None:
    """The sag of a body is that of density over modulus: with nothing hung on it, both may grow together."""
    robot = replace(strip(), loads=())
    asked = measured(robot, np.random.default_rng(3).uniform(0.002, 0.01, (6, 2)))
    model = named_model(robot, ("young", "density"))
    seen = MarkerPredictor(model, asked).predict(np.array([0.3, -0.2]), with_jacobian=False).places
    free = fit_model(model, replace(asked, places=seen), noise=3e-5)
    assert free.inseparable == [("body.young", "body.density")]
    hung = replace(asked, masses=np.array([[0.0, 0.0], [0.02, 0.0]] * 3))
    seen = MarkerPredictor(model, hung).predict(np.array([0.3, -0.2]), with_jacobian=False).places
    found = fit_model(model, replace(hung, places=seen), noise=3e-5)
    assert found.inseparable == []
    assert found.values["body.young"] == pytest.approx(model.values(np.array([0.3, -0.2]))["body.young"], rel=0.01)


def test_forces_show_the_modulus_of_a_body_without_weight() -> None:
    """Oracle: hidden values. Contractions alone give every modulus the same shape."""
    stiff = tuple(replace(cable, stiffness=1e7) for cable in strip().cables)
    pins = (replace(strip().pins[0], stiffness=3e5),)
    robot = replace(strip(), gravity=None, loads=(), pins=pins, cables=stiff)
    model, hidden = named_model(robot, ("young", "force")), np.array([0.5, 0.0])
    asked = measured(robot, np.random.default_rng(5).uniform(0.004, 0.012, (6, 2)))
    seen = MarkerPredictor(model, asked).predict(hidden, with_jacobian=False)
    blind = fit_model(model, replace(asked, places=seen.places), noise=3e-4, refine=False)
    assert blind.information_gains["body.young"] < 0.3
    noisy = seen.forces * (1 + 0.02 * np.random.default_rng(6).standard_normal(seen.forces.shape))
    table = replace(asked, places=seen.places, forces=noisy)
    alone = fit_model(named_model(robot, ("young",)), table, noise=3e-4, refine=False)
    assert alone.numbers[0] == pytest.approx(0.5, abs=0.03)
    scaled = fit_model(model, table, noise=3e-4, refine=False)
    low, high = scaled.intervals["body.young"]
    assert low < model.values(hidden)["body.young"] < high
    assert np.log(high / low) / (2 * 1.96) == pytest.approx(0.2, rel=0.15)  # the torque constant is known to 20 %


def test_up_and_down_strokes_show_friction() -> None:
    """Oracle: hidden friction. Rows in the order of a loading path have the history that rows from rest lack."""
    bends = ((0.0083, 0.0137), (0.0487, -0.0061), (0.0921, 0.0147), (0.1329, -0.0057), (0.1833, 0.0143))
    cable = replace(strip().cables[0], points=bends, friction=0.1)
    robot = replace(strip(), loads=(), cables=(cable,), winches=strip().winches[:1])
    model, hidden = named_model(robot, ("friction",)), np.array([1.5])
    path = replace(measured(robot, np.array([[2.0], [14.0], [8.0], [2.0], [8.0]]) * 1e-3), in_order=True)
    seen = MarkerPredictor(model, path).predict(hidden, with_jacobian=False)
    free = MarkerPredictor(model, replace(path, in_order=False)).predict(hidden, with_jacobian=False)
    assert free.places[:2] == pytest.approx(seen.places[:2], abs=1e-7)
    assert np.abs(free.forces - seen.forces).max() > 0.2 * seen.forces.max()
    table = replace(path, places=seen.places + 1e-4 * np.random.default_rng(1).standard_normal(seen.places.shape))
    found = fit_model(model, table, noise=1e-4, refine=False)
    low, high = found.intervals["friction"]
    assert low < model.values(hidden)["friction"] < high < 1.2 * low
    part = table.rows(np.array([1, 3]))
    assert np.isfinite(part.places[:, 0, 0]).tolist() == [False, True, False, True, False]
    assert MarkerPredictor(model, part).predict(hidden, with_jacobian=False).places == pytest.approx(seen.places)


def test_lengths_by_ruler_need_no_places(tmp_path: Path) -> None:
    """Oracle: hidden spools, from three distances of two markers each in eight poses."""
    robot, file = strip(), tmp_path / "ruler.csv"
    robot = replace(robot, markers=(*robot.markers, Marker(name="root", at=(0.01, 0.01))))
    asked = measured(robot, np.random.default_rng(7).uniform(0.002, 0.014, (8, 2)))
    model, hidden = named_model(robot, ("gain",)), np.array([0.6, -0.4])
    places = MarkerPredictor(model, asked).predict(hidden, with_jacobian=False).places
    pairs = ((0, 1), (1, 2), (2, 0))
    lengths = 1e3 * np.stack([np.linalg.norm(places[:, one] - places[:, two], axis=1) for one, two in pairs], axis=1)
    names = [f"{asked.markers[one]}_to_{asked.markers[two]}_mm" for one, two in pairs]
    cells = np.concatenate([1e3 * asked.commands, lengths], axis=1)
    rows = [",".join(f"{cell:.4f}" for cell in row) for row in cells]
    file.write_text("\n".join([",".join(["up_mm", "down_mm", *names]), *rows]) + "\n")
    found = identify(robot, read_measurements(file, robot), fit=("gain",))
    assert found.fitted.numbers == pytest.approx(hidden, abs=0.02)
    assert found.fitted.error < 1e-5


def test_the_noise_is_that_of_most_errors_not_of_the_fitted_half() -> None:
    """Oracle: the equation of Huber's proposal 2 for normal errors, a share of them wrong, by root finding.

    A median says 0 where parameters take up half.
    """
    errors = np.random.default_rng(1).standard_normal(20_000)

    def excess(scale: float) -> float:
        clip = 2.0 * scale
        right = 1 - 2 * norm.sf(clip) - 2 * clip * norm.pdf(clip) + 2 * clip**2 * norm.sf(clip)
        return float((1 - share) * right + share * clip**2 - 0.9205 * scale**2)

    for share, expected in ((0.0, 1.0), (0.1, 1.3), (0.2, 2.6)):
        found = robust_scale(np.where(np.arange(20_000) < share * 20_000, 300.0, errors))
        assert found == pytest.approx(brentq(excess, 0.3, 10.0), rel=0.02)
        assert found == pytest.approx(expected, rel=0.03)
    errors = errors[:4000]
    assert 0.5 < robust_scale(np.where(np.arange(4000) % 2, errors, 0.0)) < 0.5**0.5


def test_swapped_or_mirrored_markers_and_a_slip_are_found() -> None:
    """Oracle: the faults that were made; none are found in noisy measurements without."""
    robot, rng = strip(), np.random.default_rng(8)
    asked = measured(robot, rng.uniform(0.002, 0.014, (10, 2)))
    model, assumed = named_model(robot, ("gain", "zero")), start_of(named_model(robot, ()))
    slipped = asked.commands.copy()
    slipped[6:, 1] -= 0.004
    for commands, length in ((asked.commands, None), (slipped, 0.004)):
        seen = (
            MarkerPredictor(model, replace(asked, commands=commands))
            .predict(np.full(4, 0.2), with_jacobian=False)
            .places
        )
        table = replace(asked, places=seen + 2e-4 * rng.standard_normal(seen.shape))
        fitted = fit_model(model, table, refine=False)
        assert find_swaps(fitted, assumed, table) == []
        slip = find_slip(fitted, table)
        if length is not None:
            assert slip is not None
            assert (slip.winch, slip.row) == ("down", 6)
            assert slip.length == pytest.approx(length, rel=0.1)
            continue
        assert slip is None
        assert not is_mirrored(assumed, table)
        assert is_mirrored(assumed, replace(table, places=table.places * (1, -1) + (0, 0.05)))
        for rows in ([3], list(range(10))):
            swapped = table.places.copy()
            swapped[rows] = swapped[rows, ::-1]
            wrong = replace(table, places=swapped)
            assert find_swaps(fit_model(model, wrong, refine=False), assumed, wrong) == [
                Swap(markers=("tip", "middle"), rows=tuple(rows))
            ]


def test_a_table_is_read_and_refused_by_line(tmp_path: Path) -> None:
    robot = strip()
    file = tmp_path / "seen.csv"
    file.write_text("pose,up_mm,tip_x_mm,tip_y_mm\na,3.5,198,-4\nb,2,,\n")
    found = read_measurements(file, robot)
    assert found.commands.tolist() == [[0.0035, 0.0], [0.002, 0.0]]
    assert found.markers == ("tip",)
    assert np.isnan(found.places[1]).all()
    file.write_text("up_mm,tip_x_mm,tip_y_mm,tip_load_g\n3,198,-4,20\n2,198,-4,\n")
    assert read_measurements(file, robot).hung_masses.ravel().tolist() == [0.02, 0.0]
    for text, words in (
        ("up_mm\n3\n", "no column of a marker"),
        ("side_mm,tip_x_mm,tip_y_mm\n1,2,3\n", 'unknown column "side_mm"'),
        ("up_mm,tip_x_mm\n1,2\n", 'add a column "tip_y_mm"'),
        ("up_mm,up,tip_x_mm,tip_y_mm\n1,1,2,3\n", "two columns"),
        ("up_mm,tip_x_mm,tip_y_mm\nfar,2,3\n", 'line 2, column up_mm: "far" is no number'),
        ("up_mm,tip_x_mm,tip_y_mm\n1,2\n", "line 2: 2 cells"),
        ("up_mm,tip_x_mm,tip_y_mm\n", "no row of numbers"),
        ("up_mm,tip_to_middle_mm,middle_to_tip_mm\n1,2,2\n", "two columns"),
        ("up_mm,tip_to_tip_mm\n1,2\n", 'unknown column "tip_to_tip_mm"'),
        ("up_mm,tip_to_middle_mm\n1,-2\n", "must be 0 or more, not -2"),
    ):
        file.write_text(text)
        with pytest.raises(InputError) as caught:
            read_measurements(file, robot)
        assert words in str(caught.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"forces": np.array([[np.inf, 0.0]])}, "forces must be finite"),
        ({"forces": np.zeros((1, 2))}, "every measured force is 0 N"),
        ({"places": np.full((1, 2, 2), -np.inf)}, "places must be finite"),
        ({"places": np.array([[[19.0, 0.0], [10.0, 0.0]]])}, "Write tables in mm, arrays in m"),
        ({"places": np.array([[[0.02, 0.0], [0.01, 0.0]]])}, "Write tables in mm, arrays in m"),
        ({"masses": np.full((1, 2), np.inf)}, "masses must be 0 or more"),
        ({"pairs": ((0, 7),), "lengths": np.ones((1, 1))}, r"2 markers by number from 0, not \(0, 7\)"),
        ({"pairs": ((0, 0),), "lengths": np.ones((1, 1))}, r"2 markers by number from 0, not \(0, 0\)"),
    ],
)
def test_impossible_measurements_are_refused(change: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        fit_model(named_model(strip(), ("young",)), replace(measured(strip(), np.full((1, 2), 0.005)), **change))


def test_markers_that_come_near_have_no_wrong_unit() -> None:
    """Oracle: two markers 35.4 mm apart (standard deviation) at rest come to 6.3, 5.6 times as near, by hand."""
    near = replace(measured(strip(), np.full((1, 2), 0.005)), places=np.array([[[0.118, 0.0], [0.1, 0.0]]]))
    assert fit_model(named_model(strip(), ("gain",)), near, refine=False).error > 1e-3


def test_a_sheet_is_fitted_beyond_its_measured_interval() -> None:
    felt = Material(young=3e4, young_interval=(2.9e4, 3.1e4), poisson=0.3, density=40)
    robot = replace(strip(), sheets=(Membrane(name="felt", thickness=1e-3, material=felt),))
    fitted = named_model(robot, ("sheets",)).robot({"felt.young": 9e4}).sheets[0].material
    assert (fitted.young, fitted.young_interval) == (9e4, None)


def test_the_fitted_robot_predicts_what_was_measured() -> None:
    """Zeros are in its slack and gains in its spools: asked for the true contraction, it is where it was seen."""
    robot = strip()
    asked = measured(robot, np.array([[0.004, 0.0], [0.0, 0.006], [0.008, 0.002], [0.006, 0.004]]))
    hidden = np.array([-0.3, -0.2, 0.5, -0.5])
    model = named_model(robot, ("gain", "zero"))
    assert [parameter.name for parameter in model.parameters] == ["up.zero", "down.zero", "up.gain", "down.gain"]
    seen = MarkerPredictor(model, asked).predict(hidden, with_jacobian=False).places
    found = identify(robot, replace(asked, places=seen), fit=("gain", "zero"))
    assert found.held_out.size == 0
    gains = np.array([found.fitted.values[f"{winch.name}.gain"] for winch in robot.winches])
    simulation = Simulation(found.robot)
    for command, places in zip(asked.commands, seen, strict=True):
        more = np.array([found.pretension.get(winch.name, 0.0) for winch in robot.winches])
        pose = simulation.solve(gains * command + more)
        assert np.abs([pose.markers[name] for name in asked.markers] - places).max() < 2e-5


def test_drives_rest_while_a_robot_is_measured() -> None:
    """Oracle: the same robot on fixed pins."""
    still = strip()
    robot = replace(
        still,
        pins=(replace(still.pins[0], drive="base"),),
        loads=(*still.loads, Load(name="push", marker="tip", force=(0.0, -0.1), drive="thumb")),
        drives=(PinDrive(name="base", at=(0.0, 0.0)), LoadDrive(name="thumb", min=0.0, max=1.0)),
    )
    asked = measured(still, np.array([[0.01, 0.0]]))
    rows = replace(asked, places=start_of(named_model(still, ())).predict(asked) + 1e-3)
    found, fixed = (identify(one, rows, fit=("gain",)) for one in (robot, still))
    assert found.fitted.values == fixed.fitted.values
    assert found.robot == replace(fixed.robot, pins=robot.pins, loads=robot.loads, drives=robot.drives)


def test_zeros_that_are_pretension_are_told_as_lengths() -> None:
    robot = strip()
    asked = measured(robot, np.array([[0.004, 0.001], [0.001, 0.006], [0.008, 0.002], [0.006, 0.004]]))
    truth = {"up.zero": 1.8, "down.zero": 0.0, "up.gain": 1.02, "down.gain": 1.0}
    model = named_model(robot, ("zero", "gain"))
    hidden = np.array([parameter.to_fitted(truth[parameter.name]) for parameter in model.parameters])
    seen = MarkerPredictor(model, asked).predict(hidden, with_jacobian=False).places
    found = identify(robot, replace(asked, places=seen), fit=("zero", "gain"))
    assert found.pretension == {"up": pytest.approx(1.8e-3 * 1.02, rel=0.02)}
    assert found.robot.cables[0].slack == robot.cables[0].slack
    assert found.fitted.error < 1e-5


def test_one_known_coordinate_of_a_marker_counts() -> None:
    robot = strip()
    asked = measured(robot, np.array([[0.004, 0.001], [0.001, 0.006], [0.008, 0.002]]))
    model = named_model(robot, ("gain",))
    seen = MarkerPredictor(model, asked).predict(np.array([0.4, -0.3]), with_jacobian=False).places
    seen[:, :, 0] = np.nan
    found = fit_model(model, replace(asked, places=seen))
    assert found.numbers == pytest.approx([0.4, -0.3], abs=0.02)


@pytest.mark.slow
def test_intervals_hold_the_error_of_the_mesh() -> None:
    """A robot of half the element size. Oracle: its values, which intervals of independent errors would miss."""
    robot, rng = strip(), np.random.default_rng(4)
    fine = replace(robot, body=mesh_body(strip_mesh(16, 4)))
    model = named_model(robot, ("young", "gain"))
    young = 0.8 * model.start["body.young"]
    hidden = replace(fine, body=replace(fine.body, material=replace(fine.body.material, young=young)))
    asked = measured(hidden, rng.uniform(0.001, 0.012, (12, 2)))
    seen = MarkerPredictor(named_model(hidden, ()), asked).predict(np.zeros(0), with_jacobian=False).places
    found = fit_model(model, replace(asked, places=seen + 1e-4 * rng.standard_normal(seen.shape)))
    low, high = found.intervals["body.young"]
    assert low < young < high
    alone = replace(found, spread=1.0, mesh_shift=np.zeros_like(found.mesh_shift)).intervals["body.young"]
    assert not alone[0] < young < alone[1]
    exact = fit_model(model, replace(asked, places=seen), noise=1e-2, refine=False)
    assert exact.spread == 1.0


def test_tolerances_are_the_deviations_of_the_intervals() -> None:
    """Oracle: a normal prior and information by hand; shifts by finer elements are left out."""
    robot = strip()
    model = named_model(robot, ("gain", "young"))
    count, informed = len(model.parameters), [24.0, 99.0, 3.0]
    fitted = replace(
        start_of(model),
        covariance=np.diag([1 / (1 + each) for each in informed]),
        spread=4.0,
        mesh_shift=np.full((1, count), 2.0),
    )
    nothing = np.zeros((0, 2))
    found = IdentifiedRobot(
        fitted=fitted,
        robot=robot,
        assumed=start_of(named_model(robot, ())),
        pretension={},
        before=nothing,
        after=nothing,
        held_out=np.zeros(0, dtype=int),
        held_out_before=nothing,
        held_out_after=nothing,
        correction=None,
    )
    own = {parameter.name: index for index, parameter in enumerate(model.parameters)}
    expected = {name: model.parameters[index].spread / np.sqrt(1 + informed[index] / 4) for name, index in own.items()}
    told = tomllib.loads(identified_tolerances(found).decode())["tolerances"]
    assert told["spool"] == pytest.approx(max(expected["up.gain"], expected["down.gain"]), rel=5e-3)
    assert "young" not in told  # the fitted material has its interval


def test_up_and_down_strokes_show_hysteresis() -> None:
    """Oracle: hidden scale of the sliders' moduli; central differences of whole paths of another step."""
    body = mesh_body(strip_mesh(4, 1))
    sliders = (PrandtlElement(young=4e3, strain=0.01), PrandtlElement(young=2e3, strain=0.04))
    robot = replace(strip(), loads=(), body=replace(body, material=replace(body.material, hysteresis=sliders)))
    model, hidden = named_model(robot, ("hysteresis",)), np.array([0.8])
    assert model.robot(model.values(hidden)).body.material.hysteresis[1].young == pytest.approx(2e3 * np.exp(0.56))
    path = replace(measured(robot, np.array([[6.0, 0], [16, 0], [8, 0], [2, 0]]) * 1e-3), in_order=True)
    seen = MarkerPredictor(model, path).predict(hidden, with_jacobian=True)
    steps = [MarkerPredictor(model, path).predict(hidden + step, with_jacobian=False).places for step in (-0.01, 0.01)]
    assert seen.jacobian[..., 0] == pytest.approx((steps[1] - steps[0]) / 0.02, abs=2e-6)  # type: ignore[index]
    free = MarkerPredictor(model, replace(path, in_order=False)).predict(hidden, with_jacobian=True)
    assert np.abs(free.places - seen.places)[:2].max() < 1e-4 < np.abs(free.places - seen.places)[2:].max()
    assert free.jacobian[:1] == pytest.approx(seen.jacobian[:1], abs=1e-7)  # type: ignore[index]
    table = replace(path, places=seen.places + 1e-4 * np.random.default_rng(1).standard_normal(seen.places.shape))
    found = fit_model(model, table, noise=1e-4, refine=False)
    low, high = found.intervals["hysteresis.scale"]
    assert low < model.values(hidden)["hysteresis.scale"] < high < 1.5 * low
    rubbing = robot.with_network(robot.winches, [replace(cable, friction=0.1) for cable in robot.cables])
    with pytest.raises(InputError, match="identification fits cable friction or hysteresis, not both"):
        fit_model(named_model(rubbing, ("hysteresis",)), table, noise=1e-4)
