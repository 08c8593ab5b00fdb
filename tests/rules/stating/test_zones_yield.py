"""Zones yield to hard sums of every form: about one contour, about several, with entries, and sums within sums."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kerfwise.encoder.facts.facts import Facts
from kerfwise.jobs.request import facts_of
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import About, AtLeast, Before, Enough, Pick, Precede, Statement, Steps
from kerfwise.rules.stating.zones_yield import zones_that_yield

ROW = nest(1000, 120, *(part(f"P{k}", rect(10 + 120 * k, 10, 100, 100)) for k in range(8)))
ABOUT, ZONED = About("own:sum", (), "so much of it"), About("zone-order", (), "zone by zone")


@pytest.fixture(scope="module")
def facts() -> Facts:
    """Eight parts in a row in four zones of two."""
    return replace(facts_of(ROW, load_profile()), zone=np.array([1, 1, 2, 2, 3, 3, 4, 4]))


def zones(facts: Facts, *asked: Statement) -> list[int] | None:
    """What the zones become under some statements, beside the orders of the zones themselves."""
    zone = facts.zone
    by_zone = [Precede(i, j, ZONED) for i in range(8) for j in range(8) if zone[i] < zone[j]]
    found = zones_that_yield(facts, [*by_zone, *asked], frozenset({"zone-order"}))
    return None if found is None else found.tolist()


LAST = Before(7, 0)
SUMS = {
    "either of two orders": AtLeast((Before(6, 0), Before(7, 1)), (1, 1), 1, ABOUT),
    "both of two orders": AtLeast((Before(6, 0), Before(7, 1)), (1, 1), 2, ABOUT),
    "several contours": AtLeast((Before(4, 2), Before(5, 3), Before(6, 1), Before(0, 7)), (5, 5, 5, 1), 11, ABOUT),
    "orders that count against it": AtLeast((Before(0, 6), Before(1, 7), Before(2, 5)), (-1, -1, -1), -1, ABOUT),
    "a sum within a sum": AtLeast((Enough((LAST, Before(6, 1)), (1, 1), 2), Before(5, 2)), (3, 1), 4, ABOUT),
    "an entry beside an order": AtLeast((Pick(0), Before(6, 1)), (1, 2), 2, ABOUT),
    "three orders of one": AtLeast((Before(7, 0), Before(7, 2), Before(7, 4)), (1, 1, 1), 3, ABOUT),
}


@pytest.mark.parametrize("name", SUMS)
def test_zones_yield_to_every_form_of_sum(name: str, facts: Facts) -> None:
    asked = SUMS[name]
    changed = zones(facts, asked)
    assert changed is not None
    assert sum(a != b for a, b in zip(changed, facts.zone.tolist(), strict=True)) <= 4

    def most(s: AtLeast | Enough) -> int:
        total = 0
        for x, weight in zip(s.literals, s.weights, strict=True):
            if isinstance(x, Before):
                can_be = changed[x.i] <= changed[x.j] if weight > 0 else changed[x.i] < changed[x.j]
            else:
                can_be = weight > 0 and (isinstance(x, Pick) or most(x) >= x.bound)
            total += weight * can_be
        return total

    assert most(asked) >= asked.bound


def test_sums_that_hold_by_their_entries_or_may_be_excused_change_no_zone(facts: Facts) -> None:
    assert zones(facts, AtLeast((Pick(0), LAST), (1, 1), 1, ABOUT)) is None
    assert zones(facts, AtLeast((LAST,), (1,), 1, ABOUT, weight=50.0)) is None
    assert zones(facts, AtLeast((LAST,), (1,), 1, ABOUT, when=0)) is None


@pytest.mark.parametrize("steps", [Steps(0, 7), Steps(7, 0), Steps(6, 1, -3, 2)])
def test_zones_yield_so_that_two_come_near_each_other(steps: Steps, facts: Facts) -> None:
    assert zones(facts, AtLeast((steps,), (1,), 1, ABOUT)) is not None
    assert zones(facts, AtLeast((steps,), (-1,), 0, ABOUT)) is None


def test_zones_yield_so_that_two_are_far_from_each_other(facts: Facts) -> None:
    """Two parts of one zone are next to each other, those of two zones beside each other up to three cuts away."""
    assert zones(facts, AtLeast((Steps(0, 3, -3, 3),), (-1,), 0, ABOUT)) is not None
    assert zones(facts, AtLeast((Steps(0, 3, -2, 2),), (-1,), 0, ABOUT)) is None


def test_where_sums_cannot_hold_together_the_sheet_is_one_zone(facts: Facts) -> None:
    """Each of two sums can hold by the order of two parts within a zone, but they ask for opposite orders of these."""
    one, other = (AtLeast((of_two, Before(7, 2)), (1, 1), 1, ABOUT) for of_two in (Before(1, 0), Before(0, 1)))
    assert zones(facts, one) is None
    assert zones(facts, other) is None
    assert zones(facts, one, other) == [1] * 8
    assert zones(facts, one, other, Precede(2, 7, ABOUT)) is None  # no zones help


def test_what_must_come_before_comes_along(facts: Facts) -> None:
    both = AtLeast((Before(7, 0), Before(6, 1)), (1, 1), 2, ABOUT)
    changed = zones(facts, both, Precede(5, 7, About("own:order", (), "5 before 7")))
    assert changed is not None
    assert changed[5] <= changed[7] <= changed[0]
