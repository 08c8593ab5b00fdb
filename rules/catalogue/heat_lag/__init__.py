"""Rule heat-lag."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.options.kind import Number
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import DURATION, LENGTH, likely
from kerfwise.rules.rule import Plant, Rule, RuleSetting, Violation
from kerfwise.rules.statements import Lag

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


ROUNDING_MM = 1e-6
"""Contours that are nearer than the radius by no more are as far as the radius: rounding must not decide."""


@dataclass(frozen=True, slots=True)
class HeatLagOptions:
    """How far heat reaches, and how long the metal takes to cool."""

    heat_radius_mm: float = setting(50.0, likely(LENGTH, 0.0, 10_000.0), "contours nearer than this heat each other")
    lag_cuts: int = setting(1, Number(0, whole=True), "cuts between two such contours")
    lag_s: float = setting(0.0, likely(DURATION, 0.0, 7200.0), "time between two such contours")


class HeatLag(Rule[HeatLagOptions]):
    """Near contours of different parts are not cut one after the other before the metal has cooled.

    ## What it does

    Between the cuts of two contours of different parts that lie nearer than `heat_radius` there are `lag_cuts` other
    cuts, and `lag` seconds from the end of the one to the start of the other. Contours of one part are left out: they
    belong together (see part-contiguous). Marks are left out: they heat little. Nothing is asked between a cut
    made before a stop and one made after it: metal cools while the machine stands.

    ## Links, tabs and other cuts

    - **Links**: Linked parts follow each other at once. Where the rule is hard it rules out the link, and so does a lag
      in seconds; where it is soft the link is priced as any other near pair. A profile whose links may all be shorter
      than the `heat_radius` of such a rule less a kerf is refused: it would have none.
    - **Tabs**: They change nothing: the metal beside a tab is as hot.
    - **Common cuts**: Parts with common edges are the nearest of neighbours. Where the rule is hard, something else
      is cut between two of them.
    - **Scrap lines**: Nothing is asked of them: they bend no part. As other cuts between two contours they count.
    - **Several torches**: What they cut at one time is near in time as can be: no cut lies between.

    ## Why

    Verkhoturov et al. and Petunin 2009: heat that gathers in one place bends the sheet and the parts in it. Most nests
    cannot keep this everywhere, so it is soft: each cut that is missing costs the weight.

    ## Wrong

    A and B are 10 mm apart, C is far: `A.outer`, `B.outer`, `C.outer`.

    ## Right

    `A.outer`, `C.outer`, `B.outer`.
    """

    id = "heat-lag"
    sentence = "Near contours of different parts are not cut one after the other before the metal has cooled."
    source = "Verkhoturov et al.; Petunin 2009"
    Options = HeatLagOptions
    default = "soft"
    minds_zones = False
    default_weight = 50.0

    def statements(self, facts: Facts, options: HeatLagOptions) -> Iterator[Lag]:
        if not options.lag_cuts and not options.lag_s:
            return
        contours = facts.nest.contours
        hot = [k for k, contour in enumerate(contours) if contour.shapes_part]
        for a, b in _near([contours[k] for k in hot], options.heat_radius_mm):
            first, second = hot[a], hot[b]
            ids = (contours[first].id, contours[second].id)
            sentence = f"between {ids[0]} and {ids[1]} there must be at least {_wanted(options)}: they heat each other"
            yield Lag(first, second, self.about(ids, sentence), options.lag_cuts, options.lag_s)

    def check_with(
        self, options: HeatLagOptions, plant: Plant, rules: Mapping[str, RuleSetting]
    ) -> Iterator[tuple[str, str]]:
        parts_them = options.lag_s > 0 or (options.lag_cuts > 0 and rules[self.id].strength == "hard")
        # a link begins and ends half a kerf from a contour
        if parts_them and 0 < plant.longest_link_mm < options.heat_radius_mm - plant.kerf_mm:
            near = f"links of up to {plant.longest_link_mm:g} mm join parts nearer than {options.heat_radius_mm:g} mm"
            yield (
                "heat_radius",
                f"{near}, between which the rule wants {_wanted(options)}: there would be none; make the rule soft "
                "without a lag in seconds, let links be longer, or turn them off (cuts.links.longest: 0 mm)",
            )

        if plant.snakes and rules[self.id].strength == "hard":
            yield (
                "heat_radius",
                f"a snake (cuts.snake) runs along its parts one after the other, between which the rule wants "
                f"{_wanted(options)}: make the rule soft, or leave snakes out",
            )

    def unjudged(self, nest: Nest, cuts: CutSequence, options: HeatLagOptions) -> str | None:
        timed = not options.lag_s or any(cut.end_s for cut in cuts) or not cuts
        return None if timed else "the times of the cuts are not stated"

    def violations(self, nest: Nest, cuts: CutSequence, options: HeatLagOptions) -> list[Violation]:
        timed = self.unjudged(nest, cuts, options) is None
        at, when = cuts.positions(), cuts.moments()
        cut = [c for c in nest.contours if c.shapes_part and c.id in at]
        found = []
        for a, b in _near(cut, options.heat_radius_mm):
            k, later = sorted((at[cut[a].id], at[cut[b].id]))
            before, after = cuts[k - 1], cuts[later - 1]
            between = max(abs(when[before.contour] - when[after.contour]) - 1, 0)
            pause_s = after.start_s - before.end_s
            missing = []
            if between < options.lag_cuts:
                there = "is none" if not between else "is 1" if between == 1 else f"are {between}"
                missing.append(f"{_other_cuts(options)} (there {there})")
            if timed and pause_s < options.lag_s - 1e-3:
                missing.append(f"{options.lag_s:g} s (there are {pause_s:.1f} s)")
            if missing:
                text = f"between {before.contour} (cut {k}) and {after.contour} (cut {later}) there must be "
                found.append(
                    Violation(self.id, (before.contour, after.contour), text + " and ".join(missing), (k, later))
                )
        return sorted(found, key=lambda violation: violation.cuts)


def _wanted(options: HeatLagOptions) -> str:
    """What must lie between two contours that heat each other, in words."""
    wanted = [_other_cuts(options)] * bool(options.lag_cuts) + [f"{options.lag_s:g} s"] * bool(options.lag_s)
    return " and ".join(wanted)


def _other_cuts(options: HeatLagOptions) -> str:
    return f"{options.lag_cuts} other cut" + ("s" if options.lag_cuts > 1 else "")


def _near(contours: Sequence[Contour], radius_mm: float) -> list[tuple[int, int]]:
    """Pairs of contours of different parts, given and sorted by number, that are nearer than the radius."""
    if not contours:
        return []
    lines = np.array([contour.line for contour in contours], dtype=object)
    part = np.unique([contour.part for contour in contours], return_inverse=True)[1]
    boxes = shapely.box(*(shapely.bounds(lines) + radius_mm * np.array([-1, -1, 1, 1])).T)
    first, second = shapely.STRtree(lines).query(boxes)
    apart = (first < second) & (part[first] != part[second])
    first, second = first[apart], second[apart]
    some = lines[np.unique(first)]
    shapely.prepare(some)
    within = shapely.dwithin(lines[first], lines[second], radius_mm)
    shapely.destroy_prepared(some)
    first, second = first[within], second[within]
    near = shapely.distance(lines[first], lines[second]) < radius_mm - ROUNDING_MM
    first, second = first[near], second[near]
    order = np.lexsort((second, first))
    return list(zip(first[order].tolist(), second[order].tolist(), strict=True))
