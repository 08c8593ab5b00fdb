"""Rule pierce."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import shapely

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.judging.pierces import PiercePlaces, leads_over_holes, leads_over_older_kerfs, starts_in_older_kerfs
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import LENGTH_BY_THICKNESS, likely
from kerfwise.rules.rule import Plant, Rule, RuleSetting, Strength, Violation
from kerfwise.rules.statements import AtLeast, Before, Pick

if TYPE_CHECKING:
    from kerfwise.encoder.candidates.candidate import LeadOptions
    from kerfwise.encoder.facts.facts import FactOptions, Facts


@dataclass(frozen=True, slots=True)
class PierceOptions:
    """How far from every contour, and from older kerfs, a pierce lies; by thickness where a profile gives it so.

    With `common_cuts` (cuts.common of the profile) a cut may begin in the kerf of a part with a common edge.
    """

    clearance_mm: float = setting(
        1.5,
        likely(LENGTH_BY_THICKNESS, 0.0, 200.0),
        "least distance from a pierce to every contour, more than half the kerf",
    )
    splash_mm: float = setting(
        0.5, likely(LENGTH_BY_THICKNESS, 0.0, 100.0), "metal between the hole of a pierce and the kerf of an older cut"
    )
    kerf_mm: float = 1.5
    common_cuts: bool = False


class Pierce(Rule[PierceOptions]):
    """A pierce lies in waste, clear of every contour and of older kerfs, and its leads cross none.

    ## What it does

    The pierce of an outer contour lies outside every part, that of a hole inside the hole; both at least `clearance`
    from every contour. It is not on a part, and not over metal that has fallen out: a pierce in the waste of a hole is
    made before that hole is cut. A lead crosses no contour. From the sheet edge nothing is pierced, so that there the
    clearance does not apply. Marks are not pierced. Scrap lines begin in a void, when all parts are out: nothing is
    asked of them.

    The kerf of every older cut, its leads included, is void. The middle of a pierce keeps half the kerf and `splash`
    from it, and a lead does not cross it, but for the last half kerf beside its own contour. Entries are made so that
    leads keep to their own half of a street. Where a street is too narrow for that, an entry may only be used while
    the neighbour whose kerf it meets is still in.

    ## Links, tabs and other cuts

    - **Links**: A link is judged as a lead, and is not pierced. It may be in the kerf of the contour that it leaves,
      and of that contour's own lead. The way that it leads to must be lawful with its pierce, too.
    - **Tabs**: The kerf round a part counts as void over its tabs, too.
    - **Common cuts**: What is left of a contour begins in the kerf of a neighbour that is out: nothing is
      pierced there.
    - **Scrap lines**: They begin in a void, when all parts are out: nothing is asked of them.
    - **Pierce pass**: Where the holes of a zone are pierced before its cuts ([pierce pass](pierce-pass.md)), a lead
      crosses no such hole either, but its own, and holes keep half the kerf and `splash` from each other.

    ## Why

    Petunin 2009 (section 2): a pierce leaves a scar, blows slag and heats the metal around it, so it lies further
    from the contour than the kerf allowance, except when the torch comes in from the edge of the sheet. Over a kerf
    there is no metal to pierce, and an arc that crosses one goes out.

    ## Wrong

    `P2.outer` pierced in the waste of `P1.hole1` after `P1.hole1` has been cut: there is no metal left to pierce.
    Four parts pierced where their streets cross, one after the other in the same place.

    ## Right

    `P2.outer` pierced in the waste of `P1.hole1`, and cut before it. Four parts pierced each near its own corner.
    """

    id = "pierce"
    sentence = "A pierce lies in waste, clear of every contour and of older kerfs, and its leads cross none."
    source = "Petunin 2009, section 2"
    Options = PierceOptions
    minds_ways = True
    takes_no_file = "the check measures by it what no order decides: waste, clearance, leads across contours"
    minds_what_is_out = True
    strengths = ("hard", "off")

    def statements(self, facts: Facts, options: PierceOptions) -> Iterator[AtLeast]:
        yield from self._in_waste(facts)
        yield from self._off_kerfs(facts)
        yield from self._off_holes(facts, options)

    def _off_kerfs(self, facts: Facts) -> Iterator[AtLeast]:
        """What would meet the kerf of a contour, or of a lead, goes before it."""
        for number, other in facts.older_kerfs.rings.tolist():
            contour = facts.candidates[number].contour
            cut, older = facts.nest.contours[contour].id, facts.nest.contours[other].id
            sentence = f"{cut} is cut before {older}: from {_entered(facts, number)} it would meet the kerf of {older}"
            yield AtLeast((Before(contour, other),), (1,), 1, self.about((cut, older), sentence), when=number)
        for number, earlier in facts.older_kerfs.leads.tolist():
            contour, other = facts.candidates[number].contour, facts.candidates[earlier].contour
            cut, older = facts.nest.contours[contour].id, facts.nest.contours[other].id
            sentence = (
                f"{cut} is cut before {older}: from {_entered(facts, number)} it would meet the kerf of the lead of "
                f"{older} from {_entered(facts, earlier)}"
            )
            about = self.about((cut, older), sentence)
            yield AtLeast((Before(contour, other), Pick(earlier)), (1, -1), 0, about, when=number)

    def _off_holes(self, facts: Facts, options: PierceOptions) -> Iterator[AtLeast]:
        """Where holes are pierced before all cuts of a zone, or of the sheet: what would meet another's is not used."""
        for number, other in meeting_holes(facts, options.kerf_mm, options.splash_mm):
            one, beside = (facts.candidates[k].contour for k in (number, other))
            cut, hole = facts.nest.contours[one].id, facts.nest.contours[beside].id
            sentence = (
                f"from {_entered(facts, number)} {cut} would meet the hole that is pierced before for {hole} at "
                f"{_entered(facts, other)}"
            )
            yield AtLeast((Pick(other),), (-1,), 0, self.about((cut, hole), sentence), when=number)

    def _in_waste(self, facts: Facts) -> Iterator[AtLeast]:
        """What is pierced in the waste of a hole goes before that hole."""
        contours = facts.nest.contours
        holes = [k for k, c in enumerate(contours) if c.kind == "hole"]
        pierced = [k for k, c in enumerate(facts.candidates) if contours[c.contour].shapes_part]
        if not holes or not pierced:
            return
        points = shapely.points([facts.candidates[k].pierce for k in pierced])
        row, inside = shapely.STRtree([contours[h].polygon for h in holes]).query(points, "intersects")
        order = np.lexsort((inside, row))
        for number, hole in zip(
            np.array(pierced)[row[order]].tolist(), np.array(holes)[inside[order]].tolist(), strict=True
        ):
            contour = facts.candidates[number].contour
            if contour == hole:
                continue
            cut, waste = contours[contour].id, contours[hole].id
            sentence = (
                f"{cut} is cut before {waste}: it is pierced in the waste of {waste}, which falls out when that is cut"
            )
            yield AtLeast((Before(contour, hole),), (1,), 1, self.about((cut, waste), sentence), when=number)

    def fact_options(self, given: FactOptions, options: PierceOptions, strength: Strength) -> FactOptions:
        return given if strength == "off" else replace(given, splash_mm=options.splash_mm)

    def lead_options(self, given: LeadOptions, options: PierceOptions, strength: Strength) -> LeadOptions:
        if strength == "off":
            return given
        return replace(given, pierce_clearance_mm=options.clearance_mm, splash_mm=options.splash_mm)

    def check_with(
        self, options: PierceOptions, plant: Plant, rules: Mapping[str, RuleSetting]
    ) -> Iterator[tuple[str, str]]:
        if options.clearance_mm <= plant.kerf_mm / 2:
            yield (
                "clearance",
                f"{options.clearance_mm:g} mm is within the kerf; a pierce lies further from every contour than half "
                f"the kerf, {plant.kerf_mm / 2:g} mm (Petunin 2009)",
            )

    def violations(self, nest: Nest, cuts: CutSequence, options: PierceOptions) -> list[Violation]:
        places = PiercePlaces(nest, cuts)
        in_kerfs = starts_in_older_kerfs(nest, cuts, options.kerf_mm) if options.common_cuts else frozenset[int]()
        findings = [
            *places.misplaced(),
            *places.too_near(options.clearance_mm, in_kerfs),
            *places.over_dropped_waste(),
            *places.crossing_leads(),
            *leads_over_older_kerfs(nest, cuts, options.kerf_mm, options.splash_mm, in_kerfs),
            *leads_over_holes(nest, cuts, options.kerf_mm, options.splash_mm),
        ]
        return [Violation(self.id, ids, text, at) for at, ids, text in sorted(findings)]


def meeting_holes(facts: Facts, kerf_mm: float, splash_mm: float) -> Iterator[tuple[int, int]]:
    """Pairs of candidates of which the first, or a lead of it, would meet the hole of the other, of one pass."""
    in_pass = facts.options.pierce_pass
    rows = facts.older_kerfs.leads if in_pass else ()
    for number, other in np.asarray(rows, dtype=np.int64).reshape(-1, 2).tolist():
        one, beside = facts.candidates[number], facts.candidates[other]
        if in_pass == "zone" and facts.zone[one.contour] != facts.zone[beside.contour]:
            continue
        hole = shapely.Point(beside.pierce)
        leads = [lead.line() for lead in (one.lead_in, one.lead_out) if lead is not None]
        near = any(shapely.dwithin(lead, hole, kerf_mm / 2) for lead in leads)
        if near or math.dist(one.pierce, beside.pierce) < kerf_mm + splash_mm:
            yield number, other


def _entered(facts: Facts, candidate: int) -> str:
    x, y = facts.candidates[candidate].pierce
    return f"({x:.1f}, {y:.1f})"
