"""Conditions of a rule judged on cuts that are made: what of them is broken, by which cuts, in words."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.display import first_and_last
from kerfwise.encoder.nest import Ids, Nest
from kerfwise.rules.statements import Before, Pick

from .node import Apart, Condition, Gate, Lit, Node, NotNext, Run, Stays, parts

Breach = tuple[tuple[str, ...], str, tuple[int, ...]]
"""A breach: contour ids, what is wrong in words, positions of the cuts."""
CLOCK_S = 0.05
"""Programs round their times."""


def breaches(
    conditions: Iterable[Condition], nest: Nest, cuts: CutSequence
) -> Iterator[tuple[Breach, tuple[str, ...]]]:
    """Where cuts break conditions whose candidates are the cuts themselves, counted from 0.

    Beside each breach are the contours that a condition on moves is about: it is broken by two of them.

    What is wrong with moves, and with what is cut too late, comes last, in the order of the cuts.
    """
    judged, moves = _Judged(nest, cuts), []
    late: list[Breach] = []
    for condition in conditions:
        if isinstance(condition.asked, NotNext):
            moves.append(condition.asked)
        elif (found := judged.breach(condition)) is not None and condition.uncut_follow:
            late.append(found)
        elif found is not None:
            yield found, ()
    yield from ((found, ()) for found in sorted(late, key=lambda breach: breach[2]))
    if moves:
        yield from judged.moves(moves)


def sums_of_ids(nest: Nest, nodes: Iterable[Node]) -> list[tuple[tuple[tuple[Ids, int], ...], int]]:
    """Of what nodes ask, the sums of orders: every order (before, after) with its weight, and the least sum."""
    found = []
    for node in (part for asked in nodes for part in parts(asked)):
        terms = node.terms if isinstance(node, Gate) else ()
        ends = [(of.ends, weight) for of, weight in terms if isinstance(of, Lit) and isinstance(of.atom, Before)]
        if isinstance(node, Gate) and len(ends) == len(terms):
            told = tuple(((nest.contours[i].id, nest.contours[j].id), weight) for (i, j), weight in ends)
            found.append((told, node.bound))
    return found


def out_of_order(first: str, then: str, at: Mapping[str, int]) -> Breach | None:
    """That one contour is not cut before another, where both are cut; `at` are the positions of contours."""
    if first not in at or then not in at or at[first] < at[then]:
        return None
    return (first, then), f"{first} (cut {at[first]}) must be cut before {then} (cut {at[then]})", (at[then], at[first])


def interrupted(run: Iterable[str], cuts: CutSequence, at: Mapping[str, int], when: Mapping[str, int]) -> Breach | None:
    """Where another cut comes between those of a run that are still to be made; not what other torches cut with them.

    `at` are the positions of contours, `when` their moments.
    """
    places = sorted(at[name] for name in run if at.get(name, 0) > cuts.made)
    moment = {k: when[cuts[k - 1].contour] for k in places}
    for a, b in pairwise(places):
        if moment[b] > moment[a] + 1:
            strangers = (k for k in range(a + 1, b) if moment[a] < when[cuts[k - 1].contour] < moment[b])
            k = next(strangers, a + 1)
            before, stranger, after = (cuts[place - 1].contour for place in (a, k, b))
            text = f"{stranger} (cut {k}) comes between {before} (cut {a}) and {after} (cut {b})"
            return (before, stranger, after), text, (a, k, b)
    return None


class _Judged:
    def __init__(self, nest: Nest, cuts: CutSequence) -> None:
        self.nest, self.cuts, self.at, self.when = nest, cuts, cuts.positions(), cuts.moments()
        self.place = [self.at.get(contour.id, 0) for contour in nest.contours]

    def ids(self, contours: Iterable[int]) -> tuple[str, ...]:
        return tuple(self.nest.contours[k].id for k in contours)

    def breach(self, condition: Condition) -> Breach | None:
        match condition.asked:
            case bool():
                return None if condition.asked else (self.ids(condition.contours), condition.sentence, ())
            case Run(contours):
                return interrupted(self.ids(contours), self.cuts, self.at, self.when)
            case Stays(out, left):
                return self._stays(self.ids(out), self.ids(left))
            case Lit(Before()) as asked:
                i, j = asked.ends
                if self.place[i] <= self.place[j]:
                    return None
                first, then = self.ids((i, j))
                return out_of_order(first, then, self.at)
            case Lit(Apart() as apart):
                return self._apart(apart)
            case Lit(Pick(c), holds):
                return None if holds else self._alone(condition, c + 1, 0)
            case Gate():
                return self._gate(condition, condition.asked)
        raise AssertionError(f"no cuts are judged by {condition}")

    def _stays(self, out: tuple[str, ...], left: tuple[str, ...]) -> Breach | None:
        never = len(self.cuts) + 1
        out_at = sorted(self.at.get(name, never) for name in out)
        if out_at[-1] >= min(self.at.get(name, never) for name in left):
            return None
        text = f"{first_and_last(out)} are all cut (cut {out_at[-1]}) while {first_and_last(left)} are still in"
        return (*out, *left), text, tuple(out_at)

    def _apart(self, asked: Apart) -> Breach | None:
        at, ids = self.at, self.ids((asked.i, asked.j))
        if any(name not in at for name in ids):
            return None
        first, then = sorted(ids, key=at.__getitem__)
        between = max(abs(self.when[then] - self.when[first]) - 1, 0)
        waited_s = self.cuts[at[then] - 1].start_s - self.cuts[at[first] - 1].end_s
        if between >= asked.cuts and waited_s >= asked.seconds - CLOCK_S:
            return None
        seconds = f" and {waited_s:.1f} s" if asked.seconds else ""
        lie = f"between {first} (cut {at[first]}) and {then} (cut {at[then]}) lie {between} cuts{seconds}"
        return (first, then), f"{lie}, not {asked.words}", (at[first], at[then])

    def _gate(self, condition: Condition, asked: Gate) -> Breach | None:
        """A sum over the orders of one contour and others. Nothing is asked of one that none is left to follow."""
        position, beside = self.place[condition.contours[0]], (self.place[k] for k in condition.beside)
        value, asks, is_first = 0, condition.uncut_follow, False
        for term, weight in asked.terms:
            assert isinstance(term, Lit), "a sum of orders"
            i, j = term.ends
            first, then = self.place[i], self.place[j]
            value += weight * (first < then if first and then else condition.uncut_follow)
            is_first = then == position
            asks = asks or is_first or then > self.cuts.made
        if not position or not asks or value >= asked.bound:
            return None
        further = any(0 < other < position if is_first else other > position for other in beside)
        return None if further else self._alone(condition, position, value)

    def _alone(self, condition: Condition, position: int, value: int) -> Breach:
        """What one cut breaks by itself."""
        name = self.cuts[position - 1].contour
        wrong = condition.wrong if isinstance(condition.wrong, str) else condition.wrong(value)
        return (name,), f"{name} (cut {position}) {wrong}", (position,)

    def moves(self, asked: Sequence[NotNext]) -> Iterator[tuple[Breach, tuple[str, ...]]]:
        """Cuts that directly follow each other and may not."""
        index, of = self.nest.index, defaultdict(list)
        for move in asked:
            for k in move.leave:
                of[k].append(move)
        for a, b in _steps(self.cuts):
            one, other = self.cuts[a], self.cuts[b]
            i, j = index.get(one.contour, -1), index.get(other.contour, -1)
            for move in of.get(i, ()):
                by = (move.leaving is None or a in move.leaving) and (move.reaching is None or b in move.reaching)
                if i != j and j in move.reach and by:
                    ways = "" if move.leaving is None else f", {one.direction} and then {other.direction}"
                    first, then = self.at[one.contour], self.at[other.contour]
                    text = f"{other.contour} (cut {then}) must not directly follow {one.contour} (cut {first}){ways}"
                    breach = (one.contour, other.contour), text, (first, then)
                    yield breach, self.ids(dict.fromkeys((*move.leave, *move.reach)))


def _steps(cuts: CutSequence) -> Iterator[tuple[int, int]]:
    """Cuts that directly follow each other, what several torches cut together each with each; not over a stop."""
    moments = cuts.moments()
    made = {cut.contour for cut in cuts[: cuts.made]}
    of_moment: dict[int, list[tuple[int, Cut]]] = defaultdict(list)
    for k, cut in enumerate(cuts):
        of_moment[moments[cut.contour]].append((k, cut))
    for moment in sorted(of_moment):
        for a, one in of_moment[moment]:
            for b, other in of_moment.get(moment + 1, ()):
                if (one.contour in made) == (other.contour in made):
                    yield a, b
