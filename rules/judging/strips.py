"""Strips: parts that lie in metal narrower than a strip between parts that are out.

Whether a part lies in one depends on nothing farther than the strip is wide.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints

from .metal import QUADRANT, Around, Badly, Metal

IN_STRIP = 0.5
"""A part lies in vanished metal if this share of its area does."""


class Strips:
    """The strips that form in the metal of one place while its parts are cut, each when `at` (parts,) says."""

    def __init__(self, metal: Metal, at: Ints) -> None:
        self.metal, self.at = metal, at
        self._in_strips = self._strips_begin()

    def take_out(self, p: int) -> Iterator[Badly]:
        """The parts that are in a strip once part `p` is out: see `Badly`."""
        for q in self._in_strips.get(p, ()):
            around = self.metal.around(q)
            out = np.flatnonzero(self.at[around.parts] <= self.at[p])
            yield "strip", self._fewest(q, around, out), [q]

    def _strips_begin(self) -> dict[int, list[int]]:
        """Part → the parts that are in a strip from when it is out.

        More parts out never widen a strip: what is in none just before it is cut itself was in none before.
        """
        metal, near = self.metal, self.metal.near
        before = self.at[near.part] < self.at[near.of]
        takers = np.flatnonzero(before & near.takes)
        begin = np.searchsorted(near.of[takers], np.arange(len(metal.parts) + 1)).tolist()
        rows = (takers[first:last] for first, last in pairwise(begin))
        asked = [q for q, row in enumerate(rows) if _two_sides(near.towards[row])]
        out = {q: before[near.begin[q] : near.begin[q + 1]] for q in asked}
        asked = [q for q in asked if not metal.wide.known(q, out[q])]
        found: dict[int, list[int]] = defaultdict(list)
        in_turn = {}
        for q in asked:
            parts = metal.around(q).parts[out[q]]
            in_turn[q] = parts[np.argsort(self.at[parts])]
        cores = np.array([metal.around(q).stiff for q in asked], dtype=object)
        for k in range(max(map(len, in_turn.values()), default=0)):
            some = np.array([m for m, q in enumerate(asked) if k < len(in_turn[q])])
            less = metal.swept[[in_turn[asked[m]][k] for m in some.tolist()]]
            cores[some] = shapely.difference(cores[some], less)
        vanished = self._vanished(np.array(asked, dtype=np.int64), cores) if asked else ()
        for q, lies_in_strip in zip(asked, vanished, strict=True):
            if lies_in_strip:
                found[self._first(q, in_turn[q])].append(q)
            else:
                metal.wide.note(q, out[q])
        return found

    def _first(self, q: int, parts: Ints) -> int:
        """The first of parts, cut one after the other, that leaves part `q` in a strip; the last one does."""
        around = self.metal.around(q)
        core, place = around.stiff, {part: k for k, part in enumerate(around.parts.tolist())}
        before, last = parts[:-1].tolist(), int(parts[-1])
        for k, p in enumerate(before, 1):
            core = shapely.difference(core, self.metal.swept[p])
            if self._on_both_sides(around, np.array([place[m] for m in before[:k]])) and bool(
                self._vanished(np.array([q]), np.array([core], dtype=object))[0]
            ):
                return int(p)
        return last

    @staticmethod
    def _on_both_sides(around: Around, out: Ints) -> bool:
        """Whether parts that take metal from the part lie in directions more than a right angle apart."""
        return _two_sides(around.towards[out[around.takes[out]]])

    def _vanished(self, parts: Ints, cores: Any) -> Bools:
        """Whether most of each part lies in metal that opening by half a strip leaves nothing of.

        `cores` is that metal less what parts that are out take of it, each grown by half a strip and half a web.
        """
        areas = self.metal.areas[parts]
        opened = shapely.buffer(cores, self.metal.strip_mm / 2, quad_segs=QUADRANT)
        return np.asarray(shapely.area(shapely.difference(areas, opened)) > IN_STRIP * self.metal.size[parts])

    def _would_vanish(self, q: int, around: Around, out: Ints) -> bool:
        """Whether part `q` would lie in vanished metal, were only these parts out."""
        core = around.stiff
        for k in around.parts[out]:  # the nearest take most, often all there is
            if core.is_empty:
                return True
            core = shapely.difference(core, self.metal.swept[k])
        return bool(self._vanished(np.array([q]), np.array([core], dtype=object))[0])

    def _fewest(self, q: int, around: Around, out: Ints) -> list[int]:
        """The parts without any of which part `q` would not be in a strip, tried from the farthest.

        More parts out never widen a strip, so that many are left out at once where the rest still makes one.
        """
        needed: list[int] = []
        stretches = [(0, len(out))]
        while stretches:
            begin, end = stretches.pop()
            without = np.concatenate([out[:begin], np.array(needed[::-1], dtype=np.int64)])
            if self._on_both_sides(around, without) and self._would_vanish(q, around, without):
                continue
            if end - begin == 1:
                needed.append(int(out[begin]))
            else:
                middle = (begin + end) // 2
                stretches += [(begin, middle), (middle, end)]
        return sorted(around.parts[needed].tolist())


def _two_sides(towards: Floats) -> bool:
    """Whether directions (k, 2) are more than a right angle apart."""
    return len(towards) > 1 and bool((towards @ towards.T < 0).any())
