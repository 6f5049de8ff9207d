"""`hydrostat check`."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrostat.cli.folders import RobotFolder
from hydrostat.cli.waiting import patiently, read_robot
from hydrostat.errors import InputError
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.robot import Body, Robot


def check(
    robot: RobotFolder,
    thorough: Annotated[
        bool,
        typer.Option(
            "--thorough", help="Also compute the reach of markers, and how far a filled body leaves its plane."
        ),
    ] = False,
    filled: Annotated[
        bool,
        typer.Option("--filled", help="Play its poses on the filled body, cables on each face, however long."),
    ] = False,
) -> None:
    """Check a robot: report what is wrong with it and what is risky.

    Example: hydrostat check examples/starfish --thorough
    """
    from hydrostat.robot import face_words

    found = read_robot(robot)
    mesh = found.body.mesh
    kind = "triangles" if mesh.dim == 2 else "tetrahedra"
    print(f"{found.name}: {1e3 * mesh.size:.0f} mm, {len(mesh.nodes)} nodes, {len(mesh.elements)} {kind}")
    for line in _body_lines(found.body):
        print(line)
    parts = {"pin": found.pins, "winch": found.winches, "cable": found.cables, "marker": found.markers}
    counts = ", ".join(plural(len(entries), noun) for noun, entries in parts.items())
    print(f"{counts}, poses: {', '.join(found.poses) or 'none'}")
    if words := face_words(found):
        print(f"cables: {words}")
    if found.cables:
        from hydrostat.design import build_effort

        print(f"to build its network: {build_effort(found, ())}; more if poses ask for stronger ones")
    if filled:
        _print_filled(found)
    elif words and thorough:
        _print_out_of_plane(found)
    reaches = bool(found.markers and found.cables)
    if reaches and thorough:
        _print_reach(found)
    left_out = ["reach of markers"] * reaches + ["motion out of the plane"] * (bool(words) and not filled)
    if left_out and not thorough:
        print(f"not computed: {' and '.join(left_out)}. Add --thorough.")
    _print_judgement(found)


def _print_judgement(robot: "Robot") -> None:
    """What is to be said before a robot is built, as the studio says it: whatever its poses ask of motors."""
    from hydrostat.design import Constraints, Diagnostic, Severity, review_robot
    from hydrostat.robot import in_words

    found = [Diagnostic(text=text, weight=Severity.REFUSED, places=()) for text in print_sewing(robot.body)]
    found += review_robot(robot, constraints=Constraints())
    for finding in found:
        print(f"{FINDINGS[finding.weight]}: {in_words(finding.text)}")
    refused, risky = (sum(one.weight is weight for one in found) for weight in (Severity.REFUSED, Severity.MIND))
    good = "Nothing is wrong" if robot.cables else "Nothing is wrong with the body"
    wrong = f"{plural(refused, 'thing')} cannot be built" if refused else good
    minded = f", {risky} risky" if risky else ""
    missing = "" if robot.cables else "; there are no cables yet"
    print(f"{wrong}{minded}{missing}.")


def print_sewing(body: "Body") -> tuple[str, ...]:
    """Print what sewing the skin of a stuffed body in space takes; returns why it cannot be sewn, if so."""
    from hydrostat.fabrication import KitOptions

    if not KitOptions().sews_skin(body):
        return ()
    from hydrostat.fabrication import find_sewing

    with patiently("laying its skin flat, patch by patch ..."):
        sewing = find_sewing(body)
    if not sewing.problems:
        print(f"to sew its skin: {sewing}")
    return sewing.problems


FINDINGS = {"refused": "cannot be built", "limit": "not as a design would", "mind": "risky"}
"""Beginning of the line of a finding, by its weight."""


def _print_reach(robot: "Robot") -> None:
    """What each marker can be brought to: by few poses for large bodies, not at all for the largest; soon told."""
    from hydrostat.design import Constraints
    from hydrostat.errors import NotConvergedError
    from hydrostat.ik import find_reach
    from hydrostat.simulation import Simulation

    nodes = len(robot.body.mesh.nodes)
    if nodes > _LARGE:
        print(f"reach of markers: not looked for, as {nodes} nodes take long; with larger elements it is told")
        return
    tension, count = Constraints().tension_limit, int(min(max(_SOLVED / nodes, _LEAST), _MOST))
    try:
        reaches = find_reach(Simulation(robot), tension=tension, count=count)
    except (InputError, NotConvergedError) as error:
        print(f"reach: not found, {error}")
        return
    print(f"reach of markers with at most {tension:g} N in a cable, by {count} poses:")
    for reach in reaches:
        print(f"  {reach.marker}: {reach}")


_SOLVED, _LEAST, _MOST = 30_000, 9, 64  # nodes of all poses that are tried for the reach; fewest and most poses
_LARGE = 5000  # nodes of a body from which on even the fewest poses take long


def _print_out_of_plane(robot: "Robot") -> None:
    """How far a flat robot comes out of its plane with its cables where they are, if that is quickly told."""
    from hydrostat.errors import NotConvergedError
    from hydrostat.simulation import filled_motion, quickly_filled

    if not quickly_filled(robot, len(robot.poses)):
        if robot.body.outline is not None and robot.poses:
            print("once filled: it takes long to tell how far markers leave the plane; ask by hydrostat check --filled")
        return
    try:
        print(f"once filled: {filled_motion(robot, _pulled(robot))}")
    except (InputError, NotConvergedError) as error:
        print(f"once filled: not found, {error}")


def _print_filled(robot: "Robot") -> None:
    """How far a flat robot comes out of its plane once it is filled, by face."""
    from hydrostat.robot import Face
    from hydrostat.simulation import filled_motion

    if robot.body.outline is None:
        raise InputError("--filled is for flat robots with a drawing; leave it out")
    if not robot.poses or not robot.cables:
        raise InputError("--filled plays the poses of a robot by its cables; it needs at least one of each")
    pulled = _pulled(robot)
    print("Filled, with the commands of the flat model (the most of all markers and poses):")
    for face in Face:
        print(f"  cables {face.words}: {filled_motion(robot, pulled, face)}")


def _pulled(robot: "Robot") -> list[Any]:
    """Contractions of all winches, for each pose."""
    from hydrostat.ik import IKOptions, solve_ik
    from hydrostat.simulation import Simulation

    simulation, once = Simulation(robot), IKOptions(restarts=0)
    return [solve_ik(simulation, pose, options=once).pose.contractions for pose in robot.poses.values()]


def _body_lines(body: "Body") -> list[str]:
    """Material with mass and volume; thickness of nine tenths of the body, and the worst angle of its mesh."""
    from hydrostat.geometry import dihedral_angles, smallest_angle

    mesh, material = body.mesh, body.material
    volume = float(mesh.volumes.sum()) * (body.thickness or 1.0)
    thickness = body.measured_thickness
    (thin, few), (thick, many) = thickness.part(0.05), thickness.part(0.95)
    if mesh.dim == 2:
        angle = f"smallest angle {smallest_angle(mesh):.0f} degrees"
    else:
        angle = f"smallest angle between faces {dihedral_angles(mesh.nodes, mesh.elements).min():.2g} degrees"
    name = material.name or "material by its numbers"
    return [
        f"{name}: {1e3 * volume * material.density:.3g} g, {1e6 * volume:.3g} cm^3",
        f"{1e3 * thin:.0f} to {1e3 * thick:.0f} mm across, that is {few:.1f} to {many:.0f} elements; {angle}",
    ]
