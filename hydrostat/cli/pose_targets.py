"""`given_targets`, `store_pose`, `show_muscles`: a pose by targets of the command line, stored, or shown by muscles."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import folder_of, require_writable, result_folder
from hydrostat.cli.limits import print_far_targets
from hydrostat.cli.option_errors import naming_option
from hydrostat.cli.options import axis_values, split_value
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.robot import PoseTarget, Robot

UNNAMED = "target"
"""Name of a pose that is not stored."""

Targets = Annotated[
    list[str] | None,
    typer.Option(
        "--target", metavar="MARKER=X,Y", help="Target of a marker in a new pose, e.g. top=30mm,110mm. Repeatable."
    ),
]
Store = Annotated[str | None, typer.Option(metavar="NAME", help="Add the pose of --target to robot.toml by this name.")]
Muscles = Annotated[
    bool, typer.Option("--muscles", help="Pose the body by muscle fibers instead of cables. Writes activation.png.")
]


def check_pose_options(
    robot: Path, *, name: str | None, targets: Sequence[str] | None, store: str | None, by_cables: Mapping[str, object]
) -> None:
    """Check that options of a pose fit together (InputError); `by_cables`: options that --muscles excludes, or None."""
    if name and targets:
        raise InputError("--pose and --target: mutually exclusive. Give one of them.")
    if store is not None and not targets:
        raise InputError(
            "--store: there is nothing to store. Give the targets with --target, e.g. --target top=0,120mm"
        )
    for key, given in by_cables.items():
        if given is not None:
            raise InputError(f"--muscles and {key}: mutually exclusive. Give one of them.")
    if store is not None:
        from hydrostat.robot import GALLERY, gallery_folder, list_gallery

        folder = folder_of(robot).resolve()
        for known in list_gallery():
            if folder == gallery_folder(known).resolve():
                copy = f"hydrostat new my_{known} --from {GALLERY}{known}"
                raise InputError(f"--store: the gallery is read-only. Make a copy: {copy}")
        require_writable(folder, f"--store {store}")


def given_targets(robot: "Robot", texts: Sequence[str] | None, store: str | None) -> "Sequence[tuple[str, PoseTarget]]":
    """The pose by its name; none without targets (InputError: an unknown marker, a wrong position, a name in use)."""
    from hydrostat.given import check_name
    from hydrostat.robot import PoseTarget
    from hydrostat.units import LENGTH

    if not texts:
        return ()
    if store is not None:
        if store in robot.poses:
            raise InputError(f'--store {store}: the robot has a pose "{store}". Choose another name.')
        with naming_option(f"--store {store}"):
            check_name(store)
    dim = robot.body.mesh.dim
    found: dict[str, tuple[float, ...]] = {}
    for text in texts:
        example = "MARKER=X,Y, e.g. top=30mm,110mm" if dim == 2 else "MARKER=X,Y,Z, e.g. top=30mm,110mm,0mm"
        marker, value = split_value("--target", text, example)
        if marker in found:
            raise InputError(f'--target: "{marker}" is given twice. Give each name once.')
        try:
            robot.marker(marker)
            found[marker] = axis_values(value.split(","), dim, LENGTH, f"{dim} coordinates. Write {example}")
        except InputError as error:
            raise InputError(f"--target {text}: {error}") from None
    pose = PoseTarget(name=store or UNNAMED, targets=found)
    print_far_targets(robot, [pose])
    return ((pose.name, pose),)


def store_pose(path: Path, robot: "Robot", name: str | None, poses: "Sequence[tuple[str, PoseTarget | None]]") -> None:
    """Add the pose of a name to robot.toml; comments stay. Without a name nothing is stored."""
    from hydrostat.files import read_text
    from hydrostat.robot import merged_text, save_robot

    pose = dict(poses).get(name) if name is not None else None
    if pose is None:
        return
    folder = folder_of(path)
    changed = replace(robot, poses={**robot.poses, pose.name: pose})
    save_robot(changed, folder, text=merged_text(read_text(folder / "robot.toml"), changed))
    print(f'added pose "{pose.name}" to {folder / "robot.toml"}')


def show_muscles(robot: "Robot", poses: "Sequence[tuple[str, PoseTarget | None]]", out: Path) -> None:
    """Bring a body into poses by muscle fibers on all mesh edges, print the errors, and draw each pose."""
    from hydrostat.cli.options import load_matplotlib
    from hydrostat.design import activate, edge_fibres

    load_matplotlib()
    from hydrostat.plot import draw_activation, save_png

    fibres = edge_fibres(robot.body.mesh)
    for title, pose in poses:
        if pose is None:  # a drawing alone, which --muscles excludes
            continue
        found = activate(robot, pose, fibres)
        errors = ", ".join(f"{name} {1e3 * error:.2f} mm" for name, error in found.errors.items())
        print(f"{title}: rms error {1e3 * found.rms_error:.2f} mm by muscles: {errors}")
        with result_folder(out / title if len(poses) > 1 else out) as made:
            save_png(draw_activation(robot, found), made / "activation.png")
    print("note: muscles pull anywhere in the body. Expect a larger error with cables")
    print(f"  wrote {out}")
