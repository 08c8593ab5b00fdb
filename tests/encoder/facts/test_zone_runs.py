"""Zones along an order: whole blocks, no pair backwards, and none where the order does not do what zones do."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kerfwise.encoder.facts import FactOptions, Facts, compute_facts, zones, zones_along_route
from kerfwise.encoder.facts.zones_along_route import movable, zones_along
from kerfwise.rules.case import nest, part, rect


@pytest.fixture(autouse=True)
def _small_zones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(zones, "MOST_OF_ONE", 40)


def grid(columns: int, rows: int, **options: object) -> Facts:
    """Plates of 80 × 80 every 100 mm, the first with a hole."""
    places = [(c, r) for c in range(columns) for r in range(rows)]
    first, *others = (part(f"{c}{r}", rect(10 + 100 * c, 10 + 100 * r, 80, 80)) for c, r in places)
    holed = part("00", rect(10, 10, 80, 80), [rect(40, 40, 20, 20)])
    assert first.id == holed.id
    return compute_facts(nest(100 * columns, 100 * rows, holed, *others), FactOptions(**options))  # type: ignore[arg-type]


def to_and_fro(facts: Facts, rows: int) -> list[int]:
    """Column after column, up one and down the next; a hole before its part."""
    middle = [c.polygon.centroid for c in facts.nest.contours]
    places = {k: (round(m.x - 50) // 100, round(m.y - 50) // 100) for k, m in enumerate(middle)}

    def turn(k: int) -> tuple[int, int, int]:
        column, row = places[k]
        return column, row if column % 2 == 0 else rows - row, int(facts.nest.contours[k].kind == "outer")

    return sorted(places, key=turn)


def test_runs_of_an_order_are_zones() -> None:
    facts = grid(12, 3)
    order = to_and_fro(facts, 3)
    several = list(zones_along(facts, order))
    assert several
    hole = next(k for k, c in enumerate(facts.nest.contours) if c.kind == "hole")
    for found in several:
        assert found.max() > 2
        assert (np.diff(found[order]) >= 0).all()
        for before, after in facts.level_ahead.tolist():
            assert found[before] <= found[after]
        assert found[hole] == found[facts.nest.index["00.outer"]]
    assert np.diff([found.max() for found in several]).min(initial=0) >= 0  # the fewest first
    assert len(np.unique(several, axis=0)) == len(several)


def test_large_zones_come_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Then come smaller ones: where large ones do not do what zones are for, or are not proven, these may."""
    monkeypatch.setattr(zones, "MOST_OF_ONE", 1_000_000)
    facts = grid(12, 3, square_ratio=10.0)
    order = to_and_fro(facts, 3)
    by_size = {}
    for sizes in ((18,), (9,), (18, 9)):
        monkeypatch.setattr(zones_along_route, "MOST_CONTOURS", sizes)
        by_size[sizes] = [found.tolist() for found in zones_along(facts, order)]
    large, small = by_size[18,], by_size[9,]
    assert large
    assert small
    assert max(map(max, large)) < max(map(max, small))
    assert by_size[18, 9] == [*large, *(zone for zone in small if zone not in large)]


def test_an_order_that_leaves_the_start_side_to_the_end_makes_none() -> None:
    facts = grid(12, 3, zone_respects=frozenset({"contains"}))
    order = to_and_fro(facts, 3)
    far_first = [k for k in reversed(order) if facts.nest.contours[k].part != "00"]
    hosts = [k for k in order if facts.nest.contours[k].part == "00"]
    assert not list(zones_along(facts, [*far_first, *hosts]))


def test_an_order_that_goes_from_end_to_end_makes_none() -> None:
    facts = grid(12, 3, zone_respects=frozenset({"contains"}))
    order = to_and_fro(facts, 3)
    half = len(order) // 2
    mixed = [k for pair in zip(order[:half], reversed(order[half:]), strict=False) for k in pair]
    left = [k for k in order if k not in mixed]
    assert not list(zones_along(facts, [*mixed, *left]))


@pytest.mark.parametrize(
    "decided",
    [{"zone_contours": 4}, {"zone_fixed": (("00", 1),)}, {"zone_heat_kj": 1e9}],
)
def test_zones_that_the_plant_decides_on_do_not_move(decided: dict[str, object]) -> None:
    facts = grid(4, 2)
    assert movable(facts)
    assert movable(replace(facts, options=replace(facts.options, zone_places=(("00", 1),))))  # the route keeps it
    assert not movable(replace(facts, options=replace(facts.options, **decided)))  # type: ignore[arg-type]


