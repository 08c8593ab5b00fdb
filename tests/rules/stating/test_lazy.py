"""Looks at whole orders: how long one takes is known about beforehand, and what all need is measured beside."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from itertools import count

import pytest

from kerfwise.jobs.request import facts_of
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.catalogue.no_narrow_strips.strips import Islands
from kerfwise.rules.judging.metal import Badly
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import Statement
from kerfwise.rules.stating.lazy_statements import LARGE, Look, look_takes_s, measured_beside


@pytest.mark.slow
def test_a_look_takes_about_as_long_as_its_beginning_tells(monkeypatch: pytest.MonkeyPatch) -> None:
    """A second a cut: what is told lies between once and twice what a whole look takes."""
    parts = 100
    row = nest(20 + 60 * parts, 100, *(part(f"P{k}", rect(20 + 60 * k, 20, 40, 60)) for k in range(parts)))
    profile = load_profile()
    facts = facts_of(row, profile)
    looked = [0]
    take_out = Islands.take_out

    def counted(islands: Islands, p: int) -> Iterator[Badly]:
        looked[0] += 1
        return take_out(islands, p)

    monkeypatch.setattr(Islands, "take_out", counted)
    assert parts <= look_takes_s(facts, profile, lambda: looked[0]) <= 2 * parts
    assert looked[0] < parts / 2


def test_a_look_at_a_large_nest_waits_for_what_a_thread_measures_even_where_that_fails() -> None:
    """So that two threads are never at what both keep; a smaller nest has no thread, and each its own look."""
    measured, begun = threading.Event(), threading.Event()
    asked: list[tuple[int, tuple[int, ...]]] = []

    def made() -> Look:
        number = next(numbers)

        def look(order: Sequence[int]) -> tuple[Statement, ...]:
            if not order:
                assert begun.wait(10)
                measured.set()
                raise ValueError("a rule of the plant's own that knows no sheet without cuts")
            assert measured.is_set()
            asked.append((number, tuple(order)))
            return ()

        return look

    numbers = count()
    with measured_beside(made, LARGE) as looked:
        begun.set()
        assert looked((1, 0)) == ()
    assert asked == [(0, (1, 0))]
    assert next(numbers) == 2
    with measured_beside(made, LARGE - 1):
        assert next(numbers) == 4
