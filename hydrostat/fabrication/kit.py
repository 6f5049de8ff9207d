"""`export_kit`: the files from which a robot is built."""

from pathlib import Path

from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.pattern import plush_pattern
from hydrostat.fabrication.patterns.pattern_options import PatternOptions
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.robot import Robot
from hydrostat.robot.write import replace_file


def export_kit(robot: Robot, folder: str | Path, *, options: PatternOptions | None = None) -> list[Path]:
    """Write the laser pattern as pattern.svg and pattern.dxf into a folder, made if need be.

    Nothing is written unless all can be; each file is written whole or not at all.

    Returns:
        The files.

    Raises:
        InputError: the robot cannot be cut as drawn.
    """
    pattern = plush_pattern(robot, options=options)
    files = {"pattern.svg": pattern_svg(pattern), "pattern.dxf": pattern_dxf(pattern)}
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    return [replace_file(folder / name, content) for name, content in files.items()]
