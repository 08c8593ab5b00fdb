"""Contradictions of orders are named without a solver: shortest, and minimal by trying every order and entry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations, permutations, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import Lock, Profile, RulesConflict
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.plan.conflict import core as core_module
from kerfwise.models.plan.conflict import state_relaxed
from kerfwise.models.plan.conflict.core import Core, find_core, whole_order
from kerfwise.models.plan.conflict.groups import (
    LAST,
    CanClash,
    Group,
    NotAnswered,
    NothingLeft,
    drop_unneeded_rules,
    hard_groups,
    in_time,
    shrink,
    solver_within,
)
from kerfwise.models.plan.conflict.order_conflicts import clash_of_orders, is_exact, orders_of, shortest_cycle
from kerfwise.models.plan.conflict.ways_out import find_relaxation, soften
from kerfwise.models.plan.plan import RELAXED
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.check import report
from kerfwise.rule_kit import (
    About,
    AtLeast,
    Before,
    Contiguous,
    Facts,
    Forbid,
    Pick,
    Precede,
    Statement,
    circle,
    nest,
    part,
    rect,
)
from kerfwise.rules.registry import RULES
from kerfwise.rules.stating.state_rules import every_statement, resolve
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.plan.conflict.statements import can_hold, row, statements
from kerfwise.tests.models.solved import plant
from kerfwise.tests.tools.amount import examples

N = 5
FACTS = row()
"""Four contours with two candidates each."""
PAIRS = st.tuples(st.integers(0, N - 1), st.integers(0, N - 1))


def walks(links: Sequence[tuple[int, int]], runs: Sequence[tuple[int, ...]], most: int) -> list[tuple[int, ...]]:
    """All rounds of up to `most` links that no order can keep, by trying every sequence of links and every order."""
    found = []
    for size in range(1, most + 1):
        for walk in permutations(range(len(links)), size):
            if not any(_kept([links[k] for k in walk], runs, place) for place in permutations(range(N))):
                found.append(walk)
        if found:
            return found
    return found


def _kept(links: Sequence[tuple[int, int]], runs: Sequence[tuple[int, ...]], place: tuple[int, ...]) -> bool:
    together = all(max(place[k] for k in run) - min(place[k] for k in run) < len(set(run)) for run in runs)
    return together and all(place[i] < place[j] for i, j in links)


@examples(60)
@given(st.lists(PAIRS, max_size=5), st.booleans())
def test_no_cycle_is_shorter(links: list[tuple[int, int]], in_one_go: bool) -> None:
    runs = [(0, 3)] * in_one_go
    found = shortest_cycle(N, links, runs)
    fewest = walks(links, runs, len(links))
    assert (found is None) == (not fewest)
    if found is not None:
        cycle, tying = found
        assert len(cycle) == len(fewest[0])
        assert frozenset(cycle) in {frozenset(walk) for walk in fewest}
        kept = [_kept([links[k] for k in cycle], [runs[k] for k in tying], place) for place in permutations(range(N))]
        assert not any(kept)


def test_a_cycle_through_runs_that_share_a_contour() -> None:
    assert shortest_cycle(5, [(0, 4), (4, 2)], [(0, 1), (1, 2), (3, 4)]) == ([0, 1], [0, 1])


def of_orders(groups: Sequence[Group]) -> list[Group] | None:
    return clash_of_orders(FACTS.n, groups, orders_of(FACTS, groups), {"level-ahead": 1})


@st.composite
def ordered(draw: st.DrawFn) -> list[CanClash]:
    """Orders, runs, places, and what every entry of a contour asks for, some of it in one sentence."""
    made: list[CanClash] = []
    runs = [(0, 1), (2, 3)]
    for k in range(draw(st.integers(1, 6))):
        about = About(draw(st.sampled_from(["locks", "level-ahead", "pierce"])), (), f"statement {k}")
        i, j = draw(st.permutations(range(4)))[:2]
        others = [m for m in range(4) if m != i]
        match draw(st.sampled_from(["order", "two orders", "run", "early", "late", "each entry", "one entry"])):
            case "order":
                made.append(Precede(i, j, about))
            case "two orders":
                made += [Precede(i, m, about) for m in others[:2]]
            case "run" if runs:
                made.append(Contiguous(runs.pop(), about))
            case "early":
                made.append(AtLeast(tuple(Before(i, m) for m in others), (1, 1, 1), draw(st.integers(0, 3)), about))
            case "late":
                made.append(AtLeast(tuple(Before(m, i) for m in others), (1, 1, 1), draw(st.integers(0, 3)), about))
            case "each entry":
                made += [AtLeast((Before(i, j),), (1,), 1, about, when=c) for c in FACTS.candidates_of(i)]
            case _:
                made.append(AtLeast((Before(j, i), Pick(2 * j)), (1, -1), draw(st.integers(0, 1)), about, when=2 * i))
    return made


@pytest.mark.slow
@examples(150)
@given(ordered())
def test_what_is_named_is_minimal_by_trying_everything(asked: list[CanClash]) -> None:
    groups = hard_groups(asked)
    found = of_orders(groups)
    if found is None:
        assert not is_exact(orders_of(FACTS, groups)) or can_hold(FACTS, asked)
        return
    assert not can_hold(FACTS, [s for group in found for s in group.statements])
    if is_exact(orders_of(FACTS, found)):
        for one in found:
            assert can_hold(FACTS, [s for group in found if group is not one for s in group.statements])


@pytest.mark.slow
@examples(100)
@given(st.one_of(ordered(), statements()))
def test_an_order_that_is_found_keeps_everything(asked: list[CanClash]) -> None:
    groups = hard_groups(asked)
    way = whole_order(FACTS, groups, orders_of(FACTS, groups))
    if way is None:
        return
    problem = make_problem(FACTS, tuple(asked), (0.0, 0.0))
    used = {FACTS.candidates[c].contour: c for c in way.picked}
    entries = [used.get(k, FACTS.candidates_of(k)[0]) for k in sorted(range(FACTS.n), key=lambda k: way.place[k])]
    assert broken(problem, [int(problem.candidate_site[c]) for c in entries]) == ()


def test_orders_are_told_apart_from_what_hangs_on_entries() -> None:
    def about(name: str) -> About:
        return About("pierce", (), name)

    always = [AtLeast((Before(0, 1),), (1,), 1, about("always"), when=c) for c in FACTS.candidates_of(0)]
    once = [AtLeast((Before(0, 1),), (1,), 1, about("once"), when=0)]
    last = AtLeast((Before(1, 0), Before(2, 0), Before(3, 0)), (1, 1, 1), 3, about("last"))
    third = AtLeast((Before(1, 0), Before(2, 0), Before(3, 0)), (1, 1, 1), 2, about("third"))
    found = orders_of(FACTS, hard_groups([*always, *once, last, third, Forbid(3, about("entry"))]))
    assert [of.links for of in found] == [((0, 1),), (), ((1, 0), (2, 0), (3, 0)), (), ()]
    assert [of.earliest for of in found] == [(), (), (), ((0, 2),), ()]
    assert [of.whole for of in found] == [True, False, True, True, False]


def test_that_a_contour_is_not_before_itself_asks_for_no_order() -> None:
    never = AtLeast((Before(0, 0),), (-1,), 0, About("level-ahead", (), "never before itself"))
    assert [of.links for of in orders_of(FACTS, hard_groups([never]))] == [()]
    assert can_hold(FACTS, [never])


def test_no_solver_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither for a cycle nor for a place that no order leaves, nor to see that all can hold."""

    def asked(*given: object, **more: object) -> None:
        raise AssertionError("the solver was asked")

    monkeypatch.setattr(core_module, "clash", asked)
    monkeypatch.setattr(core_module, "clash_at_once", asked)
    chain = [Precede(k, k + 1, About("level-ahead", (), f"{k}")) for k in range(3)]
    back = Precede(3, 1, About("locks", (), "back"))
    first = AtLeast(tuple(Before(2, k) for k in (0, 1, 3)), (1, 1, 1), 2, About("locks", (), "second"))
    run = Contiguous((0, 1), About("part-contiguous", (), "run"))
    other = Forbid(0, About("cut-direction", (), "entry"))
    for asked_for, said in (
        ([*chain, back, run, other], ["1", "2", "back"]),
        ([*chain, first, run, other], ["0", "1", "second"]),
        ([*chain, run, other], None),
    ):
        core = find_core(FACTS, hard_groups(asked_for), {"level-ahead": 1})
        assert (core and [group.about.sentence for group in core.groups]) == said
        assert core is None or (core.minimal and core.soon)


