"""What the other tests stand on: the problems drawn at random, and the routes tried one by one."""

from dataclasses import replace

from hypothesis import given

from kerfwise.models.problem.moves import MovePrices
from kerfwise.models.problem.precedence import lawful_followers
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.problems import ABOUT, problem, problems, scattered
from kerfwise.tests.tools.amount import examples


def test_the_short_way_round_is_the_cheapest() -> None:
    line = problem([[(30, 0)], [(10, 0), (10, 5)], [(20, 0)]])
    best = cheapest(line)
    assert best is not None
    assert best.cost == 60_000


def test_every_order_of_free_contours_is_lawful() -> None:
    assert len(list(lawful(problem([[(1, 0)], [(2, 0), (3, 0)], [(4, 0)]])))) == 12


def test_an_order_halves_them() -> None:
    assert len(list(lawful(problem([[(1, 0)], [(2, 0)], [(4, 0)]], pairs=[(2, 0)])))) == 3


def test_nothing_is_lawful_when_two_contours_cannot_be_far_enough_apart() -> None:
    assert cheapest(problem([[(1, 0)], [(2, 0)]], lags=[Lag(0, 1, ABOUT, cuts=1)])) is None


def test_scattered_problems_are_the_same_each_time() -> None:
    first, second = scattered(3, 6, 2, pairs=4), scattered(3, 6, 2, pairs=4)
    assert (first.pierce_um == second.pierce_um).all()
    assert (first.before == second.before).all()


@given(problems())
@examples(20)
def test_who_may_follow_whom_is_the_same_however_often_it_is_asked(drawn: Problem) -> None:
    plainly = lawful_followers(drawn.before, drawn.block, drawn.apart(), drawn.moves.barred).whole()
    other = replace(drawn, lags=(), moves=MovePrices())
    for asked in (drawn, drawn, other, drawn):
        wanted = lawful_followers(other.before, other.block).whole() if asked is other else plainly
        assert (asked.successors() == wanted).all()


def test_what_is_changed_in_an_answer_stays_out_of_the_next() -> None:
    line = problem([[(1, 0)], [(2, 0)], [(4, 0)]], pairs=[(2, 0)])
    line.successors()[:] = False
    assert line.successors().any()


@given(problems())
@examples(20)
def test_a_drawn_problem_is_well_formed(drawn: Problem) -> None:
    assert drawn.first[-1] == drawn.m == len(drawn.end_um)
    assert not (drawn.before & drawn.before.T).any()
