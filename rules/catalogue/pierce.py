"""Rule pierce."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import shapely

from ...encoder.cut import CutSequence
from ...encoder.nest import Nest
from ..option import option
from ..pierce_places import PiercePlaces
from ..rule import Rule, Violation
from ..statements import AtLeast, Before
from ..thickness_table import LENGTH_OR_TABLE

if TYPE_CHECKING:
    from ...encoder.facts.facts import Facts


@dataclass(frozen=True, slots=True)
class PierceOptions:
    """How far from every contour a pierce lies; where a profile gives it by thickness, as it is for its material."""

    clearance_mm: float = field(
        default=1.5,
        metadata=option(LENGTH_OR_TABLE, "least distance from a pierce to every contour, more than half the kerf"),
    )


class Pierce(Rule[PierceOptions]):
    """A pierce lies in waste, clear of every contour, and its leads cross none.

    ## What it does

    The pierce of an outer contour lies outside every part, that of a hole inside the hole; both at least `clearance`
    from every contour. It is not on a part, and not over metal that has dropped: a pierce in the waste of a hole is
    made before that hole is cut. A lead crosses no contour. From the sheet edge nothing is pierced, so that there the
    clearance does not apply. Marks are not pierced.

    ## Why

    Petunin 2009 (section 2): a pierce leaves a scar, blows slag and heats the metal around it, so it lies further
    from the contour than the kerf allowance, except when the torch comes in from the edge of the sheet.

    ## Wrong

    `P2.outer` pierced in the waste of `P1.hole1` after `P1.hole1` has been cut: there is no metal left to pierce.

    ## Right

    `P2.outer` pierced in the waste of `P1.hole1`, and cut before it.
    """

    id = "pierce"
    sentence = "A pierce lies in waste, clear of every contour, and its leads cross none."
    source = "Petunin 2009, section 2"
    Options = PierceOptions
    minds_what_is_out = True
    strengths = ("hard", "off")

    def statements(self, facts: Facts, options: PierceOptions) -> Iterator[AtLeast]:
        contours = facts.nest.contours
        holes = [k for k, c in enumerate(contours) if c.kind == "hole"]
        pierced = [k for k, c in enumerate(facts.candidates) if contours[c.contour].kind != "mark"]
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
                f"{cut} is cut before {waste}: it is pierced in the waste of {waste}, which drops when that is cut"
            )
            yield AtLeast((Before(contour, hole),), (1,), 1, self.about((cut, waste), sentence), when=number)

    def violations(self, nest: Nest, cuts: CutSequence, options: PierceOptions) -> list[Violation]:
        places = PiercePlaces(nest, cuts)
        findings = [
            *places.misplaced(),
            *places.too_near(options.clearance_mm),
            *places.over_dropped_waste(),
            *places.crossing_leads(),
        ]
        return [Violation(self.id, ids, text, at) for at, ids, text in sorted(findings)]
