"""Which contours heat each other: against every pair, one after the other."""

from __future__ import annotations

import json
from itertools import combinations

from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.rules.catalogue.heat_lag import ROUNDING_MM, _near


def test_near_contours_are_those_of_all_pairs() -> None:
    plate = read_json(json.dumps(make_sheet(1, 60)).encode(), ReadOptions())
    expected = [
        (a, b)
        for (a, one), (b, other) in combinations(enumerate(plate.contours), 2)
        if one.part != other.part and one.line.distance(other.line) < 25.0 - ROUNDING_MM
    ]
    assert expected
    assert _near(plate.contours, 25.0) == expected
