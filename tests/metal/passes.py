"""Pierce passes in the simulation: which burn begins at which hole, what begins at none, and which hole nobody uses."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import shapely

from kerfwise.tests.metal.burns import Burn
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.tolerances import RING_MM

AT_HOLE_MM = 0.05


def holes_of(burns: Sequence[Burn]) -> dict[int, int]:
    """The place of a burn → that of the hole which it begins at: an earlier burn that stood there and did not move."""
    free = [k for k, burn in enumerate(burns) if _is_hole(burn)]
    found: dict[int, int] = {}
    for k, burn in enumerate(burns):
        if _is_hole(burn) or burn.linked:
            continue
        at = next((h for h in free if h < k and math.dist(burns[h].pierce, burn.pierce) <= AT_HOLE_MM), None)
        if at is not None:
            free.remove(at)
            found[k] = at
    return found


def wrong_passes(
    burns: Sequence[Burn], own: Mapping[int, int], sheet: shapely.Polygon, kerf_starts: bool = False
) -> Iterator[Finding]:
    """Cuts that begin in metal where no hole is, and holes at which no cut begins.

    With `kerf_starts` a cut may begin in the middle of an older kerf, without a hole.
    """
    used = set(own.values())
    for k, burn in enumerate(burns):
        if _is_hole(burn):
            if k not in used:
                yield Finding(
                    "pierce-unused", burn.cut, (burn.name,), burn.pierce, 0.0, "", "no cut begins at the hole"
                )
        elif k not in own and not burn.linked and _in_metal(burn, sheet):
            at = shapely.Point(burn.pierce)
            if kerf_starts and any(at.distance(older.line) <= RING_MM for older in burns[:k] if not _is_hole(older)):
                continue
            yield Finding("not-pierced", burn.cut, (burn.name,), burn.pierce, 0.0, "", "it begins at no hole")


def _is_hole(burn: Burn) -> bool:
    return len(burn.path.points) == 1


def _in_metal(burn: Burn, sheet: shapely.Polygon) -> bool:
    """Whether it has to be pierced: not off the sheet, and no scrap line, which begins in a void."""
    scrap = burn.contour is not None and burn.contour.kind == "scrap"
    return not scrap and bool(sheet.contains(shapely.Point(burn.pierce)))
