import pytest

from hydrostat.errors import PART_KEYS
from hydrostat.robot.schema import RobotTable
from hydrostat.robot.schema_errors import allowed_keys
from hydrostat.robot.tables_file import find_line

TEXT = """\
name = "a"          # 1
body.size = "1 m"
[ body ]
"outline" = "x"
  mesh="y"
[[pin]]             # 6
at = [0, 0]
[[pin]]
radius = 1
[[pose]]            # 10
name = "p"
targets.b = [0, 0]
[[pose]]
name = "q"
  [pose.targets]    # 15
  tip = [
    [0, 1],
  ]
[[cable]]           # 19
winch = [{name = 1}]
[[cable]]           # 21
winch.name = 1
[[cable.winch.top]] # 23
top = 1
[[cable.winch.top]] # 25
[[body.part]]       # 26
name = "bone"
[[body.part]]       # 28
name = "joint"
radius = 3          # 30
  [body.part.material]
  young = "1 kPa"   # 32
"""


@pytest.mark.parametrize(
    ("key", "line"),
    [
        ("name", 1),
        ("format", None),
        ("radius", None),
        ("body", 3),
        ("body.outline", 4),
        ("body.mesh", 5),
        ("body.thickness", 3),
        ("body.part[0]", 26),
        ("body.part[1].radius", 30),
        ("body.part[1].at[1]", 28),
        ("body.part[1].material.young", 32),
        ("pin[0].at", 7),
        ("pin[0].radius", 6),
        ("pin[1].radius", 9),
        ("pin[1].at[0]", 8),
        ("pin[2]", None),
        ("pose[0].targets.b", 12),
        ("pose[0].targets", 12),
        ("pose[1].name", 14),
        ("pose[1].targets", 15),
        ("pose[1].targets.tip", 16),
        ("pose[1].targets.top", 15),
        ("cable[0].points[3]", 19),
        ("cable[0].winch[0].name", 20),
        ("cable[1].winch.name", 22),
        ("cable[1].winch.top", 23),
        ("cable[1].winch.top[0].top", 24),
        ("cable[1].winch.top[1].top", 25),
        ("cable[1].winch.top[2].top", 25),
        ("", None),
        ("(", None),
    ],
)
def test_line(key: str, line: int | None) -> None:
    """Oracle: the lines counted by hand."""
    assert find_line(TEXT, key) == line
    assert find_line(TEXT.replace("\n", "\r\n"), key) == line


def test_errors_know_all_keys_of_parts() -> None:
    """Oracle: the schema of the tables that repeat."""
    kinds = ("pin", "drive", "winch", "cable", "marker", "pose", "obstacle", "load", "rod", "sheet", "sensor")
    assert set().union(*(allowed_keys(kind, RobotTable) for kind in (*kinds, "body.part"))) == set(PART_KEYS.split("|"))
