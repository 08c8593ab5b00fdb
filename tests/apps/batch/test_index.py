"""The index by hand: which machine is better, sums, groups of what was refused."""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path

import pytest

from kerfwise.apps.batch.reports import index_files
from kerfwise.apps.batch.result import Figures, Row, cheapest, groups_of, quickest, totals
from kerfwise.apps.batch.run import Batch
from kerfwise.apps.batch.verbs import printed


def planned(machine: str, time_s: float, cost: float | None = None, currency: str = "EUR") -> Row:
    figures = Figures(1, 1, 100.0, 10.0, time_s, 0.0, (), cost, "" if cost is None else currency)
    return Row("a", "a.json", machine, "planned", figures=figures, files={"a.nc": "0"})


def refused(nest: str, told: str, machine: str = "m") -> Row:
    return Row(nest, f"{nest}.json", machine, "refused", told)


@pytest.mark.parametrize(
    ("rows", "quick", "cheap"),
    [
        ([planned("a", 10, 3.0), planned("b", 20, 2.0)], "a", "b"),
        ([planned("a", 10, 3.0), planned("b", 10, 3.0)], "a", "a"),
        ([planned("a", 10, 3.0), planned("b", 20)], "a", ""),
        ([planned("a", 10), planned("b", 20)], "a", ""),
        ([planned("a", 10, 3.0), planned("b", 20, 2.0, "USD")], "a", ""),
        ([planned("a", 10, 3.0), refused("a", "open", "b")], "a", "a"),
        ([refused("a", "open", "a"), refused("a", "open", "b")], "", ""),
        ([planned("a", 10, 3.0)], "", ""),
        ([], "", ""),
    ],
)
def test_the_better_machine(rows: list[Row], quick: str, cheap: str) -> None:
    assert (quickest(rows), cheapest(rows)) == (quick, cheap)


def test_sums_of_a_machine() -> None:
    rows = [
        planned("a", 10, 3.0),
        planned("a", 5, 2.5),
        refused("b", "open", "a"),
        planned("b", 7, 1.0),
        planned("b", 1),
    ]
    first, second = totals(rows, ["a", "b"])
    assert (first.planned, first.refused, first.time_s, first.cost, first.currency) == (2, 1, 15.0, 5.5, "EUR")
    assert (second.planned, second.time_s, second.cost) == (2, 8.0, None), "a sum of some prices is no price"


def test_the_same_trouble_is_one_group_whatever_the_names_and_numbers() -> None:
    rows = [
        refused("a", "1 problem\n  - P1.outer is open at (3.0, 4.0)"),
        refused("b", "3 problems\n  - P2.outer is open at (5.0, 4.0)"),
        refused("c", "2 problems\n  - x"),
        Row("d", "d.json", "m", "no plan", "these cannot all hold"),
        Row("e", "e.json", "m", "no plan", "these cannot all hold", relax=True),
        refused("f", "line 3: not JSON"),
        refused("g", "line 17: not JSON"),
    ]
    found = [[row.nest for row in group.rows] for group in groups_of(rows)]
    assert found == [["a", "b", "c"], ["f", "g"], ["d"], ["e"]]
    (relaxed,) = (group for group in groups_of(rows) if group.rows[0].nest == "e")
    assert "--relax" in relaxed.remedy


def test_what_is_said_of_several_machines_is_said_once() -> None:
    (group,) = groups_of([refused("a", "open", "x"), refused("a", "open", "y"), refused("b", "open", "y")])
    assert list(group.said()) == [("a", "open", ("x", "y")), ("b", "open", ("y",))]


def test_the_page_has_a_group_with_its_remedy_and_a_link_to_each_nest() -> None:
    page = index_files([refused("a", "open <here>", "x"), refused("a", "open <here>", "y")], ["x", "y"])["index.html"]
    assert "<h3>The nest cannot be cut as it is drawn</h3><p class=remedy>Mend the drawing" in page
    assert page.count("<pre>open &lt;here&gt;</pre>") == 1
    (link,) = re.findall(r'<a href="#(\w+)">a</a> \(x, y\)', page)
    assert f'<article id="{link}">' in page


def test_any_name_can_be_in_the_index() -> None:
    rows = [refused("half \udcff of one", "a\x1b[2Jb", "m"), planned("m", 1.0)]
    files = index_files(rows, ["m"])
    assert files == index_files(rows, ["m"])
    for text in files.values():
        text.encode("utf-8")
    assert "\x1b" not in files["index.html"]
    lines = list(csv.DictReader(io.StringIO(files["index.csv"])))
    assert [line["program"] for line in lines] == ["", "m/a.nc"]
    assert [line["gap"] for line in lines] == ["", "0.0"]


def test_a_long_refusal_is_folded_and_nothing_of_it_is_lost() -> None:
    told = "50 problems" + "".join(f"\n  - P{k} touches P{k + 1}" for k in range(50))
    rows = [refused("a", told), refused("b", told.replace("50 p", "4 p").rsplit("\n", 46)[0])]
    files = index_files(rows, ["m"])
    before, _, rest = files["index.html"].partition("<details><summary>… and 47 more</summary>")
    assert (before.count("touches"), rest.partition("</details>")[0].count("touches")) == (3, 47)
    assert files["index.html"].count("<details>") == 1, "four are told as a whole"
    assert [line["told"].count("touches") for line in csv.DictReader(io.StringIO(files["index.csv"]))] == [3, 4]
    assert files["index.json"].count("touches") == 2 * (50 + 4), "at the nest, and among what is refused"
    out = printed(Batch(tuple(rows), ("m",)), Path("out"))
    assert out.count("touches") == 3 + 4
    assert "… and 47 more, all of them in the index" in out


def test_no_cell_is_a_formula_and_no_script_runs_in_the_page() -> None:
    rows = [refused(name, "-2+3", "@m") for name in ("=1+1", "+1+1", "-1.dxf", "\t=1")]
    files = index_files(rows, ["@m"])
    for line in csv.DictReader(io.StringIO(files["index.csv"])):
        assert all(line[column].startswith("'") for column in ("nest", "machine", "told"))
    policy = re.findall(r'http-equiv="Content-Security-Policy" content="([^"]+)"', files["index.html"])
    assert policy == [
        "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
    ]
