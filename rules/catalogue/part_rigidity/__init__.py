"""Rule part-rigidity."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from kerfwise.arrays import Floats, Ints, concat_ranges
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.judging.facing import rigid_at_best, rigid_at_the_end
from kerfwise.rules.options.kind import Number
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import LENGTH, WEIGHT, likely
from kerfwise.rules.rule import Forced, Rule, Strength, Violation
from kerfwise.rules.statements import About, AtLeast, Before

if TYPE_CHECKING:
    from kerfwise.encoder.candidates.candidate import Candidate
    from kerfwise.encoder.facts.facts import FactOptions, Facts, Stretch

ALLOWANCE = 0.05
"""How far under `rigid_min` the judged share may be: facts see the boundary in cells, the judging sees it finer."""
SHARE = Number(0, 1)
WAYS = {"cw": "clockwise", "ccw": "counter-clockwise"}


@dataclass(frozen=True, slots=True)
class PartRigidityOptions:
    """What holds a part while it is cut; `edge_band_mm` is that of the rule start-side."""

    rigid_min: float = setting(0.6, SHARE, "least share of the last stretch of a cut that faces metal still in")
    tail_share: float = setting(0.25, Number(0.01, 1), "the last stretch, as a share of the contour")
    head_share: float = setting(0.25, SHARE, "the first stretch, as a share of the contour")
    head_rigid_max: float = setting(0.5, SHARE, "most of the first stretch that should face metal still in")
    head_weight_mm: float = setting(
        25.0, WEIGHT, "cost of a first stretch that faces more, in idle travel (0: it may face any)"
    )
    web_mm: float = setting(25.0, likely(LENGTH, 0.0, 10_000.0), "a part this near is a neighbour")
    edge_band_mm: float = 25.0


class PartRigidity(Rule[PartRigidityOptions]):
    """A part is held by uncut metal while its cut comes to an end.

    ## What it does

    At the moment an outer contour is cut, a stretch of it is free if it faces the sheet's edge within `edge_band` (see
    start-side) or a part already out within `web`, and rigid if it faces a part still in, or solid metal. At least
    `rigid_min` of the last `tail_share` of the path is rigid. The check allows 0.05 less, for it looks at the boundary
    in finer steps than the facts; a cut that a plan excuses is told among the excuses all the same. Which entries and
    directions will do depends on what has been cut before.

    Beside that, at most `head_rigid_max` of the first `head_share` should be rigid: it costs `head_weight` where more
    is. That is a wish only and is never judged.

    Some contours can never keep the rule: every stretch faces an edge. These are exempt. Where orders that may not be
    broken leave a contour nothing to end on, the plan excuses it, in as few places as can be, and says so: in its list
    of exceptions and in the program, as `(EXCUSED part-rigidity P1.outer)`.

    ## Links, tabs and other cuts

    - **Links**: Where a link leads to a contour, it ends as it would after a pierce: the rule looks at the end alone.
    - **Tabs**: A part with tabs does not come free when its cut ends, so that it may end along anything.
    - **Common cuts**: The end is the last share of the stretch that a cut follows, not of the whole contour.
    - **Scrap lines**: Nothing is asked of them, and a part does not end along them: they are not cut yet.

    ## Why

    Petunin 2009 (section 2.1, fig. 1): a part that hangs on nothing rigid at the end of its cut moves before it is cut
    free, and gathers heat in what little metal is left; its dimensions are lost. So the cut begins along the sheet's
    edge or metal already cut, and ends along rigid metal.

    ## Wrong

    The first part of a sheet, cut so that the torch ends along the edge of the sheet.

    ## Right

    The same part, cut from the edge round to the side where its neighbours are still in.
    """

    id = "part-rigidity"
    sentence = "A part is held by uncut metal while its cut comes to an end."
    source = "Petunin 2009, section 2.1, fig. 1"
    Options = PartRigidityOptions
    minds_what_is_out = True
    excusable = True
    minds_zones = False
    shares = ("web_mm", "head_share", "tail_share")

    def statements(self, facts: Facts, options: PartRigidityOptions) -> Iterator[AtLeast]:
        ends = Faced.of(facts, facts.tail)
        bound = _bounds(options, ends)
        able = np.zeros(facts.n, dtype=np.bool_)
        able[ends.contour[bound <= ends.length]] = True
        tabbed = np.zeros(facts.n, dtype=np.bool_)
        tabbed[list(facts.tabbed)] = True
        chosen = np.flatnonzero(able[ends.contour] & ~tabbed[ends.contour] & (bound > 0))
        yield from self._ends(facts, ends.only(chosen), bound[chosen])
        if options.head_weight_mm > 0:
            yield from self._beginnings(facts, options)

    def fact_options(self, given: FactOptions, options: PartRigidityOptions, strength: Strength) -> FactOptions:
        return replace(given, web_mm=options.web_mm, head_share=options.head_share, tail_share=options.tail_share)

    def exempt(self, facts: Facts, options: PartRigidityOptions) -> Iterator[About]:
        ends, tabbed = Faced.of(facts, facts.tail), facts.tabbed
        ever = set(ends.contour[_bounds(options, ends) <= ends.length].tolist())
        for contour in dict.fromkeys(ends.contour.tolist()):
            if contour not in tabbed and contour not in ever:
                name = facts.nest.contours[contour].id
                yield self.about((name,), f"no way to cut {name} ends along rigid metal, whatever the order")

    def _ends(self, facts: Facts, faced: Faced, bound: Ints) -> list[AtLeast]:
        """For candidates of outer contours: enough of the tail faces what is solid or still in."""
        rows = zip(faced.contour.tolist(), faced.candidate.tolist(), bound.tolist(), strict=True)
        orders, statements = faced.orders(first=True), []
        for (contour, c, least), literals, weights in zip(rows, orders, faced.weights(), strict=True):
            name = facts.nest.contours[contour].id
            about = self.about((name,), _along_metal(name, facts.candidates[c]))
            statements.append(AtLeast(literals, weights, least, about, when=c))
        return statements

    def _beginnings(self, facts: Facts, options: PartRigidityOptions) -> list[AtLeast]:
        """For every candidate of an outer contour: enough of what its head faces is out. A wish with its own weight."""
        heads = Faced.of(facts, facts.head)
        bound = np.ceil(heads.solid + heads.length - options.head_rigid_max * heads.total - 1e-6).astype(np.int64)
        chosen = np.flatnonzero(bound > 0)
        faced = heads.only(chosen)
        rows = zip(faced.contour.tolist(), faced.candidate.tolist(), bound[chosen].tolist(), strict=True)
        orders, statements = faced.orders(first=False), []
        for (contour, c, least), literals, weights in zip(rows, orders, faced.weights(), strict=True):
            name = facts.nest.contours[contour].id
            about = self.about((name,), f"{name} begins along the sheet's edge or metal already cut")
            statements.append(AtLeast(literals, weights, least, about, when=c, weight=options.head_weight_mm))
        return statements

    def violations(self, nest: Nest, cuts: CutSequence, options: PartRigidityOptions) -> list[Violation]:
        found = []
        shares = rigid_at_the_end(nest, cuts, options.tail_share, options.web_mm, options.edge_band_mm)
        for k, share in shares:
            said = self.id in cuts[k - 1].excused  # then the planner has measured less, and the place is told
            least = options.rigid_min + (ALLOWANCE if said else -ALLOWANCE)
            if not cuts[k - 1].tabs and share < least:
                name, less = cuts[k - 1].contour, "less than" if share < options.rigid_min else "no more than about"
                text = (
                    f"{name} (cut {k}) ends along {share:.0%} rigid metal, {less} {options.rigid_min:.0%}: the rest "
                    f"of its last {options.tail_share:.0%} faces the sheet's edge or parts already out"
                )
                found.append(Violation(self.id, (name,), text, (k,)))
        return found

    def allowances(self, options: PartRigidityOptions) -> tuple[PartRigidityOptions, ...]:
        shares = (min(options.rigid_min + share, 1.0) + ALLOWANCE for share in (-ALLOWANCE, ALLOWANCE))
        return tuple(replace(options, rigid_min=share) for share in shares)

    def excuse(
        self, nest: Nest, cuts: CutSequence, options: PartRigidityOptions, violation: Violation, forced: Forced
    ) -> str | None:
        name = violation.contours[0]

        def at_best(out: frozenset[str]) -> float:
            return rigid_at_best(nest, name, out, options.tail_share, options.web_mm, options.edge_band_mm)

        least = options.rigid_min - ALLOWANCE
        if (best := at_best(frozenset())) < least:
            return f"no entry and direction of {name} ends along more than {best:.0%}, even with all its neighbours in"
        if self.id not in cuts[violation.cuts[0] - 1].excused:
            return None
        if (best := at_best(forced(name))) < options.rigid_min:
            return (
                "within these zones no order avoids it: with the neighbours out that the order rules put "
                f"before {name}, no entry and direction ends along more than {best:.0%}"
            )
        return "the plan excuses it: what must be cut before it left nothing better"


def _bounds(options: PartRigidityOptions, ends: Faced) -> Ints:
    """How much of what each tail faces must be still in, beside what is solid; hundredths of a millimetre."""
    return np.ceil(options.rigid_min * ends.total - ends.solid - 1e-6).astype(np.int64)


def _along_metal(contour: str, candidate: Candidate) -> str:
    at = f"({candidate.entry[0]:.1f}, {candidate.entry[1]:.1f})"
    return f"{contour}, {WAYS[candidate.direction]} from {at}, ends along metal that holds it"


# What the first or the last stretch of the paths of outer contours faces, as statements have it.

ValueT = TypeVar("ValueT")
PER_MM = 100
"""Lengths in statements are whole hundredths of a millimetre."""


@dataclass(frozen=True, eq=False, slots=True)
class Faced:
    """What a stretch of the path of candidates of outer contours faces, (k,); hundredths of a millimetre.

    `first` and `count` say which rows of `neighbour` and `lengths` are the neighbours of each; `length` is what these
    come to, `solid` how much faces solid metal, `total` the whole stretch.
    """

    candidate: Ints
    contour: Ints
    first: Ints
    count: Ints
    length: Ints
    solid: Floats
    total: Floats
    neighbour: Ints
    lengths: Ints

    @staticmethod
    def of(facts: Facts, stretch: Stretch) -> Faced:
        """Of all of them, part after part."""
        faced = stretch.neighbours
        lengths = np.rint(faced.length_mm * PER_MM).astype(np.int64)
        outers = np.array([facts.nest.index[part.outer.id] for part in facts.nest.parts], dtype=np.int64)
        own = facts.first[outers + 1] - facts.first[outers]
        candidate = concat_ranges(facts.first[outers], own)
        first, until = (np.searchsorted(faced.row, candidate, side) for side in ("left", "right"))
        up_to = np.append(0, np.cumsum(lengths))
        solid, total = (stretch.solid_mm * PER_MM)[candidate], (stretch.total_mm * PER_MM)[candidate]
        length, contour = up_to[until] - up_to[first], np.repeat(outers, own)
        return Faced(candidate, contour, first, until - first, length, solid, total, faced.neighbour, lengths)

    def only(self, chosen: Ints) -> Faced:
        """Some of them."""
        return Faced(
            self.candidate[chosen],
            self.contour[chosen],
            self.first[chosen],
            self.count[chosen],
            self.length[chosen],
            self.solid[chosen],
            self.total[chosen],
            self.neighbour,
            self.lengths,
        )

    def orders(self, first: bool) -> list[tuple[Before, ...]]:
        """For each that its contour is cut before its neighbours, or these before it."""
        own, others = np.repeat(self.contour, self.count), self.neighbour[concat_ranges(self.first, self.count)]
        i, j = (own, others) if first else (others, own)
        return self._by_candidate(list(map(Before, i.tolist(), j.tolist())))

    def weights(self) -> list[tuple[int, ...]]:
        """How much of each faces each neighbour."""
        return self._by_candidate(self.lengths[concat_ranges(self.first, self.count)].tolist())

    def _by_candidate(self, values: list[ValueT]) -> list[tuple[ValueT, ...]]:
        until = np.cumsum(self.count)
        return [tuple(values[a:b]) for a, b in zip((until - self.count).tolist(), until.tolist(), strict=True)]
