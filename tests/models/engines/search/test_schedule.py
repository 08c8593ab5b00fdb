"""Annealings: how many there is time for, and what part of which is due when."""

import pytest

from kerfwise.models.engines.search.walker import CoolingPart, Schedule
from kerfwise.models.engines.tuning import ANNEALED, COOL
from kerfwise.models.engines.tuning import WALKER_SHORT as SHORT
from kerfwise.models.engines.tuning import WALKER_SHORTEST as SHORTEST


@pytest.mark.parametrize(("times", "stages"), [(0.5, 1), (1.0, 1), (2.0, 2), (3.9, 2), (4.0, 3), (9.0, 4)])
def test_as_many_as_there_is_time_for(times: float, stages: int) -> None:
    assert Schedule.of(100, int(times * SHORTEST * 1000)).stages == stages


def test_it_begins_cooler_where_time_is_short() -> None:
    assert Schedule.of(100, 1) == Schedule(1, COOL, short=True)
    assert Schedule(1, COOL).part(0.0, 1.0).heat(0) < Schedule(1, 0).part(0.0, 1.0).heat(0)


def test_the_last_takes_half_and_the_first_two_the_same() -> None:
    schedule = Schedule(3, 0)
    begins = [k / 100 for k in range(100) if schedule.part(k / 100, k / 100).done == 0.0]
    assert begins == [0.0, 0.25, 0.5]
    assert [schedule.part(at, at).turn for at in begins] == [2, 1, 0]


def test_a_part_ends_with_its_annealing() -> None:
    assert Schedule(2, 0).part(0.25, 0.75) == CoolingPart(0.5, 1.0, 1)


def test_walkers_differ_in_heat() -> None:
    part = Schedule(1, 0).part(0.0, 0.1)
    assert part.heat(0) != part.heat(1)


def test_annealings_that_begin_anew_take_equal_shares_and_leave_the_rest() -> None:
    begun = [CoolingPart(k / 100, (k + 1) / 100, 0).annealing(2) for k in range(100)]
    numbers = [None if now is None else now[0] for now in begun]
    half = int(50 * ANNEALED)
    assert numbers == [0] * half + [1] * half + [None] * (100 - 2 * half)
    assert begun[half] == (1, CoolingPart(0.0, pytest.approx(1 / half), 1))


def test_there_is_no_time_for_several_if_there_is_none_for_one() -> None:
    assert Schedule.of(100, SHORT * 1000 - 1).short
    assert not Schedule.of(100, SHORT * 1000).short
