"""`hydrostat check`."""

import re
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrostat.cli.check_poses import is_solved_fast, print_reached_poses
from hydrostat.cli.folders import RobotFolder
from hydrostat.cli.waiting import patiently, read_robot
from hydrostat.errors import InputError
from hydrostat.units import plural

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hydrostat.design import Diagnostic
    from hydrostat.robot import Body, Material, Membrane, Robot, Rod, Sensor


def check(
    robot: RobotFolder,
    thorough: Annotated[
        bool,
        typer.Option(
            "--thorough",
            help="Also solve poses in 3D; compute workspaces, compliance and out-of-plane motion of stuffed bodies.",
        ),
    ] = False,
    stuffed: Annotated[
        bool,
        typer.Option("--stuffed", help="Also simulate the stuffed 3D body. Slow."),
    ] = False,
) -> None:
    """Check a robot: report errors and warnings.

    Mesh, parts, rods, cables, winches and fit of the kit are checked, and the poses of flat bodies solved. `hydrostat
    fabricate` also checks the motor and line loads of the poses.

    Exit code 1 if there is an error, 0 with warnings and notes only.

    Example: hydrostat check gallery:starfish --thorough
    """
    from hydrostat.design import find_mirror_axis
    from hydrostat.robot import describe_cable_side

    found = read_robot(robot)
    mesh = found.body.mesh
    print(f"{found.name}: {1e3 * mesh.size:.0f} mm, {mesh.describe()}")
    for line in _body_lines(found.body):
        print(line)
    for line in _held_parts(found):
        print(line)
    for rod in found.rods:
        print(_rod_line(rod))
    for sheet in found.sheets:
        print(_sheet_line(found.body, sheet))
    for sensor in found.sensors:
        print(f"sensor {sensor.name}: {sensor.kind}, {_noise_text(sensor)}")
    parts = {"pin": found.pins, "winch": found.winches, "cable": found.cables, "marker": found.markers}
    parts |= {noun: held for noun, held in (("drive", found.drives), ("load", found.loads)) if held}
    counts = ", ".join(plural(len(entries), noun) for noun, entries in parts.items())
    print(f"{counts}, poses: {', '.join(found.poses) or 'none'}")
    if words := describe_cable_side(found):
        print(f"cables: {words}")
    review = _review(found)
    refused = any(finding.severity.word == "error" for finding in review)
    if found.cables:
        print("build: no kit, see the error below" if refused else _cost_line(found, robot))
    if found.poses and not found.cables and (axis := find_mirror_axis(found, found.poses.values())):
        print(f"note: body, markers and poses mirror about {axis}. Try hydrostat design --symmetric {axis}")
    far = _print_simulated(found, thorough=thorough, stuffed=stuffed)
    if found.body.has_hysteresis:
        print("note: hysteresis: refused by pose, trajectory, share, design, branches and linear models.")
    _print_judgement(found, review, far)


def _print_simulated(robot: "Robot", *, thorough: bool, stuffed: bool) -> tuple[str, ...]:
    """Print results that need simulations, and those that are left out; return their warnings."""
    from hydrostat.robot import describe_cable_side

    sewn = bool(describe_cable_side(robot))
    curled = _print_stuffed(robot) if stuffed else _print_out_of_plane(robot) if sewn and thorough else None
    reaches = bool(robot.markers and (robot.cables or robot.drives))
    has_poses = bool(robot.poses) and reaches and not robot.body.has_hysteresis
    solved = has_poses and (thorough or is_solved_fast(robot))
    far = print_reached_poses(robot) if solved else ()
    if reaches and thorough:
        _print_workspaces(robot)
        _print_compliance(robot)
    left_out = ["poses"] * (has_poses and not solved)
    left_out += ["marker workspaces", "compliance"] * reaches + ["out-of-plane motion"] * (sewn and not stuffed)
    if left_out and not thorough:
        print(f"not computed: {', '.join(left_out)}. Add --thorough. Loads of poses: hydrostat fabricate.")
    return (*far, *([curled] if curled else []))