@pytest.mark.parametrize("firm", ["cut-direction", "locks"])
def test_what_gives_way_is_not_named_where_firm_rules_contradict_by_themselves(firm: str) -> None:
    """Neither in an order that a graph shows, nor among what is about locked contours."""
    ahead, back = Precede(0, 1, About("level-ahead", (), "ahead")), Precede(1, 0, About("pierce", (), "back"))
    entries = [Forbid(c, About(firm, (), f"entry {c}")) for c in FACTS.candidates_of(2)]
    core = find_core(FACTS, hard_groups([ahead, back, *entries]), {"level-ahead": 1})
    assert core is not None
    assert [group.about.sentence for group in core.groups] == ["entry 4", "entry 5"]
    assert core.minimal
    kept = find_core(FACTS, hard_groups([ahead, back, *entries[1:]]), {"level-ahead": 1})
    assert kept is not None
    assert [group.about.sentence for group in kept.groups] == ["ahead", "back"]


def test_contradictions_named_without_a_solver_are_not_looked_for_past_the_limit() -> None:
    times = iter(range(1000))
    deadline = Deadline(time_s=4.0, clock=lambda: float(next(times)))
    looked: list[int] = []

    def core_of(groups: Sequence[Group]) -> Core | None:
        looked.append(len(groups))
        return find_core(FACTS, groups, {}, Deadline())

    turns = [(a, b) for i, j, k in permutations(range(4), 3) for a, b in ((i, j), (j, k), (k, i))]
    asked = [Precede(*turn, About("locks", (), f"order {number}")) for number, turn in enumerate(turns)]
    with pytest.raises(NotAnswered):
        find_relaxation(hard_groups(asked), RULES, core_of, deadline)
    assert len(looked) <= 4


