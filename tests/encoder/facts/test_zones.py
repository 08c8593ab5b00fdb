from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.cut import Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts import FactOptions, Facts, compute_facts
from kerfwise.encoder.facts.facts import SIDES
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest, Part
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.encoder.facts.random_nests import nests
from kerfwise.tests.tools.amount import examples


def grid(columns: int, rows: int) -> Nest:
    """Plates of 80 × 80 every 100 mm, named by column and row."""
    parts = (part(f"{c}{r}", rect(10 + 100 * c, 10 + 100 * r, 80, 80)) for c in range(columns) for r in range(rows))
    return nest(100 * columns, 100 * rows, *parts)


def zones(given_nest: Nest, side: Side = "left", **options: object) -> dict[str, int]:
    """Part → zone."""
    facts = compute_facts(given_nest, FactOptions(start_side=side, **options))  # type: ignore[arg-type]
    return {c.part: int(z) for c, z in zip(given_nest.contours, facts.zone, strict=True) if c.kind == "outer"}


def in_zone(found: dict[str, int], zone: int) -> set[str]:
    return {p for p, z in found.items() if z == zone}


def respected(facts: Facts) -> list[list[int]]:
    """All (before, after) pairs of the three order facts."""
    return [*facts.contains[:, ::-1].tolist(), *facts.level_ahead.tolist(), *facts.in_hull.tolist()]


@pytest.mark.parametrize(("side", "first"), [("left", "0"), ("right", "7")])
def test_a_long_sheet_is_cut_in_strips_from_the_start_side(side: Side, first: str) -> None:
    found = zones(grid(8, 2), side, zone_contours=2)
    assert in_zone(found, 1) == {first + "0", first + "1"}
    assert [found[f"{c}0"] for c in range(8)] == (
        [1, 2, 3, 4, 5, 6, 7, 8] if side == "left" else [8, 7, 6, 5, 4, 3, 2, 1]
    )


def test_zones_follow_locked_positions() -> None:
    first = zones(grid(6, 2), zone_contours=2, zone_places=(("50", 1),))
    assert (first["50"], first["51"], first["40"]) == (1, 6, 5)
    assert zones(grid(6, 2), zone_contours=2, zone_places=(("00", 12),))["00"] == 6
    assert zones(grid(6, 2), zone_contours=2, zone_places=(("50", 4),))["50"] == 2
    assert zones(grid(6, 2), zone_contours=2, zone_places=(("20", 5),)) == zones(grid(6, 2), zone_contours=2)


def test_marks_do_not_count() -> None:
    plain = grid(8, 2)
    marked = Nest(plain.sheet, tuple(replace(p, marks=_three_marks(p)) for p in plain.parts))
    assert zones(marked, zone_contours=4) == zones(plain, zone_contours=4)
    assert max(zones(marked, zone_contours=4).values()) == 4


def _three_marks(given_part: Part) -> tuple[Contour, ...]:
    (x, y), name = given_part.outer.curve.point_at(0.0), given_part.id
    lines = [Curve.of([(x + 10 * k, y + 10), (x + 10 * k, y + 20)], closed=False) for k in (1, 2, 3)]
    return tuple(Contour(f"{name}.mark{k}", name, "mark", line) for k, line in enumerate(lines, 1))


SQUARE_REST: dict[str, object] = {"zone_contours": 4, "square_ratio": 1.4, "zone_respects": frozenset({"contains"})}
"""Of 4 × 4 plates the first column goes first; the rest is 280 × 380 and made most square by taking a row."""


def test_a_square_rest_is_kept_square() -> None:
    found = zones(grid(4, 4), **SQUARE_REST)
    assert in_zone(found, 1) == {"00", "01", "02", "03"}
    assert in_zone(found, 2) == {"10", "20", "30"}
    long_rest = zones(grid(4, 4), **{**SQUARE_REST, "square_ratio": 1.35})
    assert in_zone(long_rest, 2) == {"10", "11", "12", "13"}


@pytest.mark.parametrize(
    ("waiting", "second"),
    [
        ([("11", "30")], {"13", "23", "33"}),
        ([("11", "30"), ("12", "33")], {"10", "11", "12", "13"}),
        ([("00", "30")], {"10", "20", "30"}),
        ([("10", "30")], {"10", "20", "30"}),
    ],
    ids=["not the lowest row", "neither row", "not for one already cut", "not for one in the row"],
)
def test_a_row_is_taken_only_where_no_part_of_it_must_wait(waiting: list[tuple[str, str]], second: set[str]) -> None:
    pairs = tuple((f"{a}.outer", f"{b}.outer") for a, b in waiting)
    assert in_zone(zones(grid(4, 4), zone_pairs=pairs, **SQUARE_REST), 2) == second


def test_a_zone_ends_between_columns_where_that_is_near_enough() -> None:
    found = zones(grid(8, 5), zone_contours=6)
    assert in_zone(found, 1) == {"00", "01", "02", "03", "04"}


def test_without_a_number_zones_follow_each_other_to_and_fro_in_pieces_of_wide_strips() -> None:
    sheet = grid(24, 12)
    found = compute_facts(sheet, FactOptions(zone_respects=frozenset({"contains"})), ())
    zone = found.zone
    middle = np.array([[*p.outer.polygon.centroid.coords[0]] for p in sheet.parts])
    middles = np.array([middle[zone == z].mean(axis=0) for z in range(1, zone.max() + 1)])
    apart = np.hypot(*np.diff(middles, axis=0).T)
    span = middle.max(axis=0) - middle.min(axis=0)
    assert zone.max() > 8
    assert apart.max() < span[1] / 2
    assert all(np.ptp(middle[zone == z], axis=0).max() < span[1] for z in range(1, zone.max() + 1))


