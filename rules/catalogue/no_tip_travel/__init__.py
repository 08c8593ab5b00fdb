"""Rule no-tip-travel."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.options.option import NoOptions
from kerfwise.rules.rule import Rule, Violation
from kerfwise.rules.statements import Crossing

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

GRAZE_MM = 0.1
"""Travel that comes no further over the rim of a part passes it by."""


class NoTipTravel(Rule[NoOptions]):
    """Idle travel does not lead over a part that has been cut out.

    ## What it does

    The straight line from the end of each cut to the next pierce, from home to the first and from the last back home,
    does not cross the area of a part whose outer contour has been cut before. The area is all that the outer contour
    encloses: what falls out of a hole may stand up as well. Where the machine travels with its head down
    (`machine.head: down`) a soft rule is hard.

    ## Links, tabs and other cuts

    - **Links**: A link is no idle travel: it runs through waste.
    - **Tabs**: A part that tabs hold does not tip: travel over it is free.
    - **Common cuts**: A part is out when its own cut is made, and travel keeps off it from then on, also to where
      the next cut begins in its kerf.
    - **Scrap lines**: Travel to them and between them keeps off the parts that are out. Loose pieces of the skeleton
      are not looked at.
    - **Several torches**: Their heads go along with the first, lit or not, and keep off what is out, too.

    ## Why

    A part that is cut out may tip on the slats of the table and stand up above the sheet, where the travelling torch
    breaks on it. A head that is lifted passes over most of them.

    ## Wrong

    A, B and C in a row, cut in this order, and after C the torch goes home over A and B.

    ## Right

    The same order, with the way home round the row, or the row cut towards home.
    """

    id = "no-tip-travel"
    sentence = "Idle travel does not lead over a part that has been cut out."
    source = "plant practice"
    Options = NoOptions
    minds_ways = True
    takes_no_file = "it looks at single moves of the torch, for which files have no words"
    minds_what_is_out = True
    default = "soft"
    default_weight = 50.0
    hard_with_head_down = True

    def statements(self, facts: Facts, options: NoOptions) -> Iterator[Crossing]:
        left, held = facts.nest.index, facts.held_by_tabs
        for part in (part for part in facts.whole_nest.parts if part.outer.id not in held):
            sentence = f"no travel leads over {part.id} once {part.outer.id} is cut: it may have tipped up"
            about = self.about((part.outer.id,), sentence)
            yield Crossing(left.get(part.outer.id), part.outer.polygon, about)

    def violations(self, nest: Nest, cuts: CutSequence, options: NoOptions) -> list[Violation]:
        if not cuts.new:
            return []
        at, when, way = cuts.positions(), cuts.moments(), cuts.way
        held = {cut.contour for cut in cuts if cut.tabs}
        parts = [part for part in nest.parts if part.outer.id in at and part.outer.id not in held]
        ends = [cuts.home, *(cut.end for cut in way)], [*(cut.pierce for cut in way), cuts.home]
        holes = cuts.pierced
        lines = (
            [
                shapely.LineString([begin, *(hole.at for hole in holes.get(k, ())), end])
                for k, (begin, end) in enumerate(zip(*ends, strict=True), cuts.made + 1)
            ]
            if holes
            else shapely.linestrings(np.array(ends).transpose(1, 0, 2))
        )
        areas = shapely.buffer([part.outer.polygon for part in parts], -GRAZE_MM)
        leg, over = _met(areas, lines, cuts)
        found = []
        for k, number in sorted(zip(leg, over, strict=True)):
            name, cut_at = parts[number].outer.id, at[parts[number].outer.id]
            if when[name] <= k + cuts.made:
                around = [at[cut.contour] for cut in way[max(k - 1, 0) : k + 1]]
                start = f"{way[k - 1].contour} (cut {around[0]})" if k else "home"
                end = f"to {way[k].contour} (cut {around[-1]})" if k < len(way) else "home"
                text = f"travel from {start} {end} leads over {parts[number].id}, cut out as cut {cut_at}"
                found.append(Violation(self.id, (name,), text, tuple(sorted({cut_at, *around}))))
        return found


def _met(
    areas: Sequence[shapely.Polygon], lines: Sequence[shapely.LineString], cuts: CutSequence
) -> tuple[list[int], list[int]]:
    """Which of the ways, from 0 on, lead over which areas: those of all torches that cut, lit or not."""
    tree = shapely.STRtree(areas)
    shifts = [(0.0, 0.0), *cuts.shifts.values()]
    found = [tree.query(shapely.transform(lines, lambda xy, by=by: xy + by), predicate="intersects") for by in shifts]
    return [k for legs, _ in found for k in legs.tolist()], [k for _, over in found for k in over.tolist()]
