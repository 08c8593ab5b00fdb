"""What stays together when burns are moved: the contours of one burn, and burns of one material and tool."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from kerfwise.arrays import Ints
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.plan.plan import RELAXED
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import About, Contiguous, Link, Precede, Statement
from kerfwise.rules.stating.state_rules import resolve

from .ask import Asked

KEPT = "burns"
"""What these statements come from: no rule, but the burns, which stay as they are."""
Chain = Sequence[int]
"""Contours, numbered as in the nest, in the order in which one burn cuts them."""


def keep_rows(asked: Asked, profile: Profile, chains: Sequence[Chain], cuts: Sequence[Cut], turns: Ints) -> Asked:
    """What is asked of a plan, and besides that the burns stay whole, and that materials and tools keep their turn.

    `cuts` are the old ones, one a contour in the order of the nest, and so are the candidates of the facts; `turns` are
    pairs (before, after) of contours, (k, 2).

    A burn that cuts the outline of a part, and then goes on to others, belongs to the run of that part: what is in the
    part comes before it. A run that a burn breaks, since it comes to the part from another, is asked of no order.

    Raises
    ------
    RulesConflict
        If no order keeps the burns whole and the hard rules as well.
    """
    if not chains and not len(turns):
        return asked
    facts, stated = asked.facts, asked.stated
    gives_way = {name: rule.gives_way for name, rule in profile.rulebook().items()}
    chosen = [d for d in stated.dropped if not d.why.startswith(RELAXED)]  # on cycles; there may be others now
    given = [*stated.statements, *(d.statement for d in chosen)]
    asking = [*_with_chains(facts, given, chains), *_links(facts, chains, cuts), *_in_turn(facts, turns)]
    resolved = resolve(asking, facts.n, gives_way)
    relaxed = [d for d in stated.dropped if d.why.startswith(RELAXED)]
    return replace(asked, stated=replace(resolved, dropped=(*resolved.dropped, *relaxed), exempt=stated.exempt))


def _about(facts: Facts, contours: Sequence[int], sentence: str) -> About:
    return About(KEPT, tuple(facts.nest.contours[k].id for k in contours), sentence)


def _with_chains(facts: Facts, statements: Sequence[Statement], chains: Sequence[Chain]) -> Iterator[Statement]:
    """The statements, with one run for each chain in place of the runs of its contours."""
    runs = [s for s in by_kind(statements).contiguous if s.weight is None]
    later = {contour for chain in chains for contour in chain[1:]}
    gone = {id(run) for run in runs if not later.isdisjoint(run.contours)}
    for chain in chains:
        own = next((run for run in runs if id(run) not in gone and chain[0] in run.contours), None)
        before = [] if own is None else [k for k in own.contours if k != chain[0]]
        gone |= set() if own is None else {id(own)}
        sentence = f"one burn cuts {', '.join(facts.nest.contours[k].id for k in chain)}"
        yield Contiguous((*before, *chain), _about(facts, (*before, *chain), sentence))
        for first, then in [*((k, chain[0]) for k in before), *pairwise(chain)]:
            yield Precede(first, then, _about(facts, (first, then), sentence))
    yield from (s for s in statements if id(s) not in gone)


def _links(facts: Facts, chains: Sequence[Chain], cuts: Sequence[Cut]) -> Iterator[Link]:
    """The ways of the torch from contour to contour, at no cost: each burn has its own, in any order."""
    for leave, reach in (pair for chain in chains for pair in pairwise(chain)):
        if (link := cuts[reach].lead_in) is not None:
            about = _about(facts, (leave, reach), f"{cuts[reach].contour} is cut on from {cuts[leave].contour}")
            path = tuple((x, y) for x, y in link.flatten().tolist())
            yield Link((leave,), (reach,), path, about, 0.0)


def _in_turn(facts: Facts, turns: Ints) -> Iterator[Precede]:
    for first, then in turns.tolist():
        sentence = "burns of one material and tool come before those of the next, as they did"
        yield Precede(first, then, _about(facts, (first, then), sentence))
