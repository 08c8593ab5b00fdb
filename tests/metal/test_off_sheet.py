"""A torch that leaves the sheet: planner, check and simulation draw one line."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.encoder.candidates import LeadOptions, build_candidates
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check import check_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.metal.hand_made import KERF_MM, Blocks, around, program
from kerfwise.tests.metal.simulate import by_kind, simulate
from kerfwise.tests.postproc.plans import profile

PLANT = profile(material=replace(profile().material, kerf_mm=KERF_MM))
FROM_EDGE = replace(
    PLANT,
    leads=replace(PLANT.leads, edge_start=True),
    machine=replace(PLANT.machine, travel_x_mm=(-20.0, 3000.0), travel_y_mm=(-20.0, 1500.0)),
)
CORNER = [(20, 20), (70, 20), (20, 70)]
"""A triangle; the mended drawing of the tutorial was flush with such a corner."""


def refused(drawn: Nest, **leads: object) -> str:
    """What the planner says of a nest that it refuses; nothing where it plans it."""
    try:
        build_candidates(drawn, LeadOptions(kerf_mm=KERF_MM, **leads))  # type: ignore[arg-type]
    except InputError as error:
        return "\n".join(error.details)
    return ""


def on_sheet(drawn: Nest, blocks: Blocks, plant: Profile = PLANT) -> tuple[bool, bool]:
    """Whether the check and the simulation let the path round A pass."""
    text = program([("A.outer", blocks)])
    found = simulate(drawn, text, KERF_MM, edge_starts=plant.leads.edge_start)
    return check_program(drawn, text, plant).rule("on-sheet").holds, "off-sheet" not in by_kind(found)


@pytest.mark.parametrize("gap_mm", [0.0, 0.5, 0.9, 0.94, 0.97, 1.0, 1.02, 1.5, 3.0])
def test_one_line_for_all_gaps_to_the_edge(gap_mm: float) -> None:
    """Half a kerf is 1 mm: the check measures by 0.05 mm as of every path, and nothing is planned within 0.01 mm."""
    drawn = nest(70 + gap_mm, 100, part("A", rect(20, 20, 50, 50)))
    said = refused(drawn)
    assert on_sheet(drawn, around(20, 20, 50, 50, (14, 45))) == (gap_mm > 0.95, gap_mm >= 1)
    assert bool(said) is (gap_mm < 1.01)
    if gap_mm < 1:
        assert f"A.outer: the torch's path runs {1 - gap_mm:.3f} mm off the sheet at ({71:.3f}, " in said
    elif said:
        assert "A.outer: the torch's path runs along the edge of the sheet at (71.000, " in said


def test_a_corner_flush_with_the_edge_is_refused() -> None:
    flush = nest(70, 100, part("A", CORNER))
    assert "A.outer: the torch's path runs 1." in refused(flush)
    assert refused(nest(74, 100, part("A", CORNER))) == ""


@pytest.mark.parametrize("gap_mm", [0.5, 4.0])
def test_where_edge_starts_are_the_run_up_alone_may_be_off_the_sheet(gap_mm: float) -> None:
    """Not so the path round the part, however near it is to the run-up."""
    drawn = nest(200, 100, part("A", rect(gap_mm, 20, 50, 50)))
    held = gap_mm > 1
    path = around(gap_mm, 20, 50, 50, (-3, 45))
    assert on_sheet(drawn, path, FROM_EDGE) == (held, held)
    assert on_sheet(drawn, path) == (False, False)
    assert (refused(drawn, edge_start=True, reach=(-20.0, -20.0, 300.0, 300.0)) == "") is held


def test_what_a_run_up_may_be_is_as_long_as_a_lead() -> None:
    drawn = nest(200, 100, part("A", rect(4, 20, 50, 50)))
    longest_mm = KERF_MM + FROM_EDGE.length_mm(FROM_EDGE.leads.lead_in_mm)
    for off_mm, holds in ((longest_mm - 0.1, True), (longest_mm + 0.1, False)):
        text = program([("A.outer", around(4, 20, 50, 50, (-off_mm, 45)))])
        assert check_program(drawn, text, FROM_EDGE).rule("on-sheet").holds is holds


def test_paths_off_a_hole_of_the_sheet_and_marks_are_told() -> None:
    """A remnant with a hole; a mark that runs off its part and the sheet."""
    drawn = nest(
        200, 100, part("A", rect(20, 20, 50, 50)), part("B", rect(130, 20, 50, 50), marks=[[(150, 30), (210, 30)]])
    )
    holed = replace(drawn, sheet=replace(drawn.sheet, holes=(part("H", rect(70.5, 30, 20, 20)).outer.curve,)))
    said = refused(holed).split("\n")
    assert said[0].startswith("A.outer: the torch's path runs 0.500 mm off the sheet at (71.000, 3")
    assert said[1] == "B.mark1 runs 10.000 mm off the sheet at (210.000, 30.000): move the mark or give a larger sheet"
