"""Rule part-rigidity."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.judging.rigidity import rigid_at_best, rigid_at_the_end
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Number
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.rule import Forced, Rule, Strength, Violation
from kerfwise.rules.statements import About, AtLeast, Before

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import FactOptions, Facts, Stretch

PER_MM = 100
"""Lengths in statements are whole hundredths of a millimetre."""
ALLOWANCE = 0.05
"""How far under `rigid_min` the judged share may be: facts see the boundary in cells, the judging sees it finer."""
SHARE = Number(0, 1)
WAYS = {"cw": "clockwise", "ccw": "counter-clockwise"}


@dataclass(frozen=True, slots=True)
class PartRigidityOptions:
    """What holds a part while it is cut; `edge_band_mm` is that of the rule start-side."""

    rigid_min: float = field(
        default=0.6, metadata=option(SHARE, "least share of the last stretch of a cut that faces metal still in")
    )
    tail_share: float = field(default=0.25, metadata=option(SHARE, "the last stretch, as a share of the contour"))
    head_share: float = field(default=0.25, metadata=option(SHARE, "the first stretch, as a share of the contour"))
    head_rigid_max: float = field(
        default=0.5, metadata=option(SHARE, "most of the first stretch that should face metal still in")
    )
    head_weight_mm: float = field(
        default=25.0,
        metadata=option(LENGTH, "cost of a first stretch that faces more, in idle travel (0: it may face any)"),
    )
    web_mm: float = field(default=25.0, metadata=option(LENGTH, "a part this near is a neighbour"))
    edge_band_mm: float = 25.0


class PartRigidity(Rule[PartRigidityOptions]):
    """A part is held by uncut metal while its cut comes to an end.

    ## What it does

    At the moment an outer contour is cut, a stretch of it is free if it faces the sheet's edge within `edge_band` (see
    start-side) or a part already out within `web`, and rigid if it faces a part still in, or solid metal. At least
    `rigid_min` of the last `tail_share` of the path is rigid. The check allows 0.05 less, for it looks at the boundary
    in finer steps than the facts. Which entries and directions will do depends on what has been cut before.

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
    shares = ("web_mm", "head_share", "tail_share")

    def statements(self, facts: Facts, options: PartRigidityOptions) -> Iterator[AtLeast]:
        ends, tabbed = dict(self._ends(facts, options)), facts.tabbed
        for contour in _outers(facts):
            if contour in tabbed:
                continue
            own = facts.candidates_of(contour)
            able = any(ends[c].bound <= sum(ends[c].weights) for c in own)
            for c in own:
                if able and ends[c].bound > 0:
                    yield ends[c]
        if options.head_weight_mm > 0:
            yield from self._beginnings(facts, options)

    def fact_options(self, given: FactOptions, options: PartRigidityOptions, strength: Strength) -> FactOptions:
        return replace(given, web_mm=options.web_mm, head_share=options.head_share, tail_share=options.tail_share)

    def exempt(self, facts: Facts, options: PartRigidityOptions) -> Iterator[About]:
        lacking, tabbed = dict(_lacking(facts, options)), facts.tabbed
        for contour in _outers(facts):
            own = facts.candidates_of(contour)
            if own and contour not in tabbed and all(lacking[c] > 0 for c in own):
                name = facts.nest.contours[contour].id
                yield self.about((name,), f"no way to cut {name} ends along rigid metal, whatever the order")

    def _ends(self, facts: Facts, options: PartRigidityOptions) -> Iterator[tuple[int, AtLeast]]:
        """For every candidate of an outer contour: enough of its tail faces what is solid or still in."""
        for c, contour, neighbours, lengths, solid, total in _stretches(facts, facts.tail):
            name, candidate = facts.nest.contours[contour].id, facts.candidates[c]
            sentence = (
                f"{name}, {WAYS[candidate.direction]} from ({candidate.entry[0]:.1f}, {candidate.entry[1]:.1f}), ends "
                "along metal that holds it"
            )
            about = self.about((name,), sentence)
            bound = _bound(options, solid, total)
            literals = tuple(Before(contour, x) for x in neighbours)
            yield c, AtLeast(literals, lengths, bound, about, when=c)

    def _beginnings(self, facts: Facts, options: PartRigidityOptions) -> Iterator[AtLeast]:
        """For every candidate of an outer contour: enough of what its head faces is out. A wish with its own weight."""
        for c, contour, neighbours, lengths, solid, total in _stretches(facts, facts.head):
            bound = math.ceil(solid + sum(lengths) - options.head_rigid_max * total - 1e-6)
            if bound > 0:
                name = facts.nest.contours[contour].id
                about = self.about((name,), f"{name} begins along the sheet's edge or metal already cut")
                literals = tuple(Before(x, contour) for x in neighbours)
                yield AtLeast(literals, lengths, bound, about, when=c, weight=options.head_weight_mm)

    def violations(self, nest: Nest, cuts: CutSequence, options: PartRigidityOptions) -> list[Violation]:
        found = []
        shares = rigid_at_the_end(nest, cuts, options.tail_share, options.web_mm, options.edge_band_mm)
        for k, share in shares:
            if not cuts[k - 1].tabs and share < options.rigid_min - ALLOWANCE:
                name = cuts[k - 1].contour
                text = (
                    f"{name} (cut {k}) ends along {share:.0%} rigid metal, less than {options.rigid_min:.0%}: the rest "
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


def _outers(facts: Facts) -> list[int]:
    return [facts.nest.index[part.outer.id] for part in facts.nest.parts]


def _bound(options: PartRigidityOptions, solid: float, total: float) -> int:
    """How much of what a tail faces must be still in, beside what is solid; hundredths of a millimetre."""
    return math.ceil(options.rigid_min * total - solid - 1e-6)


def _lacking(facts: Facts, options: PartRigidityOptions) -> Iterator[tuple[int, int]]:
    """For every candidate of an outer contour: how much more must be in than its tail faces."""
    for c, _, _, lengths, solid, total in _stretches(facts, facts.tail):
        yield c, _bound(options, solid, total) - sum(lengths)


def _stretches(
    facts: Facts, stretch: Stretch
) -> Iterator[tuple[int, int, tuple[int, ...], tuple[int, ...], float, float]]:
    """For every candidate of an outer contour: its number, its contour, the neighbours that the stretch faces and how
    much of each, solid metal and the whole stretch; lengths in hundredths of a millimetre."""
    faced = stretch.neighbours
    first = np.searchsorted(faced.row, np.arange(len(facts.candidates) + 1)).tolist()
    neighbours = faced.neighbour.tolist()
    lengths = np.rint(faced.length_mm * PER_MM).astype(np.int64).tolist()
    solid, total = (stretch.solid_mm * PER_MM).tolist(), (stretch.total_mm * PER_MM).tolist()
    for contour in _outers(facts):
        for c in facts.candidates_of(contour):
            span = slice(first[c], first[c + 1])
            yield c, contour, tuple(neighbours[span]), tuple(lengths[span]), solid[c], total[c]
