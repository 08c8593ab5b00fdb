"""Strips packed by sparrow, the best engine known for them: of outlines alone, in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from importlib.util import find_spec

import shapely

from .pose import Placed, Pose
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
    strip: sparrow counts seconds.

    Raises
    ------
    SparrowFailed
        If its process ends without an answer, or is stopped.
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
    command = [sys.executable, "-m", "kerfwise.nesting.sparrow_child"]
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
        said = err.strip().splitlines()
        told = next((line for line in said if "panicked" in line or "Error" in line), said[-1] if said else "no word")
        raise SparrowFailed(f"its process ended with {child.returncode}: {told}") from None
    return answer
