"""A long process keeps nothing of nests that it is done with, but what is worth keeping as long as a nest lives."""

from __future__ import annotations

import gc
import weakref
from dataclasses import replace

import pytest

from kerfwise.encoder.nest import Nest, cached_with_nest
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.flat.model_rule import facts_data
from kerfwise.rules.profile.load import load_profile


def plate(k: int) -> Nest:
    """A hook around a small part, and a part with a hole of its own and one that is too small to be cut."""
    hook = [(20, 20), (140, 20), (140, 50), (50, 50), (50, 110), (140, 110), (140, 140), (20, 140)]
    return nest(
        400 + k, 200,
        part("H", hook), part("S", rect(70, 65, 30, 30)),
        part("P", rect(200, 20, 100, 100), [circle(250, 70, 20), circle(215, 35, 1)]),
    )  # fmt: skip


def planned(k: int) -> weakref.ref[Nest]:
    made = plate(k)
    profile = load_profile()
    profile = replace(profile, small_holes=replace(profile.small_holes, under="spot"))
    asked = make_request(facts_of(made, profile), profile)
    options = options_for(made, profile, work=0.2)
    assert solve_and_verify(asked, profile, options).verdict.ok
    return weakref.ref(made)


@pytest.mark.slow
def test_no_nest_outlives_its_plan(programs_made: list[object]) -> None:
    nests = [planned(k) for k in range(4)]
    programs_made.clear()  # what every test keeps to simulate it
    gc.collect()
    assert [k for k, of in enumerate(nests) if of() is not None] == []


@pytest.mark.slow
def test_no_facts_outlive_the_model_files_that_read_them() -> None:
    facts = facts_of(nest(400, 200, part("A", rect(20, 20, 80, 80))), load_profile())
    assert facts_data(facts) is facts_data(facts)
    of = weakref.ref(facts)
    del facts
    gc.collect()
    assert of() is None


@pytest.mark.slow
def test_answers_are_kept_with_each_nest() -> None:
    asked: list[tuple[int, int]] = []

    @cached_with_nest(most=2)
    def answer(of: Nest, number: int) -> Nest:
        asked.append((len(of.parts), number))
        return of

    one, other = nest(100, 100, part("A", rect(10, 10, 50, 50))), nest(100, 100)
    for number in (1, 1, 2, 1):
        assert answer(one, number) is one
        assert answer(other, number) is other
    assert asked == [(1, 1), (0, 1), (1, 2), (0, 2)]
    answer(one, 3)
    answer(one, 2)
    assert asked[4:] == [(1, 3), (1, 2)]  # 2 was asked for longest ago
    gone = weakref.ref(one)
    del one
    gc.collect()
    assert gone() is None
