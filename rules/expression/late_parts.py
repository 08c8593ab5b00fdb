"""Parts of a hard rule that are stated only where a plan breaks them: too many, and too long, to state them all."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.rules.statements import Before

from .node import MOST_TOLD, Apart, Gate, Next, Node, all_of, contours_of, holds_in, literals, parts
from .to_statements import contiguous_runs

LAZY_FROM = 1_000_000
"""Orders that what is stated at once of one rule may come to, once `directly_before` and `cuts_between` are written
out."""
NEAR = 5
"""A part that is broken is stated with those about the same contours but for one, which is so near to it."""


@dataclass(slots=True)
class LateParts:
    """Gates over orders, moves and cuts between, each with the number of its element, from 0; -1 of a constraint.

    `after` has those that only a plan breaks which cuts one contour directly after another, by these two; all else is
    under None. `among` has them by their contours.
    """

    nodes: list[Gate] = field(default_factory=list)
    element: list[int] = field(default_factory=list)
    after: dict[tuple[int, int] | None, list[int]] = field(default_factory=lambda: defaultdict(list))
    among: dict[frozenset[int], list[int]] = field(default_factory=lambda: defaultdict(list))

    def add(self, node: Gate, element: int) -> None:
        """Take in a part."""
        k = len(self.nodes)
        self.nodes.append(node)
        self.element.append(element)
        follows = (of.atom for of, _ in node.terms if not isinstance(of, Gate) and not of.holds) if node.is_or else ()
        self.after[next(((atom.i, atom.j) for atom in follows if isinstance(atom, Next)), None)].append(k)
        self.among[frozenset(contours_of(node))].append(k)

    def broken(self, order: Sequence[int], at_mm: Floats) -> list[int]:
        """Numbers of the parts that an order of n contours breaks, and of those about the same and near contours.

        What is not in the order comes after it, and follows nothing. `at_mm` (n, 2) tells where contours are.
        """
        n = len(at_mm)
        place = list(range(len(order) + 1, len(order) + 1 + 2 * n, 2))
        for k, contour in enumerate(order):
            place[contour] = k
        asked = [*self.after.get(None, ()), *(k for step in pairwise(order) for k in self.after.get(step, ()))]
        broken = [k for k in asked if not holds_in(self.nodes[k], place)]
        return list(dict.fromkeys([*broken, *self._near(broken, at_mm)]))

    def _near(self, broken: Iterable[int], at_mm: Floats) -> Iterator[int]:
        named = np.array(sorted(frozenset().union(*self.among)), dtype=np.int64)
        for some in dict.fromkeys(frozenset(contours_of(self.nodes[k])) for k in broken):
            yield from self.among[some]
            for contour in sorted(some) if len(some) <= MOST_TOLD else ():
                apart_mm = np.hypot(*(at_mm[named] - at_mm[contour]).T)
                others = [k for k in named[np.argsort(apart_mm, kind="stable")].tolist() if k not in some][:NEAR]
                for other in others:
                    yield from self.among.get(some - {contour} | {other}, ())


def without_late_parts(
    elements: Sequence[Node], further: Sequence[Node], at_mm: Floats
) -> tuple[list[Node], list[Node], LateParts]:
    """Elements and constraints without the parts to be stated late, and these; `at_mm` (n, 2) tells where contours are.

    All parts that look at moves or at cuts between are stated where they come to no more than `LAZY_FROM` orders; else
    so many, those first whose contours are nearest to each other. Runs, and what is asked of one move or one order by
    itself, are short however many contours there are.
    """
    left = [*elements, *further]
    of_runs = set(range(len(elements))).difference(contiguous_runs(elements)[1])
    stays: list[list[Node]] = [[] if k in of_runs else [*parts(node)] for k, node in enumerate(left)]
    found = [(k, part, _words(part)) for k, some in enumerate(stays) for part in some if isinstance(part, Gate)]
    long = sorted(((k, part, words) for k, part, words in found if words), key=lambda of: _spread_mm(of[1], at_mm))
    enough = np.cumsum([2 * len(at_mm) * words for _, _, words in long]) <= LAZY_FROM
    late, long = LateParts(), long[np.count_nonzero(enough) :]
    for k, part, _ in long:
        late.add(part, k if k < len(elements) else -1)
    gone = {id(part) for _, part, _ in long}
    for k in {k for k, _, _ in long}:
        left[k] = all_of(part for part in stays[k] if id(part) not in gone)
    return left[: len(elements)], left[len(elements) :], late


def _spread_mm(part: Gate, at_mm: Floats) -> float:
    """How far from each other the contours are that a part is about."""
    x, y = zip(*at_mm[contours_of(part)].tolist(), strict=True)
    return math.hypot(max(x) - min(x), max(y) - min(y))


def _words(part: Gate) -> int:
    """How many of its literals are written out as sums of orders; none where an order does not tell it all."""
    atoms = [lit.atom for lit in literals(part)]
    if not all(isinstance(atom, Before | Next) or (isinstance(atom, Apart) and not atom.seconds) for atom in atoms):
        return 0
    return sum(not isinstance(atom, Before) for atom in atoms)
