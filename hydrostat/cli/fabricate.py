"""`hydrostat fabricate`."""

from typing import Annotated

import typer

from hydrostat.cli.arguments import OutFolder, RobotFolder, require_folder
from hydrostat.cli.prepare import read_robot


def fabricate(
    robot: RobotFolder,
    out: OutFolder,
    force: Annotated[bool, typer.Option(help="Write the pattern even if it cannot be built well.")] = False,
) -> None:
    """Write the laser pattern of a flat robot.

    Writes pattern.svg and pattern.dxf, in mm, true to scale.

    Example: hydrostat fabricate examples/starfish --out build/kit
    """
    from hydrostat.fabrication import PatternOptions, export_kit, plush_pattern

    require_folder(out)
    loaded = read_robot(robot)
    options = PatternOptions(force=force)
    pattern = plush_pattern(loaded, options=options)
    for warning in pattern.warnings:
        print(f"warning: {warning}")
    files = export_kit(loaded, out, options=options)
    print(f"Sheet of {pattern.width:.0f} x {pattern.height:.0f} mm: front and back panel, {len(loaded.cables)} cables")
    print("Wrote " + ", ".join(str(file) for file in files))
