"""The page of what older kerfs cost: both plans of a nest are made, and counted by the check."""

from __future__ import annotations

import json

from kerfwise.benchmarks.older_kerfs import grid, planned
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.rules.profile.load import load_profile


def test_a_grid_with_narrow_streets_is_planned_both_ways() -> None:
    made = grid(4.0)
    parts = made["parts"]
    assert isinstance(parts, list)
    nest = read_json(json.dumps(made | {"parts": [*parts[:3], *parts[8:11]]}).encode(), ReadOptions())
    before, now = (planned(nest, load_profile(), 1.0, minding) for minding in (False, True))
    assert before.over > 0
    assert now.over == 0
    assert before.proven
    assert now.proven