def test_zones_are_about_as_large_as_asked_and_none_is_left_over_small() -> None:
    found = zones(grid(9, 3), zone_contours=6)
    sizes = [len(in_zone(found, z)) for z in range(1, max(found.values()) + 1)]
    assert sum(sizes) == 27
    assert all(3 <= size <= 9 for size in sizes)
    assert set(zones(grid(5, 2), zone_contours=12).values()) == {1}


def test_a_host_and_what_it_contains_share_a_zone() -> None:
    host = part("H", rect(400, 10, 300, 280), [rect(420, 30, 260, 240)])
    guests = [part(f"g{k}", rect(430 + 60 * k, 40, 50, 50)) for k in range(4)]
    before = [part(f"b{k}", rect(10, 10 + 90 * k, 300, 80)) for k in range(3)]
    found = zones(nest(1000, 300, *before, host, *guests), zone_contours=3)
    assert {found["H"]} == {found[f"g{k}"] for k in range(4)} == {2}


def test_a_long_part_is_raised_to_the_zone_of_what_lies_ahead_of_its_far_end() -> None:
    short = [part(f"s{k}", rect(10 + 100 * k, 110, 80, 80)) for k in range(6)]
    long = part("L", [(10, 10), (590, 10), (590, 190), (595, 190), (595, 5), (10, 5)])
    given_nest = nest(600, 200, *short, long)
    assert zones(given_nest, zone_contours=2)["L"] == max(zones(given_nest, zone_contours=2).values())
    assert zones(given_nest, zone_contours=2, zone_respects=frozenset({"contains"}))["L"] == 3


def test_pairs_of_contours_may_be_added() -> None:
    plain = zones(grid(6, 1), zone_contours=1)
    raised = zones(grid(6, 1), zone_contours=1, zone_pairs=(("20.outer", "00.outer"),))
    assert (plain["00"], plain["20"]) == (1, 3)
    # The first part waits for the third and the second for the first: two zones are empty and closed up.
    assert list(raised.values()) == [1, 1, 1, 2, 3, 4]


def test_a_part_fixed_in_a_zone_takes_along_what_must_precede_it() -> None:
    free = zones(grid(6, 2), zone_contours=2)
    assert free["30"] == 4
    found = zones(grid(6, 2), zone_contours=2, zone_fixed=(("30", 2),))
    assert found["30"] == 2
    assert [found[p] for p in ("00", "10", "20")] == [1, 2, 2]  # its row, brought forward
    assert [found[p] for p in ("01", "11", "21", "31")] == [1, 2, 3, 4]  # the other row is free
    late = zones(grid(6, 2), zone_contours=2, zone_fixed=(("20", 5),))
    assert [late[p] for p in ("10", "20", "30", "40", "50")] == [2, 5, 5, 5, 6]


def test_a_zone_beyond_the_last_is_the_last() -> None:
    found = zones(grid(3, 1), zone_contours=1, zone_fixed=(("10", 99),))
    assert found == {"00": 1, "10": 2, "20": 2}


def test_fixed_zones_stand_even_against_the_order() -> None:
    found = zones(grid(3, 1), zone_contours=1, zone_fixed=(("00", 3), ("20", 1)))
    assert found["00"] > found["20"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"zone_pairs": (("00.outer", "nobody.outer"),)}, "contour 'nobody.outer'"),
        ({"zone_fixed": (("nobody", 1),)}, "part 'nobody'"),
        ({"zone_fixed": (("00", 0),)}, "zones count from 1"),
        ({"zone_fixed": (("00", 1), ("00", 2))}, "give them one zone"),
    ],
)
def test_unusable_options_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        zones(grid(2, 1), **options)


def test_no_parts_no_zones() -> None:
    assert compute_facts(nest(100, 100), FactOptions()).zone.tolist() == []


@given(given_nest=nests(), side=st.sampled_from(SIDES), size=st.integers(1, 6))
@examples(60)
def test_zones_are_a_partition_that_no_pair_contradicts(given_nest: Nest, side: Side, size: int) -> None:
    facts = compute_facts(given_nest, FactOptions(start_side=side, zone_contours=size))
    zone = facts.zone.tolist()
    assert sorted(set(zone)) == list(range(1, max(zone, default=0) + 1))
    assert all(zone[before] <= zone[after] for before, after in respected(facts))
    for p in given_nest.parts:
        assert len({zone[given_nest.index[c.id]] for c in p}) == 1


@given(given_nest=nests(), data=st.data())
@examples(40)
def test_one_fixed_part_is_honoured_and_contradicts_no_pair(given_nest: Nest, data: st.DataObject) -> None:
    roots = [p for p in given_nest.parts if not p.id.endswith("g")]
    if not roots:
        return
    chosen: Part = data.draw(st.sampled_from(roots))
    free = compute_facts(given_nest, FactOptions(zone_contours=2))
    number = data.draw(st.integers(1, int(free.zone.max())))
    facts = compute_facts(given_nest, FactOptions(zone_contours=2, zone_fixed=((chosen.id, number),)))
    zone = facts.zone.tolist()
    assert all(zone[before] <= zone[after] for before, after in respected(facts))
    assert zone[given_nest.index[chosen.outer.id]] <= number
    assert sorted(set(zone)) == list(range(1, max(zone) + 1))