def _cost_line(robot: "Robot", folder: Path) -> str:
    """Return the work on cables and the price of motors: those of its design, else with the weakest motors that fit."""
    from hydrostat.cli.design_results import designed_cost
    from hydrostat.design import BuildCost

    known = designed_cost(robot, folder)
    least = "" if known else "; more if poses need stronger motors"
    return f"build: {known or BuildCost.of_robot(robot, ())}{least}. Whole kit: hydrostat fabricate --summary"


def _review(robot: "Robot") -> "tuple[Diagnostic, ...]":
    """Return the design review of a robot, as the studio does; motor loads of its poses are left aside."""
    from hydrostat.design import Constraints, review_robot

    return review_robot(robot, constraints=Constraints())


def _print_judgement(robot: "Robot", review: "Iterable[Diagnostic]", warnings: "Iterable[str]") -> None:
    """Print the findings of a robot, those of its skin, and the warnings of simulations."""
    from hydrostat.design import Diagnostic, Severity, find_no_room
    from hydrostat.errors import NO_KIT

    severity, before = (Severity.REFUSED, "") if robot.cables else (Severity.WARNING, NO_KIT)
    found = [Diagnostic(text=before + text, severity=severity, places=()) for text in print_sewing(robot.body)]
    found += review
    if not robot.cables and (words := find_no_room(robot)):
        found.append(Diagnostic(text=words, severity=Severity.WARNING, places=()))
    found += [Diagnostic(text=text, severity=Severity.WARNING, places=()) for text in warnings]
    for finding in found:
        print(name_cables(f"{finding}", robot))
    refused, risky = (sum(one.severity is kind for one in found) for kind in (Severity.REFUSED, Severity.WARNING))
    missing = "" if robot.cables else " (body only: no cables yet)"
    print(f"{'' if refused else 'OK: '}{plural(refused, 'error')}, {plural(risky, 'warning')}{missing}.")
    if refused:
        raise typer.Exit(1)


def name_cables(text: str, robot: "Robot") -> str:
    """Return a sentence with the name after the number of each cable that was given one; quoted words stay."""
    names = robot.given_cable_names

    def name(match: re.Match[str]) -> str:
        given = dict(enumerate(names, 1)).get(int(match[1]))
        return f'{match[0]} "{given}"' if given else match[0]

    parts = re.split(r'("[^"]*")', text)
    return "".join(
        part if part.startswith('"') else re.sub(r"\bcable (\d+)(?=[,:.]| between|$)", name, part) for part in parts
    )


def print_sewing(body: "Body") -> tuple[str, ...]:
    """Print what sewing the skin of a stuffed body in space takes; returns why it cannot be sewn, if so."""
    from hydrostat.fabrication import KitOptions

    if not KitOptions().sews_skin(body):
        return ()
    from hydrostat.fabrication import Sewing

    with patiently("flattening the skin, patch by patch ..."):
        sewing = Sewing.find(body)
    if not sewing.problems:
        print(f"skin: {sewing}")
    return sewing.problems


def _print_compliance(robot: "Robot") -> None:
    """Print how far a small force moves each marker at rest, in its softest direction, or why that is not computed."""
    import numpy as np

    from hydrostat.errors import NotConvergedError
    from hydrostat.simulation import Simulation, marker_compliance

    simulation = Simulation(robot)
    try:
        if simulation.assembly.has_history:
            raise InputError("with friction or hysteresis a pose depends on the way to it")
        softest = 1e3 * np.linalg.norm(marker_compliance(simulation, simulation.rest), ord=2, axis=(1, 2))
    except (InputError, NotConvergedError) as error:
        print(f"compliance: not computed ({error})")
        return
    each = [f"{marker.name} {value:.3g}" for marker, value in zip(robot.markers, softest, strict=True)]
    print(f"compliance at rest, mm/N: {', '.join(each)}")


