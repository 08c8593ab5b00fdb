from __future__ import annotations

import json
from dataclasses import replace
from importlib.resources import files
from typing import Any

import jsonschema
import numpy as np
import pytest
from hypothesis import given

from kerfwise.encoder.candidates import LeadOptions, build_candidates
from kerfwise.encoder.candidates.candidate import Candidate, CommonOptions
from kerfwise.encoder.facts import FactOptions, Facts, compute_facts
from kerfwise.encoder.facts.export import facts_json
from kerfwise.encoder.facts.facts import LinkPath
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.small_holes import HoleLimits, with_small_holes
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.tests.encoder.facts.random_nests import nests
from kerfwise.tests.tools.amount import examples

SCHEMA = json.loads(files("kerfwise.encoder.facts").joinpath("facts.schema.json").read_text(encoding="utf-8"))
CANDIDATE = Candidate(0, 80.0, (90.0, 10.0), "ccw", (95.0, 5.0), None, None, (90.0, 10.0), 325.5)


def small() -> Facts:
    """Two squares side by side, the left one in the corner, and one candidate of it."""
    given_nest = nest(400, 400, part("A", rect(10, 10, 80, 80)), part("B", rect(100, 10, 80, 80)))
    return compute_facts(given_nest, FactOptions(zone_pairs=(("A.outer", "B.outer"),)), (CANDIDATE,))


def document() -> dict[str, Any]:
    data: dict[str, Any] = json.loads(facts_json(small()))
    return data


def test_a_contour_row() -> None:
    assert document()["contours"][1] == {
        "id": "B.outer",
        "part": "B",
        "kind": "outer",
        "parent": None,
        "zone": 1,
        "long": False,
        "length_mm": 320.0,
        "heat_kj": None,
        "contains": [],
        "level_ahead": ["A.outer"],
        "in_hull": [],
        "neighbours": [{"contour": "A.outer", "length_mm": 80.0, "gap_mm": 10.0}],
        "edge_gap_mm": {"left": 100.0, "right": 220.0, "bottom": 10.0, "top": 310.0},
        "edge_length_mm": {"left": 0.0, "right": 0.0, "bottom": 80.0, "top": 0.0},
        "solid_mm": 160.0,
    }


def test_a_link_row() -> None:
    path = ((90.0, 50.0), (95.0, 45.0), (100.0, 50.0))
    linked = replace(small(), links=(LinkPath((0,), (0,), path),))
    data = json.loads(facts_json(linked))
    jsonschema.validate(data, SCHEMA)
    assert data["links"] == [
        {
            "from": "A.outer",
            "to": "A.outer",
            "leave": [0],
            "reach": [0],
            "path": [[90.0, 50.0], [95.0, 45.0], [100.0, 50.0]],
            "length_mm": 14.142,
        }
    ]


def test_facts_without_links_say_nothing_of_them() -> None:
    assert "links" not in document()


def test_a_candidate_row() -> None:
    assert document()["candidates"] == [
        {
            "candidate": 0,
            "contour": "A.outer",
            "entry": [90.0, 10.0],
            "entry_mm": 80.0,
            "direction": "ccw",
            "pierce": [95.0, 5.0],
            "end": [90.0, 10.0],
            "cut_mm": 325.5,
            "edge_start": False,
            "meets_kerfs_of": [],
            "meets_leads_of": [],
            "head": {
                "total_mm": 80.0,
                "edge_mm": 0.0,
                "solid_mm": 0.0,
                "neighbours": [{"contour": "B.outer", "length_mm": 80.0}],
            },
            "tail": {"total_mm": 80.0, "edge_mm": 80.0, "solid_mm": 0.0, "neighbours": []},
        }
    ]


def test_ways_along_common_edges_say_which_neighbours_are_out() -> None:
    """A rule author would take half a ring for a way that may be used at any time."""
    two = nest(300, 200, part("A", rect(20, 30, 80, 60)), part("B", rect(101.5, 30, 80, 60)))
    options = LeadOptions(kerf_mm=1.5, entries=2, common=CommonOptions(20.0, 0.05))
    data = json.loads(facts_json(compute_facts(two, FactOptions(), build_candidates(two, options))))
    jsonschema.validate(data, SCHEMA)
    rows = [row for row in data["candidates"] if row["contour"] == "B.outer"]
    said = {(row.get("kerf_start"), *row.get("out", ()), *row.get("still_in", ("none in",))) for row in rows}
    assert said == {(None, "A.outer"), (True, "A.outer", "none in")}


def test_the_sheet() -> None:
    data = document()
    assert (data["start_side"], data["start_side_because"]) == ("left", "offcut")
    assert data["sides"]["right"] == {"offcut_mm": 220.0, "offcut_large": True, "heat_mm": 0.0, "heat_parts": 0}
    assert data["options"]["zone_pairs"] == [["A.outer", "B.outer"]]


def test_zones_and_their_heat() -> None:
    assert document()["zones"] == [{"zone": 1, "contours": 2, "heat_kj": None}]
    sheet, options = small().nest, FactOptions(zone_contours=1, zone_heat_kj=20.0)
    data = json.loads(facts_json(compute_facts(sheet, options, (), np.array([10.0, 12.34567]))))
    jsonschema.validate(data, SCHEMA)
    assert data["zones"] == [
        {"zone": 1, "contours": 1, "heat_kj": 10.0},
        {"zone": 2, "contours": 1, "heat_kj": 12.346},
    ]
    assert [row["heat_kj"] for row in data["contours"]] == [10.0, 12.346]
    assert data["options"]["zone_heat_kj"] == 20.0


def test_the_schema_is_sound_and_says_what_every_field_is() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    for name in ("zone", "contour", "candidate"):
        for field, what in SCHEMA["$defs"][name]["properties"].items():
            assert what.keys() & {"description", "$ref", "enum"} or field == "part"


@pytest.mark.slow
@given(nests())
@examples(15)
def test_every_text_follows_the_schema(given_nest: Nest) -> None:
    jsonschema.validate(json.loads(facts_json(compute_facts(given_nest, FactOptions()))), SCHEMA)


@pytest.mark.parametrize("field", ["zone", "neighbours", "kind"])
def test_the_schema_refuses_a_row_that_lacks_a_field(field: str) -> None:
    data = document()
    jsonschema.validate(data, SCHEMA)
    del data["contours"][0][field]
    with pytest.raises(jsonschema.ValidationError, match=field):
        jsonschema.validate(data, SCHEMA)


def test_the_same_facts_give_the_same_text() -> None:
    assert facts_json(small()) == facts_json(small())


def test_small_holes_are_told_and_slow_ones_have_their_share() -> None:
    plate = nest(300, 200, part("A", rect(20, 20, 150, 150), [circle(60, 60, 2), circle(110, 110, 6)]))
    limits = HoleLimits(least_mm=6, under="spot", full_feed_mm=30, feed_share=0.6)
    data = json.loads(facts_json(compute_facts(with_small_holes(plate, limits), FactOptions())))
    jsonschema.Draft202012Validator(SCHEMA).validate(data)
    assert data["small_holes"] == {"marked": ["A.hole1"], "left_out": []}
    assert [(c["id"], c["kind"], c.get("feed_share")) for c in data["contours"]] == [
        ("A.hole1", "mark", None), ("A.hole2", "hole", 0.7), ("A.outer", "outer", None)
    ]  # fmt: skip
    assert "small_holes" not in json.loads(facts_json(compute_facts(plate, FactOptions())))
