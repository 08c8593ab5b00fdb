"""Strips packed by sparrow, the best engine known for them: of outlines alone, in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from importlib.util import find_spec

import shapely

from .demand import Demand
from .fill import LEFT, Room, fill, largest_first, usable
from .layout import Layout, Sheetful, allot
from .nofit import Placed, Pose
from .shapes import Shapes

_SPARE_MM = 0.02
"""Outlines are grown by so much more, as sparrow counts in single precision."""
_LATE_S = 15.0
_LOOK_S = 0.2
WORKERS = 2


class SparrowFailed(Exception):
    """Sparrow gave no answer; the text says why."""


def installed() -> bool:
    """Whether spyrrow can be imported; it is not, here."""
    return find_spec("spyrrow") is not None


def packed(
    shapes: Shapes,
    counts: Mapping[int, int],
    height_mm: float,
    seconds: float,
    seed: int,
    going: Callable[[], bool] = lambda: True,
) -> tuple[Placed, ...]:
    """Pack so many parts of each type on a strip of that height, as short as can be found in so many seconds.

    The strip's corner is at the origin. Holes are not seen, and no part is turned over. The same seed may give another
    strip: sparrow counts seconds. Raises SparrowFailed if its process ends without an answer, or is stopped.
    """
    items = []
    for kind, count in counts.items():
        taken = shapely.Polygon(shapes.shape((kind, Pose())).taken.exterior).buffer(_SPARE_MM, join_style="mitre")
        corners = shapely.get_coordinates(taken)[:-1].tolist()
        turns = [pose.turn_deg for pose in shapes.poses(kind) if not pose.mirrored]
        items.append({"id": str(kind), "points": corners, "demand": count, "turns": turns})
    task = {"items": items, "height": height_mm, "seconds": seconds, "seed": seed, "workers": WORKERS}
    answer = _asked(json.dumps(task), seconds, going)
    return tuple(Placed(int(name), Pose(turn % 360.0), dx, dy) for name, turn, dx, dy in answer["placed"])


def _asked(task: str, seconds: float, going: Callable[[], bool]) -> dict:  # type: ignore[type-arg]
    """The answer of the process."""
    command = [sys.executable, "-m", "kerfwise.apps.nesting.placement.sparrow_child"]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True, encoding="utf-8") as child:
        ends = time.monotonic() + seconds + _LATE_S
        out, err, given = "", "", task or None
        try:
            while True:
                try:
                    out, err = child.communicate(given, timeout=_LOOK_S)
                    break
                except subprocess.TimeoutExpired:
                    given = None
                    if not going():
                        raise SparrowFailed("it was stopped") from None
                    if time.monotonic() > ends:
                        raise SparrowFailed("it did not end in time") from None
        finally:
            child.kill()
    try:
        answer: dict[str, object] = json.loads(out)
    except ValueError:
        lines = err.strip().splitlines()
        message = next(
            (line for line in lines if "panicked" in line or "Error" in line), lines[-1] if lines else "no word"
        )
        raise SparrowFailed(f"its process ended with {child.returncode}: {message}") from None
    return answer


# A layout made denser by sparrow: sheet after sheet packed as a strip, cut off at its end, and filled up.

Tell = Callable[[str], None]
_LEAST_S = 2.0


def compact_layout(
    layout: Layout,
    shapes: Shapes,
    seconds: float,
    seed: int,
    tell: Tell,
    going: Callable[[], bool] = lambda: True,
) -> Layout:
    """The layout, or a better one: what sparrow packs is kept only where the sheet holds more metal, or is shorter.

    Only rectangular sheets are packed anew. Where sparrow fails, that is told, and the layout stays as it is.
    """
    ends, done, rest = time.monotonic() + seconds, list[Sheetful](), layout
    while rest.sheets and going():
        here = rest.sheets[0]
        if _rectangle(here):
            share_s = (ends - time.monotonic()) / len(rest.sheets)
            if share_s < _LEAST_S:
                break
            try:
                here = _packed(rest, shapes, share_s, seed, going)
            except SparrowFailed as failed:
                tell(f"sparrow: {failed}; the layout of kerfwise itself stays")
                break
        done.append(here)
        rest = _without(rest, here, done, shapes)
    packed = replace(layout, sheets=(*done, *rest.sheets))
    return packed if packed.score < layout.score else layout


def _rectangle(sheet: Sheetful) -> bool:
    x0, y0, x1, y1 = sheet.stock.sheet.bounds
    return abs(sheet.stock.area_mm2 - (x1 - x0) * (y1 - y0)) < 1e-6 * sheet.stock.area_mm2


def _packed(rest: Layout, shapes: Shapes, seconds: float, seed: int, going: Callable[[], bool]) -> Sheetful:
    """The first sheet of a layout packed anew, parts of later ones laid where that leaves room; or as it was."""
    here, wanted = rest.sheets[0], rest.wanted
    ground = usable(here.stock.sheet, rest.spacing)
    x0, y0, _, y1 = ground.bounds
    later = [one.kind for sheet in rest.sheets[1:] for one in sheet.placed]
    counts = Counter(one.kind for one in here.placed if not _lies_in_hole(one, here.placed, wanted))
    strip = packed(shapes, counts, y1 - y0, seconds, seed, going)
    room = Room(shapes, here.stock.sheet, rest.spacing)
    for one in sorted(strip, key=lambda one: _right(one, shapes)):
        room.put((one.kind, one.pose), (one.dx_mm + x0, one.dy_mm + y0))
    left = Counter(one.kind for one in here.placed) + Counter(later)
    left.subtract(one.kind for one in room.placed)
    fill(room, largest_first(shapes, sorted(left)), +left, LEFT)
    full = replace(here, placed=tuple(room.placed))
    more = full.metal_mm2(wanted) > here.metal_mm2(wanted) * (1 + 1e-9)
    if more or (not later and len(full.placed) == len(here.placed) and _reach(full, shapes) < _reach(here, shapes)):
        return full
    return here


def _lies_in_hole(one: Placed, others: Sequence[Placed], wanted: Demand) -> bool:
    """Whether a part lies in a hole of another: sparrow sees no holes."""
    middle = one.area(wanted.types[one.kind].part.polygon).representative_point()
    hosts = (other for other in others if other is not one and wanted.types[other.kind].part.holes)
    return any(host.area(wanted.types[host.kind].part.outer.polygon).covers(middle) for host in hosts)


def _right(one: Placed, shapes: Shapes) -> float:
    return float(shapes.shape((one.kind, one.pose)).taken.bounds[2] + one.dx_mm)


def _reach(sheet: Sheetful, shapes: Shapes) -> float:
    return max(_right(one, shapes) for one in sheet.placed)


def _without(rest: Layout, here: Sheetful, done: Sequence[Sheetful], shapes: Shapes) -> Layout:
    """The rest of a layout after a sheet: laid anew where that sheet took more of it than before."""
    was = Counter(one.kind for one in rest.sheets[0].placed)
    now = Counter(one.kind for one in here.placed)
    tail = replace(rest, sheets=rest.sheets[1:])
    if was == now:
        return tail
    total = was + Counter(one.kind for sheet in tail.sheets for one in sheet.placed)
    left = total - now
    used = Counter(sheet.number for sheet in done)
    kinds = [kind for kind in largest_first(shapes, range(len(shapes.types))) if left[kind]]
    layout = allot(tail.wanted, shapes, tail.spacing, kinds, LEFT, left=left, gone=used)
    return replace(tail, sheets=layout.sheets)