def _print_workspaces(robot: "Robot") -> None:
    """Print the workspace of each marker: from few poses for large bodies, not at all for the largest; quick."""
    from hydrostat.design import Constraints
    from hydrostat.errors import NotConvergedError
    from hydrostat.ik import find_workspaces
    from hydrostat.simulation import Simulation

    nodes = len(robot.body.mesh.nodes)
    if nodes > _LARGE_BODY_NODES:
        print(f"workspace: skipped ({nodes} nodes, maximum {_LARGE_BODY_NODES}). Use larger elements")
        return
    # nodes of all poses that are tried for the reach; fewest and most poses
    solved, least, most = 30_000, 9, 64
    tension, count = robot.max_tension or Constraints().tension, int(min(max(solved / nodes, least), most))
    try:
        reaches = find_workspaces(Simulation(robot), tension=tension, count=count)
    except (InputError, NotConvergedError) as error:
        print(f"workspace: not computed ({error})")
        return
    print(f"Marker workspaces (maximum tension {tension:g} N, {count} poses sampled):")
    for reach in reaches:
        print(f"  {reach.marker}: {reach}")


_LARGE_BODY_NODES = 5000  # nodes of a body from which on even the fewest poses take long


def _print_out_of_plane(robot: "Robot") -> str | None:
    """Print the out-of-plane displacement of a stuffed flat robot, if quickly computed; return its warning."""
    from hydrostat.errors import NotConvergedError
    from hydrostat.simulation import is_stuffed_motion_fast, solve_stuffed_motion

    if not is_stuffed_motion_fast(robot, len(robot.poses)):
        if robot.body.outline is not None and robot.poses:
            print("3D effect when stuffed: not computed (slow). Run hydrostat check --stuffed")
        return None
    try:
        found = solve_stuffed_motion(robot, _full_contractions(robot))
    except (InputError, NotConvergedError) as error:
        print(f"3D effect when stuffed: not computed ({error})")
        return None
    print(f"3D effect when stuffed: {found}")
    return found.warning


def _print_stuffed(robot: "Robot") -> str | None:
    """Print the out-of-plane displacement of a stuffed flat robot by cable face; return the warning of its own."""
    from hydrostat.robot import CableSide
    from hydrostat.simulation import solve_stuffed_motion

    if robot.body.outline is None:
        raise InputError("--stuffed: needs a flat robot with a drawing. Remove it.")
    if not robot.poses or not robot.cables:
        raise InputError("--stuffed: needs at least one [[pose]] and one [[cable]]. Add them or remove --stuffed.")
    pulled = _full_contractions(robot)
    print("Stuffed 3D body, contractions of the flat model (maximum over markers and poses):")
    by_face = {face: solve_stuffed_motion(robot, pulled, face) for face in CableSide}
    for face, found in by_face.items():
        print(f"  cables {face.words}: {found}")
    return by_face[robot.face or CableSide.FRONT].warning


def _full_contractions(robot: "Robot") -> list[Any]:
    """Contractions of all winches, for each pose."""
    from hydrostat.ik import IKOptions, solve_ik
    from hydrostat.robot import PinDrive
    from hydrostat.simulation import Simulation

    PinDrive.require_none(robot.drives, "stuffed bodies")
    simulation, once = Simulation(robot), IKOptions(restarts=0)
    return [solve_ik(simulation, pose, options=once).pose.contractions for pose in robot.poses.values()]


def _body_lines(body: "Body") -> list[str]:
    """Material with mass and volume; width or thickness where the body is narrow, worst angle of its mesh."""
    mesh, material = body.mesh, body.material
    own = body.element_materials == 0
    volume = float(mesh.volumes[own].sum()) * (body.thickness or 1.0)
    thickness = body.measured_thickness
    thin, few = thickness.part(0.05)
    few = few if mesh.quadratic is None else few / 2  # an element is two of the mesh's edges wide
    across, flat = "thickness", ""
    if body.thickness is not None:
        across, flat = "width", f", thickness {1e3 * body.thickness:.3g} mm"
    if mesh.dim == 2:
        angle = f"smallest angle {mesh.smallest_angle():.0f}°"
    else:
        angle = f"smallest angle between faces {mesh.dihedral_angles().min():.2g}°"
    name = _material_name(material)
    return [
        f"{name}: {_mass_text(float(body.element_masses[own].sum()))}, {_volume_text(volume)}",
        *(_part_line(body, index) for index in range(len(body.parts))),
        *([f"body with its parts: {_mass_text(body.mass)}"] if body.parts else []),
        f"{across} from {1e3 * thin:.0f} mm ({_across_words(few)}){flat}; {angle}",
        *_plane_lines(body),
    ]


