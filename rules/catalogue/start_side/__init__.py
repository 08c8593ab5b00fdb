"""Rule start-side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.encoder.cut import CutSequence, Side
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.nest import Nest
from kerfwise.rules.options.kind import Choice, Number
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import LENGTH, likely
from kerfwise.rules.rule import Rule, Strength, Violation
from kerfwise.rules.statements import Statement

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import FactOptions, Facts

SAME = 1e-6
"""What differs by less than this share is equal, so that no rounding decides on a side."""
ON_LINE_MM = 1e-6
"""What lies this near to the line between the two halves of the sheet lies on it."""


@dataclass(frozen=True, slots=True)
class StartSideOptions:
    """How the side is found; `side` fixes it."""

    side: Side | Literal["auto"] = setting(
        "auto", Choice(("auto", "left", "right", "bottom", "top")), "the side to start from (auto: by the rule)"
    )
    edge_band_mm: float = setting(
        25.0, likely(LENGTH, 0.0, 10_000.0), "a long part this near to a narrow side lies at it"
    )
    long_ratio: float = setting(4.0, Number(1), "a part is long when one side is this many times the other")
    offcut_share: float = setting(
        0.15, Number(0, 1), "an empty strip along a side is a large offcut over this share of the sheet"
    )


class StartSide(Rule[StartSideOptions]):
    """Cutting starts from the side of the sheet that heat and stiffness ask for.

    ## What it does

    Only the two narrow sides of the sheet are eligible (left and right of a square). Of these, the first that tells
    them apart: the one with more long parts within `edge_band` of it; the one opposite a large offcut; the one with
    more cut length in its half of the sheet, then more small parts (no larger than the median); else left or bottom.
    Differences under a millionth do not count, so that the place of the drawing does not decide. The profile
    may fix the side. The rule states nothing by itself: level-ahead and zone-order follow it.

    ## Links, tabs and other cuts

    - **Links**: They change nothing.
    - **Tabs**: They change nothing.
    - **Common cuts**: They change nothing.
    - **Scrap lines**: What they cut does not count when the side is chosen.

    ## Why

    Petunin 2009 (fig. 2): long parts bend most, so they go first, while the sheet is cold and whole; a large offcut
    stiffens the end, when the sheet has gathered most heat; and the side with more heat to come is cut while it is
    cold.

    ## Wrong

    An offcut on the right, and cutting starts from the right.

    ## Right

    An offcut on the right, and cutting starts from the left.
    """

    id = "start-side"
    sentence = "Cutting starts from the side of the sheet that heat and stiffness ask for."
    source = "Petunin 2009, fig. 2"
    Options = StartSideOptions
    takes_no_file = "the side is chosen before anything is stated, and the check measures by it"
    strengths = ("hard", "off")
    shares = ("edge_band_mm", "long_ratio", "offcut_share")

    def statements(self, facts: Facts, options: StartSideOptions) -> Sequence[Statement]:
        return ()

    def fact_options(self, given: FactOptions, options: StartSideOptions, strength: Strength) -> FactOptions:
        return replace(
            given,
            edge_band_mm=options.edge_band_mm,
            long_ratio=options.long_ratio,
            offcut_share=options.offcut_share,
            start_side="auto" if strength == "off" else options.side,
        )

    def unjudged(self, nest: Nest, cuts: CutSequence, options: StartSideOptions) -> str | None:
        return None if cuts.start_side else "the side that cutting starts from is not stated"

    def violations(self, nest: Nest, cuts: CutSequence, options: StartSideOptions) -> list[Violation]:
        if cuts.start_side is None:
            return []
        side, because = expected_side(nest, options)
        if side == cuts.start_side:
            return []
        return [Violation(self.id, (), f"cutting starts from the {cuts.start_side}, not from the {side}: {because}")]


def expected_side(nest: Nest, options: StartSideOptions) -> tuple[Side, str]:
    """The side that cutting must start from, and why, decided from the drawing itself.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> expected_side(nest(400, 100, part("A", rect(10, 10, 80, 80))), StartSideOptions())
    ('left', 'there is a large offcut on the right')
    """
    if options.side != "auto":
        return options.side, "the profile fixes the side"
    x0, y0, x1, y1 = nest.sheet.bounds
    sides: tuple[Side, Side] = ("left", "right") if x1 - x0 >= (1 - SAME) * (y1 - y0) else ("bottom", "top")
    start, end = (x0, x1) if sides[0] == "left" else (y0, y1)
    outers = [part.outer.polygon for part in nest.parts]
    if not outers:
        return sides[0], "nothing tells the sides apart"
    bounds = shapely.bounds(outers)
    low, high = (bounds[:, 0], bounds[:, 2]) if sides[0] == "left" else (bounds[:, 1], bounds[:, 3])
    gaps = np.stack([low - start, end - high])

    near = (gaps[:, _are_long(outers, options.long_ratio)] <= options.edge_band_mm + ON_LINE_MM).sum(axis=1)
    if near[0] != near[1]:
        side = sides[int(near.argmax())]
        return side, f"more long parts lie at the {side} side"
    large = gaps.min(axis=1) > (options.offcut_share + SAME) * (end - start)
    if large[0] != large[1]:
        return sides[int(large.argmin())], f"there is a large offcut on the {sides[int(large.argmax())]}"
    one_mm, other_mm = _cut_lengths(nest, sides[0])
    if abs(one_mm - other_mm) > SAME * max(one_mm, other_mm):
        return sides[0 if one_mm > other_mm else 1], "more is cut in its half of the sheet"
    one, other = _small_parts(nest, sides[0])
    if one != other:
        return sides[0 if one > other else 1], "more parts lie in its half of the sheet"
    return sides[0], "nothing tells the sides apart"


def _are_long(outers: Sequence[shapely.Polygon], ratio: float) -> NDArray[np.bool_]:
    """Which outlines fit in a rectangle, at any angle, with one side `ratio` times the other."""
    corners = shapely.get_coordinates(shapely.oriented_envelope(outers)).reshape(-1, 5, 2)
    one, other = (np.linalg.norm(corners[:, k + 1] - corners[:, k], axis=1) for k in (0, 1))
    return np.asarray(np.maximum(one, other) >= ratio * np.minimum(one, other) * (1 - SAME))


def _halves(nest: Nest, first: Side) -> tuple[Box, Box]:
    """Rectangles (xmin, ymin, xmax, ymax) over the half of the sheet at the first narrow side, and over the other.

    What lies on the line between them is in neither.
    """
    x0, y0, x1, y1 = nest.sheet.bounds
    far = x1 - x0 + y1 - y0
    a, b, c, d = x0 - far, y0 - far, x1 + far, y1 + far
    if first == "left":
        middle = (x0 + x1) / 2
        return (a, b, middle - ON_LINE_MM, d), (middle + ON_LINE_MM, b, c, d)
    middle = (y0 + y1) / 2
    return (a, b, c, middle - ON_LINE_MM), (a, middle + ON_LINE_MM, c, d)


def _cut_lengths(nest: Nest, first: Side) -> tuple[float, float]:
    """Length, mm, that is cut through in each half; marks are not, and scrap lines do not count."""
    lines = [c.line for c in nest.contours if c.shapes_part]
    one, other = (float(shapely.length(shapely.clip_by_rect(lines, *half)).sum()) for half in _halves(nest, first))
    return one, other


def _small_parts(nest: Nest, first: Side) -> tuple[int, int]:
    """Number of parts no larger than the median whose centroid lies in each half."""
    outers = [part.outer.polygon for part in nest.parts]
    areas = shapely.area(outers)
    centroids = shapely.centroid(outers)[areas <= np.median(areas) * (1 + SAME)]
    one, other = (shapely.contains(shapely.box(*half), centroids) for half in _halves(nest, first))
    return int(one.sum()), int(other.sum())
