"""How a skeleton is cut up is seen from kerfs alone: pieces no larger than asked for, and the remnant saved."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise.encoder.cut import Side
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check.loose_metal import wrong_pieces
from kerfwise.postproc.check.plan_runs import runs_from_cuts
from kerfwise.postproc.check.torch_run import SENTENCES
from kerfwise.rules.case import in_order, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.sections import Cuts, Scrap
from kerfwise.tests.commands.run_cli import kerfwise

A = part("A", rect(50, 50, 300, 300))
ACROSS = [(500.0, 0.0), (500.0, 400.0)]


def wrong(sheet: Nest, grid_mm: float | None = None, remnant: Side | None = None, order: str = "") -> list[str]:
    profile = replace(load_profile(), cuts=Cuts(scrap=Scrap(grid_mm, remnant)))
    cuts = in_order(sheet, order or " ".join(c.id for c in sheet.contours))
    runs = runs_from_cuts(sheet, cuts, profile.material.kerf_mm)[0]
    return [v.text for v in wrong_pieces(sheet, runs, (), profile)]


def test_pieces_as_large_as_the_grid_pass() -> None:
    assert wrong(nest(1000, 400, A, scrap=[ACROSS]), 500.0) == []


def test_larger_ones_are_named_with_size_and_place() -> None:
    first, second = wrong(nest(1000, 400, A, scrap=[ACROSS]), 450.0)
    assert {first.split(" is left")[0], second.split(" is left")[0]} == {"a piece of the skeleton of 499 × 400 mm"}
    assert first.endswith("more than 450 mm (cuts.scrap.grid)")


def test_a_line_that_is_not_cut_leaves_one() -> None:
    sheet = nest(1000, 400, A, scrap=[ACROSS])
    (text,) = wrong(sheet, 500.0, order="A.outer")
    assert text.startswith("a piece of the skeleton of 1000 × 400 mm is left")


def test_a_line_that_ends_too_soon_leaves_one() -> None:
    (text,) = wrong(nest(1000, 400, A, scrap=[[(500, 0), (500, 390)]]), 500.0)
    assert text.startswith("a piece of the skeleton of 1000 × 400 mm is left")


def test_what_parts_alone_cut_off_is_not_looked_at() -> None:
    """A part from edge to edge divides the skeleton: the smaller side has no lines, and nobody says that it has."""
    wall = part("W", rect(750, 0, 20, 400))
    assert wrong(nest(1200, 400, A, wall, scrap=[[(400, 0), (400, 400)]]), 410.0) == []
    said = SENTENCES["scrap-pieces"]
    assert said.startswith("The skeleton's largest piece is cut into pieces no larger than asked for")


def test_the_remnant_may_be_larger_than_the_grid() -> None:
    sheet = nest(1000, 400, A, scrap=[[(399, 0), (399, 400)]])
    assert wrong(sheet, 400.0, "right") == []
    assert len(wrong(sheet, 400.0)) == 1


def test_a_remnant_that_is_no_rectangle_is_not_saved() -> None:
    slanted = nest(1000, 400, A, scrap=[[(399, 0), (460, 400)]])
    assert wrong(slanted, remnant="right") == [
        "no rectangle with sides of 50 mm or more is saved along the right side (cuts.scrap.remnant)"
    ]
    assert wrong(nest(1000, 400, A, scrap=[[(399, 0), (399, 400)]]), remnant="left") != []


def test_nothing_is_asked_where_the_profile_asks_for_nothing() -> None:
    assert wrong(nest(1000, 400, A)) == []


@pytest.mark.slow
def test_the_planner_s_own_pass(tmp_path: Path) -> None:
    root = Path(__file__).parents[3]
    files = [str(root / "docs" / "scrap.nest.json"), "-p", str(root / "examples" / "profiles" / "scrap-grid.yaml")]
    ran = kerfwise("solve", *files, "--work", "0.3", "-o", str(tmp_path / "out.nc"))
    assert ran.code == 0
    assert any(line.split()[:3] == ["holds", "hard", "scrap-pieces"] for line in ran.out.splitlines())