def _across_words(count: float) -> str:
    """Words for the number of elements across the thinnest twentieth of the boundary; below 1 it is no limb."""
    return f"{count:.1f} elements across" if count >= 1 else "less than 1 element across, as at tips and corners"


def _material_name(material: "Material") -> str:
    """Name in the table, or in the user's own file, of a material."""
    from hydrostat.robot import own_materials

    if material.name:
        return material.name
    with suppress(InputError):  # a broken file of own materials concerns no other robot
        for found in own_materials().values():
            if replace(found, name="", source="") == material:
                return found.name
    return "custom material"


def _plane_lines(body: "Body") -> list[str]:
    """Freedom of a flat body across its plane, and the difference that it makes where plane stress is nearer."""
    from hydrostat.robot import choose_plane

    if body.thickness is None:
        return []
    share = f"with {100 * body.material.poisson**2:.0f} % less force"
    if body.plane == "stress":
        return [f"plane stress: free to become thicker, bends {share} than in plane strain"]
    words = "plane strain: as thick everywhere as at rest"
    return [f'{words}; plane = "stress" would bend {share}' if choose_plane(body) == "stress" else words]


def _part_line(body: "Body", index: int) -> str:
    """Material, mass and number of elements of a part."""
    part, own = body.parts[index], body.element_materials == index + 1
    name = "rigid" if part.material is None else _material_name(part.material)
    volume = float(body.mesh.volumes[own].sum()) * (body.thickness or 1.0)
    mass = _mass_text(float(body.element_masses[own].sum()))
    count = int(own.sum()) // (1 if body.mesh.quadratic is None else 2**body.mesh.dim)
    return f"part {part.name}: {name}, {mass}, {_volume_text(volume)}, {plural(count, 'element')}"


def _held_parts(robot: "Robot") -> list[str]:
    """Return a line for each pin on a rigid part, which it holds as a whole."""
    import numpy as np

    body, lines = robot.body, []
    for number, pin in enumerate(robot.pins):
        held = pin.holds(body.mesh)[body.mesh.elements].any(axis=1)
        names = [
            part.name
            for index, part in enumerate(body.parts, start=1)
            if part.is_rigid and np.any(held & (body.element_materials == index))
        ]
        verb = "holds" if pin.drive is None else f"moves by drive {pin.drive}"
        lines += [f"pin {number + 1} touches rigid part {name} and {verb} all of it" for name in names]
    return lines


def _rod_line(rod: "Rod") -> str:
    """Length, diameter and stiffnesses of a rod."""
    axial, bending = rod.stiffnesses
    thick = "" if rod.diameter is None else f", {1e3 * rod.diameter:.3g} mm thick"
    stretch = f"{axial:.3g} N" if axial < 1000 else f"{1e-3 * axial:.4g} kN"
    bend = f"{1e6 * bending:.3g} N mm²" if bending < 1e-3 else f"{1e6 * bending:.0f} N mm²"
    twist = "" if rod.torsional_stiffness is None else f", GJ {1e6 * rod.torsional_stiffness:.3g} N mm²"
    return f"rod {rod.name}: {1e3 * rod.length:.0f} mm long{thick}, EA {stretch}, EI {bend}{twist}"


def _sheet_line(body: "Body", sheet: "Membrane") -> str:
    """Material, thickness and covered area of a sheet."""
    name = _material_name(sheet.material)
    wrinkles = ", wrinkles" if sheet.wrinkles else ""
    area = 1e4 * sheet.find_area(body.mesh, body.thickness)
    return f"sheet {sheet.name}: {name}, {1e3 * sheet.thickness:.3g} mm thick, {area:.3g} cm²{wrinkles}"


def _noise_text(sensor: "Sensor") -> str:
    """Noise of a sensor, as robot.toml has it."""
    return f"noise {sensor.noise_value()}" if sensor.noise else "no noise"


def _mass_text(mass: float) -> str:
    """Mass in grams, or in kilograms from 1 kg on."""
    return f"{mass:.3g} kg" if mass >= 1 else f"{1e3 * mass:.3g} g"


def _volume_text(volume: float) -> str:
    """Volume in cubic centimeters, or in liters from 1 L on."""
    return f"{1e3 * volume:.3g} L" if volume >= 1e-3 else f"{1e6 * volume:.3g} cm³"
