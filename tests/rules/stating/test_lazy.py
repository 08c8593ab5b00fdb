"""How long a look at an order takes is known about beforehand."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from kerfwise.jobs.request import facts_of
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.catalogue.no_narrow_strips.strips import Islands
from kerfwise.rules.judging.metal import Badly
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.stating.lazy_statements import look_takes_s


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
