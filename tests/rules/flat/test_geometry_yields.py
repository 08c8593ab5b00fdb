"""A hard sum of a model file against the rules of geometry: these give way, as few of their orders as can be."""

from __future__ import annotations

import random
from dataclasses import replace
from itertools import combinations, permutations
from pathlib import Path

import pytest

from kerfwise import Nest, Profile
from kerfwise.encoder.graphs import components, contracted
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.models.plan.conflict import find_conflict, state_relaxed
from kerfwise.postproc.check import check_program
from kerfwise.postproc.check.hard_orders import SumsRoom
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import About, AtLeast, Before
from kerfwise.rules.stating.feasible_sums import links_to_drop_for_sums
from kerfwise.tests.models.solved import proven_plan

EARLY = """% early: an urgent part is out within the first share of all cutting, by length
int: early_share; % default 40: percent
array[int] of var bool: early_holds =
  [100 * (contour_length[i] + sum(j in CONTOUR where j != i)(contour_length[j] * bool2int(before(j, i))))
     <= early_share * sum(contour_length)
   | i in CONTOUR where attribute_urgent[i] = 1 /\\ kind[i] = OUTER];
"""


def row(count: int, *urgent: int, holes: int = 0) -> Nest:
    """Parts in a row off the start side, alike but that some are urgent, and that these have holes."""
    parts = []
    for k in range(1, count + 1):
        x = 95.0 * k - 85
        inside = [rect(x + 10 + 22 * (m % 3), 20 + 22 * (m // 3), 15, 15) for m in range(holes if k in urgent else 0)]
        one = part(f"P{k}", rect(x, 10, 80, 80), inside)
        parts.append(replace(one, attributes={"urgent": int(k in urgent)}))
    return nest(95 * count + 20, 100, *parts)


def plant(folder: Path, rules: str = "") -> Profile:
    (folder / "early.mzn").write_text(EARLY)
    (folder / "plant.yaml").write_text(f"models: [early.mzn]\nrules: {{{rules}}}\n")
    return load_profile(folder / "plant.yaml")


def planned(sheet: Nest, profile: Profile) -> tuple[list[str], list[tuple[str, tuple[str, ...]]]]:
    """The cuts of the best plan, and what was dropped for it; the check lets plan and program pass."""
    asked = make_request(facts_of(sheet, profile), profile)
    _, stated, plan = proven_plan(sheet, profile, asked.stated)
    program = write_program(plan, sheet, profile)
    for verdict in (check_plan(sheet, plan, profile), check_program(sheet, program, profile)):
        assert verdict.broken() == ()
    return [p.cut.contour for p in plan.cuts], [(d.rule, d.contours) for d in stated.dropped]


@pytest.mark.slow
@pytest.mark.parametrize("stands_in", ["model file", "own_rules"])
def test_level_ahead_gives_way_to_a_share(tmp_path: Path, stands_in: str) -> None:
    """Of six parts two may be out within 40 %: all that lies ahead of the fifth but one is cut after it."""
    profile = plant(tmp_path)
    if stands_in == "own_rules":
        (tmp_path / "own.yaml").write_text(
            "own_rules: [{name: early, select: {kind: outer, attribute.urgent: 1}, within_time: 40 %}]\n"
        )
        profile = load_profile(tmp_path / "own.yaml")
    order, dropped = planned(row(6, 5), profile)
    assert order.index("P5.outer") <= 1
    assert [rule for rule, _ in dropped] == ["level-ahead"] * 3
    assert all(then == "P5.outer" for _, (_, then) in dropped)


@pytest.mark.slow
def test_what_two_urgent_parts_leave_no_room_for_together(tmp_path: Path) -> None:
    """Each alone may come third with two ahead of it; both together leave room for one more."""
    order, dropped = planned(row(8, 3, 4), plant(tmp_path))
    assert max(order.index("P3.outer"), order.index("P4.outer")) <= 2
    assert [rule for rule, _ in dropped] == ["level-ahead"] * 2


@pytest.mark.slow
def test_what_never_gives_way_is_named_and_the_advice_works(tmp_path: Path) -> None:
    """The holes of the urgent part alone take more than its share."""
    sheet, profile = row(3, 2, holes=4), plant(tmp_path)
    conflict = find_conflict(facts_of(sheet, profile), profile)
    assert conflict is not None
    assert conflict.minimal
    assert {about.rule for about in conflict.clash} == {"early", "inner-before-outer"}
    assert conflict.relax is not None
    assert [about.rule for about in conflict.relax] == ["early"]
    _, _, plan = proven_plan(sheet, profile, state_relaxed(facts_of(sheet, profile), profile))
    assert len(plan.cuts) == 7
    soft = plant(tmp_path, "early: soft")
    assert find_conflict(facts_of(sheet, soft), soft) is None
    assert len(planned(sheet, soft)[0]) == 7


@pytest.mark.slow
def test_relaxing_moves_no_part_to_another_zone_for_an_order_that_gives_way(tmp_path: Path) -> None:
    sheet, profile = row(8, 8), plant(tmp_path, "zone-order: {zone_contours: 2}")
    facts = facts_of(sheet, profile)
    plain, relaxed = (make_request(facts, profile, relax=relax) for relax in (False, True))
    assert facts.zone.tolist() == [1, 1, 2, 2, 3, 3, 4, 4]
    assert plain.facts.zone.tolist() == relaxed.facts.zone.tolist() == [1, 1, 2, 2, 3, 3, 4, 2]


def ends_of(s: AtLeast) -> list[tuple[int, int]]:
    return [(x.i, x.j) for x in s.literals if isinstance(x, Before)]


@pytest.mark.parametrize("seed", range(40))
def test_no_fewer_would_do(seed: int) -> None:
    """Of all sets of links the lightest without which an order keeps the rest, run and sums; the check agrees."""
    rng, n, about = random.Random(seed), 5, About("sum", (), "")
    turn = rng.sample(range(n), n)
    links = [link for link in combinations(turn, 2) if rng.random() < 0.7]
    weights = [rng.choice([1, 1, 3, None]) for _ in links]
    run = rng.sample(range(n), 2) if rng.random() < 0.5 else []
    runs = [run] if run and not components(contracted(n, links, [run])) else []
    sums = []
    for pivot in rng.sample(range(n), 2):
        pairs = tuple(Before(pivot, k) for k in range(n) if k != pivot)
        sizes = tuple(rng.choice([1, 2, 3]) for _ in pairs)
        sums.append(AtLeast(pairs, sizes, round(rng.uniform(0.3, 1.0) * sum(sizes)), about))

    def lost(order: tuple[int, ...]) -> float:
        at = {k: place for place, k in enumerate(order)}
        summed = [sum(w for (i, j), w in zip(ends_of(s), s.weights, strict=True) if at[i] < at[j]) for s in sums]
        if any(total < s.bound for total, s in zip(summed, sums, strict=True)) or any(
            abs(at[a] - at[b]) > 1 for a, b in runs
        ):
            return float("inf")
        broken = [w for (a, b), w in zip(links, weights, strict=True) if at[a] > at[b]]
        return float("inf") if None in broken else float(sum(w or 0 for w in broken))

    least = min(map(lost, permutations(range(n))))
    found = links_to_drop_for_sums(n, links, weights, runs, sums)
    if least == float("inf"):
        assert found is None
    else:
        assert found is not None
        out, shown = found
        assert shown
        assert sum(weights[k] or 0 for k in out) == least
        kept = [link for k, link in enumerate(links) if k not in out]
        room = SumsRoom(n, runs, [(tuple(zip(ends_of(s), s.weights, strict=True)), s.bound) for s in sums])
        assert all(room.none(kept, links[k]) for k in out)
        assert not any(room.none(kept, link) for link in kept)
