"""The text of a TOML file in blocks. The oracle is the text itself, and tomllib."""

import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hydrostat.robot import gallery_folder, list_gallery
from hydrostat.robot.merge import comments, split_blocks

TRICKY = '''\
# top
format = 1 # one
text = """
# no comment
[[no.header]]
"""
raw = \'[no] # no\'
list = [
  [1, 2], # first
  # [[no]]
  [3, 4],
]

# apart

# of a
[a] # on a
x = "]#"
# end of a

[a.b] # on b
y = 1
  # indented, of c
  [["c"]]
z = 1
# end of c

# end of all
'''


def whole(text: str) -> str:
    blocks, tail = split_blocks(text)
    return "".join(block.free + block.lead + block.text for block in blocks) + tail


def test_each_table_has_its_comments() -> None:
    blocks, tail = split_blocks(TRICKY)
    assert whole(TRICKY) == TRICKY
    assert [(block.name, block.whole) for block in blocks] == [("", True), ("a", True), ("c", True)]
    assert (blocks[1].free, blocks[1].lead) == ("\n# apart\n\n", "# of a\n")
    assert blocks[1].text.startswith("[a] # on a\n")
    assert blocks[1].text.endswith("[a.b] # on b\ny = 1\n")
    assert (blocks[2].lead, tail) == ("  # indented, of c\n", "\n# end of all\n")
    assert blocks[2].text.endswith("# end of c\n")
    told = ["# top", "# one", "# first", "# [[no]]", "# apart", "# of a", "# on a", "# end of a", "# on b",
            "# indented, of c", "# end of c", "# end of all"]  # fmt: skip
    assert comments(TRICKY) == told


@pytest.mark.parametrize("name", list_gallery())
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_blocks_are_all_of_the_text(name: str, ends: str) -> None:
    text = (gallery_folder(name) / "robot.toml").read_text(encoding="utf-8").replace("\n", ends)
    blocks, _ = split_blocks(text)
    assert whole(text) == text
    data = tomllib.loads(text)
    for kind in ("pin", "winch", "cable", "marker", "pose"):
        own = [tomllib.loads(block.text)[kind][0] for block in blocks if block.name == kind]
        assert own == data.get(kind, [])


LINES = st.lists(
    st.sampled_from(["", "# a remark", "[a]", "[[b]]", "[b.c]", "[a.d]", 'x = "#"', "y = [1, # in\n2]", "  # deep"]),
    max_size=12,
)


@settings(deadline=None)
@given(LINES, st.booleans())
def test_any_lines_are_kept(lines: list[str], ended: bool) -> None:
    text = "\n".join(lines) + ("\n" if ended else "")
    assert whole(text) == text
    assert len(comments(text)) == sum("remark" in line or "deep" in line or "in\n" in line for line in lines)
