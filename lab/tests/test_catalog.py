"""The catalog of `hydrostat reproduce` and its page. Oracles: the files that it cites, results made by hand."""

import json
import re
from pathlib import Path

import pytest

from hydrostat.errors import HydrostatError, InputError
from hydrostat_lab.catalog import CATALOG, ROOT, CatalogEntry, Finding, catalog_lines, read_costs
from hydrostat_lab.reproduced_page import read_findings_of, write_page
from hydrostat_lab.trial_tables import is_finished

ENTRIES = [entry for entries in CATALOG.values() for entry in entries]
THESIS = {entry.name: entry for entry in CATALOG["Chang (2018)"]}
NUMBER = re.compile(r"\d[\d,.]*(?<![.,])")
WORDS = {"confirmed", "contradicted", "beaten", "cannot be told", "measured", "drawn"}


def unfounded(entry: CatalogEntry) -> list[str]:
    """What an entry says and its file does not."""
    if entry.claims:
        return [found.verdict for found in entry.read_findings() if found.verdict.partition(",")[0] not in WORDS]
    line, text = (" ".join(each.split()) for each in (entry.line, (ROOT / entry.source).read_text(encoding="utf-8")))
    lost = [] if line and line in text else [entry.line]
    return lost + sorted(set(NUMBER.findall(entry.ours)) - set(NUMBER.findall(line)))


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: f"{entry.name} {entry.shows}")
def test_each_result_stands_in_the_file_that_it_names(entry: CatalogEntry) -> None:
    assert unfounded(entry) == []
    assert entry.claims or entry.verdict in WORDS


def test_an_unfounded_result_is_found() -> None:
    entry = THESIS["table-5.1"]
    assert unfounded(entry._replace(ours="0.102 mm")) == ["0.102"]
    assert unfounded(entry._replace(line="no such line", ours="")) == ["no such line"]
    with pytest.raises(HydrostatError, match='no row for "T=7 wins"'):
        THESIS["figure-5.8"]._replace(claims=("T=7 wins",)).read_findings()


def test_costs_are_those_of_the_whole_run() -> None:
    """Oracle: the time of `all` that the page of the studies states."""
    costs = read_costs()
    assert set(costs) <= {entry.name for entry in ENTRIES}
    told = re.search(r"It took ([\d.]+) minutes", (ROOT / "lab" / "README.md").read_text(encoding="utf-8"))
    minutes = [float(cost.removesuffix(" min")) for name, cost in costs.items() if name in THESIS and " min" in cost]
    assert told is not None
    assert sum(minutes) == pytest.approx(float(told[1]), abs=0.2)
    rows = [line for line in catalog_lines() if line.startswith(("  table-", "  figure-"))]
    assert [row[45:61].strip() for row in rows] == [costs.get(name, "not measured") for name in THESIS]


def test_claims_are_those_of_the_experiments() -> None:
    """Codes of claims, in order: the page sets them side by side."""
    pytest.importorskip("torch")
    from hydrostat_lab.experiments import EXPERIMENTS
    from hydrostat_lab.shared_data import ORDERS

    judged = {name: [claim.text for claim in each.claims] for name, each in EXPERIMENTS.items()}
    judged["figure-5.14-trial"] = [order.text for order in ORDERS]
    for name, texts in judged.items():
        listed = THESIS[name].claims
        codes = [re.findall(r"\([A-Z]\d[^)]*\)", text) for text in texts]
        assert [re.findall(r"\([A-Z]\d[^)]*\)", text) for text in listed] == codes[: len(listed)]


def test_the_page_sets_the_thesis_and_both_runs_side_by_side(tmp_path: Path) -> None:
    claims = [{"claim": f"claim {i}", "verdict": "confirmed", "number": f"0.{i}", "seeds": []} for i in (1, 2)]
    (tmp_path / "table-noise.json").write_text(json.dumps({"claims": claims}))
    (tmp_path / "table-5.1.csv").write_text("method,samples,thumb,mean\nthesis,300,1,0.9\nsearch,300,1,0.05\n")
    (tmp_path / "figure-5.8-small.png").write_bytes(b"")
    text = write_page(tmp_path).read_text()
    row = "| noise 0.2 ends nearer than 0.01 (E47) |  | -2.0 (-3.8 to -1.0) mm | contradicted, at 7,500 actions | 0.2 |"
    assert f"|  {row} confirmed |\n" in text
    assert "| 6.10 mm, 10,000 samples | 0.101 mm, 10000 samples | beaten | 0.500 mm, 300 samples |  |\n" in text
    told = "1.0 (0.0 to 1.9) mm | cannot be told, at 10,500 actions | not run: "
    assert f"{told}{THESIS['figure-5.9'].dear} |  |\n" in text
    assert "## figure-5.8-small\n" in text
    assert "## figure-5.8\n" not in text


def test_results_of_a_folder_are_read(tmp_path: Path) -> None:
    rows = [{"way": way, "pairs": 9, "seeds": seeds} for way, seeds in (("a", [3, 5]), ("b", [1, 2]))]
    rows.append({"way": "certified inverse kinematics", "pairs": 9, "seeds": [0.1]})
    file, entry = tmp_path / "table-policies.json", THESIS["table-policies"]
    file.write_text(json.dumps({"settings": {"seeds": 2}, "rows": rows}))
    assert read_findings_of(tmp_path, entry) == [Finding("b", "", "b: 1.500 mm, 9 pairs")]
    assert is_finished(file, {"seeds": 2})
    assert not is_finished(file, {"seeds": 3})
    file.write_text("{")
    assert not is_finished(file, {"seeds": 2})
    with pytest.raises(InputError, match="damaged"):
        read_findings_of(tmp_path, entry)