def test_parts_that_an_order_goes_to_and_fro_between_are_in_several_zones() -> None:
    """Each part has a hole, and all holes of a column are cut before its first part: the column is one long run."""
    columns, rows = 8, 6
    places = [(c, r) for c in range(columns) for r in range(rows)]
    holed = (
        part(f"{c}{r}", rect(10 + 100 * c, 10 + 100 * r, 80, 80), [rect(40 + 100 * c, 40 + 100 * r, 20, 20)])
        for c, r in places
    )
    options = FactOptions(zone_respects=frozenset({"contains"}), parts_in_one_go=False, square_ratio=10.0)
    facts = compute_facts(nest(100 * columns, 100 * rows, *holed), options)
    index = facts.nest.index
    order = [
        k for c in range(columns) for what in ("hole1", "outer") for k in (index[f"{c}{r}.{what}"] for r in range(rows))
    ]
    several = list(zones_along(facts, order))
    assert several
    for found in several:
        assert all(found[index[f"{c}{r}.hole1"]] == found[index[f"{c}{r}.outer"]] for c, r in places)
        column = [{int(found[index[f"{c}{r}.outer"]]) for r in range(rows)} for c in range(columns)]
        assert max(map(len, column)) > 1, "a column has too many sets for one zone"
        assert all(max(one) <= min(next_) for one, next_ in pairwise(column))


def test_marks_do_not_keep_zones_from_being_runs() -> None:
    """All marks are made before anything is cut; they are in the zone of their part."""
    places = [(c, r) for c in range(12) for r in range(3)]
    corners = {f"{c}{r}": (10 + 100 * c, 10 + 100 * r) for c, r in places}
    plates = (
        part(name, rect(x, y, 80, 80), marks=[[(x + 10, y + 10), (x + 50, y + 10)]]) for name, (x, y) in corners.items()
    )
    facts = compute_facts(nest(1200, 300, *plates), FactOptions(square_ratio=10.0))
    contours, index = facts.nest.contours, facts.nest.index
    marks = [k for k, c in enumerate(contours) if c.kind == "mark"]
    several = list(zones_along(facts, [*marks, *(index[f"{name}.outer"] for name in corners)]))
    assert several
    for found in several:
        assert found.max() > 2
        assert all(found[k] == found[index[f"{contours[k].part}.outer"]] for k in marks)


def test_what_is_left_is_square_up_to_the_ratio_of_the_rule() -> None:
    """An order that goes around what is left leaves it less square than strips do, and square enough by the option."""
    facts = grid(6, 6)
    order = to_and_fro(facts, 6)
    strict = replace(facts, options=replace(facts.options, square_ratio=1.0))
    lenient = replace(facts, options=replace(facts.options, square_ratio=100.0))
    assert len(list(zones_along(strict, order))) <= len(list(zones_along(lenient, order)))
    far = replace(facts, zone=_in_squares(facts))
    assert not list(zones_along(replace(far, options=strict.options), order))
    assert list(zones_along(replace(far, options=lenient.options), order))


def _in_squares(facts: Facts) -> np.ndarray:
    """Zones of rings around a square that shrinks from two sides: what is left is a square after every one."""
    middle = [c.polygon.centroid for c in facts.nest.contours]
    return np.array([1 + min(round(m.x - 50) // 100, round(m.y - 50) // 100) for m in middle])


@pytest.mark.parametrize(("most", "beside"), [(10_000, False), (0, True)])
def test_in_a_large_nest_a_part_that_is_gone_back_to_lies_where_it_is_cut_last(
    most: int, beside: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its hole is cut first of all, and the part with the sixth column: half-way there is nothing of it."""
    monkeypatch.setattr(zones_along_route, "MIDDLES", most)
    monkeypatch.setattr(zones_along_route, "LESS_TOGETHER", 100.0)
    facts = grid(12, 3, zone_respects=frozenset({"contains"}), square_ratio=10.0)
    outer = facts.nest.index["00.outer"]
    order = [k for k in to_and_fro(facts, 3) if k != outer]
    order.insert(order.index(facts.nest.index["50.outer"]), outer)
    found = next(zones_along(facts, order))
    assert (found[outer] == found[facts.nest.index["50.outer"]]) == beside
    if not beside:
        assert found[outer] < found[facts.nest.index["50.outer"]]
