"""Zones that have a budget of heat."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.facts import FactOptions, Facts, compute_facts
from kerfwise.encoder.facts.facts import SIDES
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.encoder.facts.random_nests import nests
from kerfwise.tests.tools.amount import examples

CROSSED: dict[str, object] = {"zone_pairs": (("c.outer", "a.outer"), ("a.outer", "c.outer"))}
"""Orders of a and c that contradict each other."""


def row(names: str) -> Nest:
    """Plates of 80 × 80 every 100 mm, from the left."""
    plates = (part(name, rect(10 + 100 * k, 10, 80, 80)) for k, name in enumerate(names))
    return nest(100 * len(names), 100, *plates)


def facts(given_nest: Nest, kj: float | Mapping[str, float], **options: object) -> Facts:
    """Of a nest whose contours leave so many kJ each, or those of a part."""
    heat_kj = [0.0 if c.kind == "mark" else kj[c.part] if isinstance(kj, Mapping) else kj for c in given_nest.contours]
    thresholds = FactOptions(**{"start_side": "left", **options})  # type: ignore[arg-type]
    return compute_facts(given_nest, thresholds, (), np.array(heat_kj))


def zones(given_nest: Nest, kj: float | Mapping[str, float], **options: object) -> str:
    """The parts of each zone in the order of the nest, zones with a stroke between."""
    found = facts(given_nest, kj, **options)
    parts = [p.id for p in given_nest.parts]
    of = [int(found.zone[given_nest.index[p.outer.id]]) for p in given_nest.parts]
    return "|".join("".join(p for p, z in zip(parts, of, strict=True) if z == k) for k in range(1, max(of) + 1))


@pytest.mark.parametrize(
    ("budget_kj", "found"),
    [
        (None, "abcdef"),
        (60.0, "abcdef"),
        (59.9, "abcde|f"),
        (30.0, "abc|def"),
        (29.9, "ab|cd|ef"),
        (10.0, "a|b|c|d|e|f"),
        (1.0, "a|b|c|d|e|f"),
    ],
)
def test_a_zone_ends_before_its_heat_passes_the_budget(budget_kj: float | None, found: str) -> None:
    assert zones(row("abcdef"), 10.0, zone_heat_kj=budget_kj) == found


def test_the_number_of_contours_still_counts() -> None:
    assert zones(row("abcdef"), 10.0, zone_contours=2, zone_heat_kj=30.0) == "ab|cd|ef"
    assert zones(row("abcdef"), 10.0, zone_contours=2, zone_heat_kj=10.0) == "a|b|c|d|e|f"


def test_what_passes_the_budget_alone_has_a_zone_of_its_own() -> None:
    kj = {"a": 10.0, "b": 10.0, "c": 90.0, "d": 10.0, "e": 10.0}
    assert zones(row("abcde"), kj, zone_heat_kj=50.0) == "ab|c|de"
    assert facts(row("abcde"), kj, zone_heat_kj=50.0).zone_heat_kj.tolist() == [20.0, 90.0, 20.0]


def test_a_host_is_not_divided_from_what_it_contains() -> None:
    guests = [part(f"g{k}", rect(130 + 60 * k, 40, 50, 50)) for k in range(4)]
    host = part("H", rect(100, 10, 300, 280), [rect(120, 30, 260, 240)])
    plates = part("b", rect(10, 10, 80, 280)), part("d", rect(410, 10, 80, 280))
    found = facts(nest(500, 300, plates[0], host, *guests, plates[1]), 10.0, zone_heat_kj=25.0)
    assert found.zone_heat_kj.tolist() == [10.0, 60.0, 10.0]


def test_marks_are_no_heat() -> None:
    marked = nest(
        200, 100, part("a", rect(10, 10, 80, 80), marks=[[(20, 20), (40, 20)]]), part("b", rect(110, 10, 80, 80))
    )
    assert zones(marked, 10.0, zone_heat_kj=20.0) == "ab"


def test_a_column_stays_whole_where_the_budget_has_room_for_it() -> None:
    plates = (part(f"{c}{r}", rect(10 + 100 * c, 10 + 100 * r, 80, 80)) for c in range(4) for r in range(4))
    assert zones(nest(400, 400, *plates), 10.0, zone_heat_kj=50.0, square_ratio=9.0).split("|")[0] == "00010203"


def test_what_orders_raise_is_divided_again() -> None:
    """The first waits for the last: all would share its zone, but that has room for two."""
    raised: dict[str, object] = {"zone_pairs": (("e.outer", "a.outer"), ("e.outer", "b.outer")), "zone_contours": 2}
    kept: dict[str, object] = {**raised, "zone_respects": frozenset({"contains"})}
    assert zones(row("abcdef"), 10.0, **kept) == "cd|abef"
    assert zones(row("abcdef"), 10.0, **kept, zone_heat_kj=20.0) == "cd|ae|bf"
    assert zones(row("abcdef"), 10.0, **kept, zone_heat_kj=30.0) == "cd|abe|f"


def test_parts_whose_orders_go_round_in_a_circle_stay_together_where_there_is_room() -> None:
    free: dict[str, object] = {**CROSSED, "zone_contours": 1, "zone_respects": frozenset({"contains"})}
    assert zones(row("abcd"), 10.0, **free) == "b|ac|d"
    assert zones(row("abcd"), 10.0, **free, zone_heat_kj=20.0) == "b|ac|d"
    assert zones(row("abcd"), 10.0, **free, zone_heat_kj=19.0) == "b|a|c|d"
    locked: dict[str, object] = {**free, "zone_fixed": (("d", 4),)}
    assert zones(row("abcd"), 10.0, **locked, zone_heat_kj=19.0) == "b|a|c|d"


def test_a_circle_stays_together_in_a_zone_that_is_divided() -> None:
    circle = (("d.outer", "a.outer"), ("a.outer", "d.outer"))
    free: dict[str, object] = {"zone_pairs": circle, "zone_contours": 2, "zone_respects": frozenset({"contains"})}
    assert zones(row("abcd"), 10.0, **free) == "b|acd"
    assert zones(row("abcd"), 10.0, **free, zone_heat_kj=20.0) == "b|ad|c"


def test_locked_zones_stand_whatever_heat_that_brings_together() -> None:
    found = facts(
        row("abcd"), 10.0, zone_heat_kj=10.0, zone_respects=frozenset({"contains"}), zone_fixed=(("d", 1), ("b", 1))
    )
    assert found.zone.tolist() == [1, 1, 2, 1]
    assert found.zone_heat_kj.tolist() == [30.0, 10.0]


def test_a_budget_needs_the_heat_of_the_contours() -> None:
    with pytest.raises(ValueError, match="the heat of the contours is not given"):
        compute_facts(row("ab"), FactOptions(zone_heat_kj=10.0))
    assert np.isnan(compute_facts(row("ab"), FactOptions()).zone_heat_kj).all()


@given(given_nest=nests(), side=st.sampled_from(SIDES), size=st.integers(1, 6), data=st.data())
@examples(60)
def test_only_a_part_alone_passes_the_budget(given_nest: Nest, side: str, size: int, data: st.DataObject) -> None:
    kj = {p.id: data.draw(st.floats(0.5, 40)) for p in given_nest.parts}
    budget_kj = data.draw(st.floats(1, 100))
    found = facts(given_nest, kj, start_side=side, zone_contours=size, zone_heat_kj=budget_kj)
    zone = found.zone.tolist()
    assert sorted(set(zone)) == list(range(1, max(zone, default=0) + 1))
    straight = [k for k, c in enumerate(given_nest.contours) if c.kind == "outer" and found.parent[k] < 0]
    for number, heat_kj in enumerate(found.zone_heat_kj.tolist() if zone else [], 1):
        assert heat_kj <= budget_kj * (1 + 1e-6) or sum(zone[k] == number for k in straight) == 1
    cyclic = _on_a_circle(found)
    pairs = [*found.contains[:, ::-1].tolist(), *found.level_ahead.tolist(), *found.in_hull.tolist()]
    assert all(zone[a] <= zone[b] for a, b in pairs if not (a in cyclic and b in cyclic))
    for p in given_nest.parts:
        assert len({zone[given_nest.index[c.id]] for c in p}) == 1


def _on_a_circle(found: Facts) -> set[int]:
    """Contours that some order of whole parts leads back to."""
    of = found.parent.copy()
    top = np.where(of < 0, np.arange(found.n), of)
    while not np.array_equal(top[top], top):
        top = top[top]
    reach = np.eye(found.n, dtype=bool)
    for pairs in (found.level_ahead, found.in_hull):
        reach[top[pairs[:, 0]], top[pairs[:, 1]]] = True
    for k in range(found.n):
        reach |= reach[:, [k]] & reach[[k], :]
    back = (reach & reach.T).sum(axis=1) > 1
    return set(np.flatnonzero(back[top]).tolist())
