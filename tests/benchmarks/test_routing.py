"""The page of the routing benchmarks."""

from __future__ import annotations

from pathlib import Path

import pytest

import kerfwise
from kerfwise.benchmarks.routing import Limits, page, run_set
from kerfwise.jobs.bench import BestKnown

ROUTING = Path(kerfwise.__file__).parent / "examples" / "routing"


@pytest.mark.slow
def test_a_page_of_two_instances(tmp_path: Path) -> None:
    best = BestKnown({("routing", "nine"): 1169.0, ("routing", "twelve"): 390.0})
    runs = run_set("routing in 1 s", ROUTING, best, 1.0, 1)
    remarks = tmp_path / "remarks.md"
    remarks.write_text("## Remarks\n\nNone.\n", encoding="utf-8")
    made = tmp_path / "made.md"
    made.write_text("## Made\n\nNone either.\n", encoding="utf-8")
    text = page(runs, Limits(30.0, 1, (("routing", 1.0),)), [remarks, made])
    assert "| nine | 1169 | 1169 | +0.00% | yes |" in text
    assert "| routing in 1 s | twelve | 397 | 390 | +1.79% | yes |" in text, "a best known that is too good is no match"
    assert "2 runs, 2 feasible, 2 proven, at or under best known 1 of 2" in text
    assert "--time-limit 30 --seed 1 --also routing=1 --remarks remarks.md made.md\n" in text
    assert "\n\n## Remarks\n\nNone.\n\n## Made\n\nNone either.\n\n## routing in 1 s\n" in text
