"""Rounds of a solve: geometry looks at each plan and may ask for another."""

from __future__ import annotations

from typing import Any

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.engines import deadline, portfolio, solve
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.problem import compile as compile_
from kerfwise.models.problem.precedence import close
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import About, Lag, NoGood, Precede

PRICE_MM = 5.0
TWO: Nest = nest(300, 100, part("A", rect(10, 10, 60, 60)), part("B", rect(110, 10, 160, 60)))


class Geometry:
    """Finds something to say of every plan, and is all that takes time."""

    def __init__(self, look_s: float = 0.0, finds: int = 100) -> None:
        self.look_s, self.finds, self.looks = look_s, finds, 0

    def clock(self) -> float:
        return self.looks * self.look_s

    def __call__(self, order: tuple[int, ...]) -> tuple[NoGood, ...]:
        self.looks += 1
        if self.looks > self.finds:
            return ()
        out, left = frozenset(order[:1]), frozenset(order[1:])
        return (NoGood(out, left, About("test", (), f"look {self.looks}"), PRICE_MM),)


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> Any:
    profile = load_profile()
    asked = make_request(facts_of(TWO, profile), profile)

    def run(
        geometry: Geometry, time_s: float | None = None, look_s: float = 0.0, options: SolveOptions | None = None
    ) -> Solution:
        monkeypatch.setattr(deadline, "running_s", geometry.clock)
        options = options or SolveOptions(time_s=time_s)
        return solve.solve(asked.facts, asked.stated.statements, options, None, geometry, look_s)

    return run


def test_there_are_rounds_until_geometry_finds_nothing(solved: Any) -> None:
    geometry = Geometry(finds=3)
    found = solved(geometry)
    assert geometry.looks == 4
    assert not [note for note in found.notes if note.startswith("rounds:")]


def test_hard_orders_are_closed_once_for_all_rounds(solved: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    closed: list[int] = []
    monkeypatch.setattr(compile_, "close", lambda n, *given: (closed.append(n), close(n, *given))[1])
    geometry = Geometry(finds=3)
    solved(geometry)
    assert geometry.looks == 4
    assert closed == [2]


def test_further_hard_orders_are_closed_anew() -> None:
    profile = load_profile()
    asked = make_request(facts_of(TWO, profile), profile)
    home = profile.machine.home
    plain = tuple(s for s in asked.stated.statements if not isinstance(s, Precede))
    first = compile_.make_problem(asked.facts, plain, home)
    more = (*plain, Precede(1, 0, About("test", (), "B before A")))
    again = compile_.make_problem(asked.facts, more, home, earlier=first)
    assert (again.before != first.before).any()
    assert (again.before == compile_.make_problem(asked.facts, more, home).before).all()


def test_what_a_proof_by_cp_sat_leaves_of_the_work_is_for_further_rounds(solved: Any) -> None:
    geometry = Geometry(finds=4)
    found = solved(geometry, options=SolveOptions(work=2.0, member="cp-sat"))
    assert geometry.looks == 5
    assert (found.status, found.proved_by) == ("optimal", "cp-sat")
    assert found.seconds < 1.0


@pytest.mark.parametrize(("look_s", "looks"), [(6.0, 1), (4.0, 2), (2.0, 4)])
def test_no_round_is_begun_whose_look_would_end_after_the_time_limit(solved: Any, look_s: float, looks: int) -> None:
    geometry = Geometry(look_s)
    found = solved(geometry, time_s=10.0)
    assert geometry.looks == looks
    assert found.seconds == looks * look_s
    assert found.notes[-1].endswith(f"the limit leaves no further round that ends with a look of {look_s:.1f} s")


@pytest.mark.parametrize(("look_s", "most_s"), [(0.0, 7.0), (5.0, 5.0), (20.0, 2.0)])
def test_time_is_kept_for_a_look_that_is_known_to_be_long(
    solved: Any, monkeypatch: pytest.MonkeyPatch, look_s: float, most_s: float
) -> None:
    """The first round ends in time for the look; a fifth of the limit it has in any case."""
    rounds_s: list[float | None] = []
    run = portfolio.run_portfolio

    def noted(problem: Any, options: SolveOptions, *rest: Any) -> Any:
        rounds_s.append(options.time_s)
        return run(problem, options, *rest)

    monkeypatch.setattr(solve, "run_portfolio", noted)
    found = solved(Geometry(look_s, finds=0), time_s=10.0, look_s=look_s)
    assert rounds_s == [most_s]
    assert bool([note for note in found.notes if "more than was left of the limit" in note]) == (look_s > 10.0)


def test_an_engine_that_cannot_hold_a_lag_says_so() -> None:
    profile = load_profile()
    asked = make_request(facts_of(TWO, profile), profile)
    lag = Lag(0, 1, About("heat-lag", (), "they heat each other"), seconds=2.0, weight=1.0)
    limits = options_for(TWO, profile, engine="ideals", work=1)
    why = "the engine ideals cannot plan this nest: rule heat-lag looks further back than the last cut; take another"
    with pytest.raises(InputError, match=why):
        solve.solve(asked.facts, (*asked.stated.statements, lag), limits)


def test_what_is_found_last_is_priced(solved: Any) -> None:
    free, priced = solved(Geometry(finds=0)), solved(Geometry(6.0), time_s=10.0)
    assert free.route == priced.route
    assert priced.objective == pytest.approx(free.objective + PRICE_MM)