ROW = nest(
    420,
    110,
    part("A", rect(20, 10, 60, 80), [circle(50, 50, 12)]),
    part("B", rect(110, 20, 60, 60)),
    part("C", rect(200, 20, 70, 70), [circle(235, 55, 12)]),
)
ORDERS = [(a.id, b.id) for a in ROW.contours for b in ROW.contours if a.id != b.id]


def contradictory(seed: int) -> Profile:
    """Two or three locks that may well contradict each other, or that each part is cut in one go."""
    rng = np.random.default_rng(seed)
    chosen = rng.choice(len(ORDERS), size=int(rng.integers(2, 4)), replace=False).tolist()
    locks = [Lock(contour=ORDERS[k][0], before=ORDERS[k][1]) for k in chosen]
    if seed % 3 == 0:
        locks.append(Lock(contour=str(rng.choice([c.id for c in ROW.contours])), position=int(rng.integers(1, 6))))
    profile = plant(*locks)
    return replace(profile, leads=replace(profile.leads, entries=1))


def best_um(facts: Facts, statements: list[Statement]) -> int | None:
    """The cost of the best plan, every one tried."""
    try:
        problem = make_problem(facts, tuple(statements), (0.0, 0.0))
    except RulesConflict:
        return None
    found = cheapest(problem)
    return None if found is None else found.cost


def least_um(facts: Facts, profile: Profile) -> int:
    """The least cost of any plan, whatever is let go: the fewest locks, then the fewest statements."""
    book = profile.rulebook()
    statements = every_statement(facts, profile)[0]
    gives_way = {name: rule.gives_way for name, rule in book.items()}
    groups = [g.about for g in hard_groups(statements) if not gives_way[g.about.rule]]
    locks = [about for about in groups if about.rule in LAST]
    others = [about for about in groups if about.rule not in LAST and book[about.rule].may_be_relaxed]
    for of_locks, of_others in product(range(len(locks) + 1), range(3)):
        costs = []
        for some in product(combinations(locks, of_locks), combinations(others, of_others)):
            try:
                stated = resolve(soften(statements, [*some[0], *some[1]]), facts.n, gives_way).statements
            except RulesConflict:
                continue
            costs.append(best_um(facts, list(stated)))
        if any(cost is not None for cost in costs):
            return min(cost for cost in costs if cost is not None)
    raise AssertionError("without any lock there is a plan")


@pytest.mark.parametrize("seed", range(24))
def test_nothing_cheaper_could_be_let_go(seed: int) -> None:
    profile = contradictory(seed)
    facts = facts_of(ROW, profile)
    taken = state_relaxed(facts, profile)
    relaxed: list[About] = [d.statement.about for d in taken.dropped if d.why.startswith(RELAXED)]
    assert best_um(facts, list(taken.statements)) == least_um(facts, profile), [a.sentence for a in relaxed]


@pytest.mark.slow
def test_the_plan_of_a_way_out_passes_the_check() -> None:
    for seed in range(24):
        profile = contradictory(seed)
        facts = facts_of(ROW, profile)
        options = options_for(ROW, profile, work=2)
        verdict = solve_and_verify(make_request(facts, profile, relax=True), profile, options).verdict
        assert verdict.ok, report(verdict)


def test_nothing_is_asked_once_nothing_is_left() -> None:
    """Thousands of groups, of each of which nothing could be answered any more, would pass the limit by seconds."""
    groups = [Group(About(f"rule {k % 4}", (), str(k)), ()) for k in range(16)]
    asked: list[int] = []

    def clash(some: Sequence[Group]) -> list[int] | None:
        asked.append(len(some))
        solver_within(Deadline(0.0), 1.0)
        return None

    assert shrink(groups, clash) == (groups, False)
    assert drop_unneeded_rules(groups, {}, clash) == groups
    assert asked == [8, 12]
    with pytest.raises(NothingLeft):
        clash(groups)


def test_no_question_is_begun_that_would_end_after_the_limit() -> None:
    """Each takes a second for two groups: of 10 s the first takes 8, and of the next only a small one is begun."""
    now = [0.0]

    def clash(groups: Sequence[Group]) -> None:
        now[0] += len(groups) / 2

    asked = in_time(clash, Deadline(time_s=10.0, clock=lambda: now[0]), [])
    some = [Group(About("locks", (), str(k)), ()) for k in range(16)]
    assert asked(some) is None
    with pytest.raises(NothingLeft):
        asked(some[:5])
    assert now == [8.0]
    assert asked(some[:3]) is None
