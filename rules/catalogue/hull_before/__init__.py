"""Rule hull-before."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely

from kerfwise.encoder.cut import CutSequence, Side
from kerfwise.encoder.nest import Contour, Ids, Nest, cached_with_nest
from kerfwise.rules.judging.metal import same_place, well_within
from kerfwise.rules.options.option import NoOptions
from kerfwise.rules.rule import OrderRule, Strength
from kerfwise.rules.statements import Precede

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import FactOptions, Facts

FLAT_MM = 0.05
"""A contour that nowhere lies deeper inside its hull is convex: drawings carry such rounding."""
ON_HULL_MM = 1e-6
"""A centroid this near to a hull or a contour lies on it."""


class HullBefore(OrderRule[NoOptions]):
    """A part that sits in the concavity of another is cut before it.

    ## What it does

    A part whose centroid lies in the convex hull of another part that is not convex, in the same place (straight on
    the sheet, or in the same hole), is cut before it. A centroid on the hull is in it; one in the other part's own
    metal is not, as when a trough lies around that part.

    ## Links, tabs and other cuts

    - **Links**: They change no order: the two parts that a link joins are cut as they would be with a pierce.
    - **Tabs**: They change nothing: a part on its tabs is out once it is cut.
    - **Common cuts**: They change no order: a part is out when what its neighbours left of it is cut.
    - **Scrap lines**: Nothing is asked of them: they are cut when all parts are out.

    ## Why

    Pristupov 2016 (fig. 4): once a hook or a channel is out, what sits in its mouth hangs on an island of metal. The
    weakest of the order rules: where they contradict each other it is the first to give way.

    ## Wrong

    A disc D in the mouth of the channel C: `C.outer`, `D.outer`.

    ## Right

    `D.outer`, `C.outer`.
    """

    id = "hull-before"
    pairs_are = "in_hull"
    sentence = "A part that sits in the concavity of another is cut before it."
    source = "Pristupov 2016, fig. 4"
    Options = NoOptions
    gives_way = 2

    def statements(self, facts: Facts, options: NoOptions) -> list[Precede]:
        return [self.precede(facts, i, j) for i, j in facts.in_hull.tolist()]

    def fact_options(self, given: FactOptions, options: NoOptions, strength: Strength) -> FactOptions:
        return replace(given, zone_respects=given.zone_respects | {"in_hull"}) if strength == "hard" else given

    def pairs(self, nest: Nest, cuts: CutSequence, options: NoOptions) -> list[Ids]:
        if not nest.parts:
            return []
        return list(_in_mouths(nest))

    def reason(self, before: str, after: str, start_side: Side | None) -> str:
        return f"it sits in the concavity of {after}, and would be left on an island once {after} is out"


@cached_with_nest(most=2)
def _in_mouths(nest: Nest) -> tuple[Ids, ...]:
    """Outer contours (before, after): the first sits in the concavity of the second. Kept with the nest."""
    outlines = [part.outer.line for part in nest.parts]
    hulls = shapely.convex_hull(outlines)
    centroids = shapely.centroid([part.outer.polygon for part in nest.parts])
    inside, hull = shapely.STRtree(hulls).query(centroids, "dwithin", distance=ON_HULL_MM)
    within = well_within(nest, centroids[inside], hull, ON_HULL_MM)
    first, then = same_place(nest, inside[~within], hull[~within])
    hollow = np.zeros(len(nest.parts), dtype=bool)
    for k in np.unique(then).tolist():
        hollow[k] = _is_hollow(nest.parts[k].outer)
    pairs = zip(first[hollow[then]].tolist(), then[hollow[then]].tolist(), strict=True)
    return tuple((nest.parts[a].outer.id, nest.parts[b].outer.id) for a, b in pairs)


def _is_hollow(outer: Contour) -> bool:
    """Whether a point of the contour lies deeper inside its hull than drawing noise does."""
    rim = shapely.boundary(shapely.convex_hull(outer.line))
    return bool((shapely.distance(shapely.points(outer.curve.flatten()), rim) > FLAT_MM + ON_HULL_MM).any())
