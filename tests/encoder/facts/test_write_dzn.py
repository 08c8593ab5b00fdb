from __future__ import annotations

import re

import pytest

from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts import FactOptions, compute_facts, export
from kerfwise.encoder.facts.export import facts_dzn
from kerfwise.rules.case import nest, part, rect

FIELDS = """\
n_contours = 3;
contour_id = ["A.hole1", "A.outer", "B\\"\\\\1.outer"];
part = [1, 1, 2];
kind = [2, 1, 1];
parent = [2, 0, 0];
zone = [1, 1, 1];
long = [false, false, false];
start_side = 1;
contains = [| false, false, false
   | true, false, false
   | false, false, false |];
level_ahead = [| false, false, false
   | false, false, true
   | false, false, false |];
in_hull = [| false, false, false
   | false, false, false
   | false, false, false |];
edge_gap = [| 2000, 34000, 2000, 34000
   | 1000, 31000, 1000, 31000
   | 10000, 22000, 1000, 31000 |];
edge_length = [| 0, 0, 0, 0
   | 8000, 0, 8000, 0
   | 0, 0, 8000, 0 |];
solid_length = [16000, 8000, 16000];
n_facing = 2;
facing_from = [2, 3];
facing_to = [3, 2];
facing_length = [8000, 8000];
facing_gap = [1000, 1000];
offcut_depth = [1000, 22000, 1000, 31000];
offcut_large = [false, true, false, true];
heat_length = [80000, 0, 80000, 0];
heat_parts = [2, 0, 2, 0];
n_candidates = 1;
cand_contour = [2];
cand_x = [9500];
cand_y = [500];
cand_end_x = [9001];
cand_end_y = [1000];
cand_ccw = [true];
cand_cut_length = [32550];
cand_edge_start = [false];
head_length = [8000];
head_edge = [0];
head_solid = [0];
n_head = 1;
head_cand = [1];
head_contour = [3];
head_facing = [8000];
tail_length = [8000];
tail_edge = [8000];
tail_solid = [0];
n_tail = 0;
tail_cand = [];
tail_contour = [];
tail_facing = [];
"""


def small_dzn() -> str:
    parts = part("A", rect(10, 10, 80, 80), [rect(20, 20, 40, 40)]), part('B"\\1', rect(100, 10, 80, 80))
    candidate = Candidate(1, 80.0, (90.0, 10.0), "ccw", (95.0, 5.0), None, None, (90.006, 10.0), 325.5)
    return facts_dzn(compute_facts(nest(400, 400, *parts), FactOptions(), (candidate,)))


def test_the_whole_text() -> None:
    assert small_dzn() == export.HEADER + FIELDS


def test_the_header_explains_every_field() -> None:
    explained = set(re.findall(r"\b[a-z]+(?:_[a-z]+)*\b", export.HEADER))
    for field in re.findall(r"^(\w+) = ", FIELDS, re.MULTILINE):
        assert field in explained


def test_a_nest_without_parts_keeps_the_shape_of_its_arrays() -> None:
    text = facts_dzn(compute_facts(nest(100, 100), FactOptions()))
    assert "contains = array2d(1..0, 1..0, []);" in text
    assert "edge_gap = array2d(1..0, 1..4, []);" in text


def test_a_nest_too_large_for_square_arrays_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(export, "CONTOURS_MAX", 2)
    with pytest.raises(InputError, match=r"3 contours are too many.*\.json"):
        small_dzn()
