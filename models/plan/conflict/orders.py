"""What groups say of the order alone: links, runs and places, which a graph can answer for without a solver."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import assert_never

from kerfwise.encoder.facts.facts import Facts
from kerfwise.rules.statements import AtLeast, Before, Contiguous, Crossing, Forbid, Lag, NoGood, Precede
from kerfwise.rules.stating.cycles import Link
from kerfwise.rules.stating.places import ends_of

from .group import Group


@dataclass(frozen=True, slots=True)
class Orders:
    """What holds of every order that keeps a group; `whole` where the group says no more than that.

    `links` are (before, after), `runs` contours without another between them, `earliest` and `latest` places, from 0
    on, that a contour may not pass.
    """

    links: tuple[Link, ...] = ()
    runs: tuple[tuple[int, ...], ...] = ()
    earliest: tuple[tuple[int, int], ...] = ()
    latest: tuple[tuple[int, int], ...] = ()
    whole: bool = True


def orders_of(facts: Facts, groups: Sequence[Group]) -> list[Orders]:
    """What each group says of the order."""
    contour_of = [c.contour for c in facts.candidates]
    return [_of_group(facts, group, contour_of) for group in groups]


def _of_group(facts: Facts, group: Group, contour_of: Sequence[int]) -> Orders:
    links: list[Link] = []
    runs: list[tuple[int, ...]] = []
    earliest: list[tuple[int, int]] = []
    latest: list[tuple[int, int]] = []
    asking: dict[Link, set[int]] = defaultdict(set)
    whole = True
    for s in group.statements:
        match s:
            case Precede(i, j):
                links.append((i, j))
            case Contiguous(contours):
                runs.append(contours)
            case AtLeast() if ends := ends_of(s, facts.n):
                if s.bound >= facts.n - 1:  # first or last of all: an order of every two
                    links += [link for link, _ in forced(s)]
                    whole = whole and s.bound == facts.n - 1
                    continue
                for contour, early in ends if s.bound > 0 else ():
                    if early:
                        earliest.append((contour, s.bound))
                    else:
                        latest.append((contour, facts.n - 1 - s.bound))
            case AtLeast():
                must = list(forced(s))
                whole = whole and _all_said(s, must)
                if s.when is None:
                    links += [link for link, _ in must]
                else:
                    for link, _ in must:
                        asking[link].add(s.when)
            case Forbid() | Lag() | NoGood() | Crossing():
                whole = False
            case _:
                assert_never(s)
    for link, entries in asking.items():  # what every entry of a contour asks for is asked whatever the entry
        always = [entries.issuperset(facts.candidates_of(k)) for k in {contour_of[c] for c in entries}]
        whole = whole and all(always)
        links += [link] * any(always)
    return Orders(tuple(dict.fromkeys(links)), tuple(runs), tuple(earliest), tuple(latest), whole)


def forced(s: AtLeast) -> Iterator[tuple[Link, int]]:
    """The orders that must hold where the statement does, each with its literal's number.

    A literal that has a contour before itself is never true, and asks for no order.
    """
    most = sum(w for w in s.weights if w > 0)
    if most < s.bound:
        return
    for k, (literal, weight) in enumerate(zip(s.literals, s.weights, strict=True)):
        if isinstance(literal, Before) and literal.i != literal.j and most - abs(weight) < s.bound:
            yield ((literal.i, literal.j) if weight > 0 else (literal.j, literal.i)), k


def _all_said(s: AtLeast, must: Sequence[tuple[Link, int]]) -> bool:
    """Whether the statement holds wherever the orders that it forces do."""
    known = {k for _, k in must}
    least = sum(w for k, w in enumerate(s.weights) if (k in known and w > 0) or (k not in known and w < 0))
    return least >= s.bound
