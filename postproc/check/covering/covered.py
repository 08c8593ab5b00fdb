"""When burns have covered a ring: a contour is out when its whole torch ring is burnt, but for its tabs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely

from kerfwise.arrays import Floats

from .chords import Chords, chords_of_lines
from .intervals import NONE, both, closed_up, minus, rest, total_mm, union
from .near import Near, near


@dataclass(frozen=True, eq=False, slots=True)
class Covered:
    """What burns make of one ring, all places in mm along the ring.

    `out` is the burn with which the ring is covered, and how far along that burn; None where stretches are left `open`.
    `new` is what each burn covers first, `again` what it runs along although it was burnt by another before, and
    `until_mm` how far along a burn it leaves the ring for good.
    """

    out: tuple[int, float] | None
    open: tuple[tuple[float, float], ...]
    new: Mapping[int, Floats]
    again: Mapping[int, Floats] = field(default_factory=dict)
    until_mm: Mapping[int, float] = field(default_factory=dict)

    def numbered(self, burns: Sequence[int]) -> Covered:
        """The same, with the numbers that burns have elsewhere."""
        out = None if self.out is None else (burns[self.out[0]], self.out[1])
        new, again = ({burns[k]: rows for k, rows in of.items()} for of in (self.new, self.again))
        return Covered(out, self.open, new, again, {burns[k]: mm for k, mm in self.until_mm.items()})

    @property
    def open_mm(self) -> float:
        """How much is left open."""
        return sum(high - low for low, high in self.open)


def covered(
    rings: Sequence[shapely.LineString], free: Sequence[Floats], burns: Chords, within_mm: float
) -> list[Covered]:
    """What burns, in order of time, cover of each ring.

    Parameters
    ----------
    rings
        Lines round which the torch's centre has to go, each closed.
    free
        For each ring the stretches that nobody has to burn (see `intervals`).
    burns
        The torch's paths, by number in the order in which they are burnt.
    within_mm
        How far a burn may be from a ring that it covers.

    Returns
    -------
    One answer a ring. Stretches of less than `within_mm` do not count as open.
    """
    found = near(chords_of_lines(rings), burns, within_mm)
    first = np.searchsorted(found.line, np.arange(len(rings) + 1))
    return [
        _of_ring(found.only(np.arange(first[k], first[k + 1])), float(ring.length), free[k], within_mm)
        for k, ring in enumerate(rings)
    ]


def _of_ring(rows: Near, length_mm: float, free: Floats, slack_mm: float) -> Covered:
    held, burnt = free, NONE
    new: dict[int, Floats] = {}
    again: dict[int, Floats] = {}
    until_mm: dict[int, float] = {}
    out: tuple[int, float] | None = None
    for burn in np.unique(rows.other).tolist():
        mine = rows.only(rows.other == burn)
        own = union(np.stack([mine.low_mm, mine.high_mm], axis=1))
        if total_mm(fresh := minus(own, burnt)) > 0:
            new[burn] = fresh
            until_mm[burn] = float(np.maximum(mine.other_low_mm, mine.other_high_mm).max())
        if total_mm(twice := both(own, burnt)) > 0:
            again[burn] = twice
        now = union(np.concatenate([held, own]))
        if out is None and not _left(now, length_mm, slack_mm):
            out = burn, _when(mine, held, length_mm, slack_mm)
        held, burnt = now, union(np.concatenate([burnt, own]))
    return Covered(out, tuple(_left(held, length_mm, slack_mm)), new, again, until_mm)


def _left(held: Floats, length_mm: float, slack_mm: float) -> list[tuple[float, float]]:
    """What of a ring counts as open."""
    left = closed_up(rest(held, length_mm), length_mm)
    return [(low, high) for low, high in left if high - low > slack_mm]


def _when(mine: Near, held: Floats, length_mm: float, slack_mm: float) -> float:
    """How far along a burn the ring is covered, `held` being covered before."""
    done_mm = np.maximum(mine.other_low_mm, mine.other_high_mm)
    order = np.argsort(done_mm, kind="stable")
    mine, done_mm = mine.only(order), done_mm[order]
    rows = np.stack([mine.low_mm, mine.high_mm], axis=1)

    def after(count: int) -> Floats:
        return union(np.concatenate([held, rows[:count]]))

    low, high = 0, len(rows)
    while low < high:
        middle = (low + high) // 2
        if _left(after(middle), length_mm, slack_mm):
            low = middle + 1
        else:
            high = middle
    if low == 0:
        return float(done_mm[0])
    last = low - 1
    lacking = both(rest(after(last), length_mm), rows[last : last + 1])
    if not len(lacking) or rows[last, 1] - rows[last, 0] < 1e-9:
        return float(done_mm[last])
    at = np.interp(lacking.ravel(), rows[last], [mine.other_low_mm[last], mine.other_high_mm[last]])
    return float(at.max())
