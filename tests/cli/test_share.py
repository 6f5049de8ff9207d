"""`hydrostat share`; tests/toy has what the page does."""

from collections.abc import Callable
from pathlib import Path

import pytest

Run = Callable[..., tuple[int, str, str]]


def test_share_writes_one_page_with_its_error(run: Run, starfish: Path, tmp_path: Path) -> None:
    file = tmp_path / "toy.html"
    code, out, _ = run("share", starfish, "--samples", "24", "--time", "120s", "--out", file)
    assert code == 0
    assert "in 4 held-out poses" in out
    text = file.read_text(encoding="utf-8")
    assert '"name":"star_jump"' in text
    assert "Checked in 4 other poses" in text
    assert len(text) < 1e6


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--out", "toy.zip"], "not an HTML file. Name a file such as toy.html."),
        (["--out", "nowhere/toy.html"], "folder not found. Name a file in an existing folder."),
        (["--out", "toy.html", "--time", "0s"], "--time 0s: must be above 0"),
    ],
)
def test_what_cannot_be_written_is_refused_at_once(run: Run, starfish: Path, options: list[str], told: str) -> None:
    code, _, err = run("share", starfish, *options)
    assert code == 2
    assert told in err
