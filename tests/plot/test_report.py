import html
import re
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import pytest
from plot.designs import FORMULA, SCRIPT, hostile_network, hostile_trace

from hydrostat.errors import InputError
from hydrostat.plot import write_report
from hydrostat.plot.report import report_text
from hydrostat.plot.report_tables import millimeters
from hydrostat.robot import robot_hash

VOID = {"meta"}


class Page(HTMLParser):
    """Reads a page; every element must be closed in turn."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.links: list[str] = []
        self.words: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [value or "" for name, value in attrs if name in ("src", "href", "xlink:href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        self.open.remove(tag) if tag not in VOID else None

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


@pytest.mark.slow
def test_report_names_everything_and_runs_nothing() -> None:
    network = hostile_network()
    text = report_text(network, facts={"seed": 7, "<i>": "<img src=x onerror=alert(1)>"})
    page = Page(text)
    assert "script" not in page.tags
    assert "img" not in page.tags
    assert "b" in page.tags
    assert html.escape(SCRIPT) in text
    for words in (SCRIPT, FORMULA, "<b>", "<i>", network.robot.name, robot_hash(network.robot), "7"):
        assert any(words in part for part in page.words), words


@cache
def hostile_report() -> str:
    return report_text(hostile_network())


@pytest.mark.slow
def test_report_needs_no_other_file() -> None:
    page = Page(hostile_report())
    assert all(link.startswith(("#", "data:")) for link in page.links)
    assert not re.search(r"@import|url\((?!#)", hostile_report())


@pytest.mark.slow
def test_same_bytes_again(tmp_path: Path) -> None:
    written = write_report(hostile_network(), tmp_path / "report.html")
    assert written.read_bytes() == hostile_report().encode()
    assert len(written.read_bytes()) < 3e6
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


@pytest.mark.slow
def test_numbers_of_the_report() -> None:
    network, text = hostile_network(), hostile_report()
    for error in network.ik_results[0].errors.values():
        assert f">{1e3 * error:.2f}</span>" in text
    assert f"{1e3 * network.rms_error:.1f}<small>mm rms</small>" in text
    assert ">10.00</td>" in text  # contraction of the first winch [mm]
    assert f">{network.ik_results[0].pose.tensions[0]:.2f}</td>" in text


@pytest.mark.slow
def test_no_muscles_no_chapters_on_muscles() -> None:
    trace = replace(hostile_trace(), activations=(), candidates=(), trees=())
    text = report_text(replace(hostile_network(), trace=trace))
    assert "What muscles would do" not in text
    assert "What it reaches" in text


def test_a_design_without_poses_is_refused() -> None:
    with pytest.raises(InputError, match="at least one pose"):
        report_text(replace(hostile_network(), ik_results=()))


@pytest.mark.slow
def test_a_title_that_is_no_valid_text(tmp_path: Path) -> None:
    path = write_report(hostile_network(), tmp_path / "report.html", title="caf\udce9")
    assert "caf?" in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("error", "words"),
    [(0.0123456, "12.35"), (1e-4, "0.10"), (9.87e-5, "0.099"), (1.234e-6, "0.0012"), (5.7e-11, "0.00"), (0.0, "0.00")],
)
def test_millimeters(error: float, words: str) -> None:
    """Oracle: by hand."""
    assert millimeters(error) == words
