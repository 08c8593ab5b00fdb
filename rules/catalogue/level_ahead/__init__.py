"""Rule level-ahead."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats
from kerfwise.encoder.cut import CutSequence, Side
from kerfwise.encoder.nest import Ids, Nest, cached_with_nest
from kerfwise.rules.judging.metal import same_place, well_within
from kerfwise.rules.options.option import NoOptions
from kerfwise.rules.rule import OrderRule, Strength
from kerfwise.rules.statements import Precede

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import FactOptions, Facts

GRAZE_MM = 1e-6
"""A ray that passes a contour this near grazes it; a centroid this near to a contour lies on it, not inside."""
AWAY = {"left": (1.0, 0.0), "right": (-1.0, 0.0), "bottom": (0.0, 1.0), "top": (0.0, -1.0)}


class LevelAhead(OrderRule[NoOptions]):
    """A part that lies between another part and the start side is cut before it.

    ## What it does

    Let d be the direction of cutting, away from the start side. The shadow of a part is every point from which a ray
    in direction d meets its outer contour: the space between the start side and the part, its own area left out. A
    part whose centroid lies in the shadow of another in the same place (straight on the sheet, or in the same hole)
    is cut before it. A ray that grazes the contour meets it; a centroid on the contour is not in its area.

    ## Links, tabs and other cuts

    - **Links**: They change no order: the two parts that a link joins are cut as they would be with a pierce.
    - **Tabs**: They change nothing: tabs do not stiffen what is cut later.
    - **Common cuts**: They change no order: a part is out when what its neighbours left of it is cut.
    - **Scrap lines**: Nothing is asked of them: they are cut when all parts are out.
    - **Several torches**: It is asked of what each of them cuts, not between two of them.

    ## Why

    Pristupov 2016 (fig. 3): a part left standing behind the torch ends up on an island of metal, which sags, and the
    torch may break on it. Where this rule contradicts itself or hull-before, hull-before gives way first.

    ## Wrong

    Start side left, A to the left of B on the same level: `B.outer`, `A.outer`.

    ## Right

    `A.outer`, `B.outer`.
    """

    id = "level-ahead"
    pairs_are = "level_ahead"
    sentence = "A part that lies between another part and the start side is cut before it."
    source = "Pristupov 2016, fig. 3"
    Options = NoOptions
    gives_way = 1
    minds_zones = False
    of_each_torch = True

    def statements(self, facts: Facts, options: NoOptions) -> list[Precede]:
        return self.precede_each(facts, facts.level_ahead.tolist())

    def fact_options(self, given: FactOptions, options: NoOptions, strength: Strength) -> FactOptions:
        return replace(given, zone_respects=given.zone_respects | {"level_ahead"}) if strength == "hard" else given

    def unjudged(self, nest: Nest, cuts: CutSequence, options: NoOptions) -> str | None:
        return None if cuts.start_side else "the side that cutting starts from is not stated"

    def pairs(self, nest: Nest, cuts: CutSequence, options: NoOptions) -> list[Ids]:
        if cuts.start_side is None or not nest.parts:
            return []
        return list(_ahead(nest, cuts.start_side))

    def reason(self, before: str, after: str, start_side: Side | None) -> str:
        return (
            f"it lies between {after} and the {start_side} side, where cutting starts, and would be left on an island "
            "behind the torch"
        )


@cached_with_nest(most=2)
def _ahead(nest: Nest, start_side: Side) -> tuple[Ids, ...]:
    """Outer contours (before, after) whose shadow the centroid of the first lies in; kept with the nest."""
    outlines = [part.outer.line for part in nest.parts]
    xmin, ymin, xmax, ymax = shapely.total_bounds(outlines).tolist()
    reach = np.array(AWAY[start_side]) * (xmax - xmin + ymax - ymin + 1)
    start = shapely.get_coordinates(shapely.centroid([part.outer.polygon for part in nest.parts]))
    rays = shapely.linestrings(np.stack([start, start + reach], axis=1))
    around = shapely.bounds(rays) + 2 * GRAZE_MM * np.array([-1, -1, 1, 1])
    ahead, met = shapely.STRtree(outlines).query(shapely.box(*around.T))
    sure = _surely_met(start[ahead], shapely.bounds(outlines)[met], start_side)
    lines = np.array(outlines, dtype=object)
    some = np.flatnonzero(~sure)
    sure[some] = shapely.dwithin(rays[ahead[some]], lines[met[some]], GRAZE_MM)
    ahead, met = ahead[sure], met[sure]
    within = well_within(nest, shapely.points(start)[ahead], met, GRAZE_MM)
    first, then = same_place(nest, ahead[~within], met[~within])
    ids = np.array([part.outer.id for part in nest.parts], dtype=object)
    return tuple(zip(ids[first].tolist(), ids[then].tolist(), strict=True))


def _surely_met(start: Floats, boxes: Floats, start_side: Side) -> Bools:
    """Whether rays from points (k, 2) surely meet closed lines with these boxes (k, 4), one each.

    One does that begins before the box, and enters it between two opposite sides: the line goes from one to the other.
    """
    along = 0 if start_side in ("left", "right") else 1
    at, across = start[:, along], start[:, 1 - along]
    begin, end = boxes[:, along], boxes[:, along + 2]
    before = at < begin if start_side in ("left", "bottom") else at > end
    return np.asarray(before & (boxes[:, 1 - along] < across) & (across < boxes[:, 3 - along]))
