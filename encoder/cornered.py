"""The nest with what its corners cost in time, where a profile has them cut more slowly."""

from __future__ import annotations

from dataclasses import replace

from .compensation import compensated
from .corner_feed import CornerFeed
from .errors import InputError
from .kept import kept_with_nest
from .nest import Contour, Nest, Part, with_parts


@kept_with_nest(most=4)
def with_corners(nest: Nest, law: CornerFeed, kerf_mm: float) -> Nest:
    """The nest whose contours know how much longer their corners take; it keeps the nest as drawn.

    Leads are not in it, nor is the corner that a contour may be entered at: no way of cutting it takes less.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> plate = nest(200, 100, part("A", rect(10, 10, 80, 60)))
    >>> with_corners(plate, CornerFeed(0.5, 45.0, 3.0), 0.0).contour("A.outer").corner_mm
    18.0
    """
    return with_parts(nest, tuple(_part(part, law, kerf_mm) for part in nest.parts))


def _part(part: Part, law: CornerFeed, kerf_mm: float) -> Part:
    outer = _contour(part.outer, law, kerf_mm)
    holes = tuple(_contour(hole, law, kerf_mm) for hole in part.holes)
    slits = tuple(_contour(slit, law, kerf_mm) for slit in part.slits)
    kept = zip((outer, *holes, *slits), (part.outer, *part.holes, *part.slits), strict=True)
    return part if all(new is old for new, old in kept) else replace(part, outer=outer, holes=holes, slits=slits)


def _contour(contour: Contour, law: CornerFeed, kerf_mm: float) -> Contour:
    try:
        path = compensated(contour, kerf_mm) if contour.encloses else contour.curve
    except InputError:  # the kerf leaves nothing of it: whoever plans the nest says so
        return contour
    entered_mm = 2 * law.reach_mm * (1 / law.share - 1) if path.closed else 0.0
    more_mm = law.more_mm(path) - entered_mm
    return replace(contour, corner_mm=more_mm) if more_mm > 0 else contour
