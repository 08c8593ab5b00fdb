"""Rings and marks become parts by how they lie in each other."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.encoder.nest import Contour, Note, Part
from kerfwise.encoder.validate import coincident
from kerfwise.encoder.validate.metal import metal_of

from .depth import surrounding
from .drawing import DrawnCurve

HOLES = re.compile(r"hole|inner|inside|innen|loch|bohr|cut-?outs?$|отверст", re.IGNORECASE)
"""Layers that say that what is drawn on them is the inside of a part."""


def assemble(rings: Sequence[DrawnCurve], marks: Sequence[DrawnCurve] = ()) -> tuple[tuple[Part, ...], list[Note]]:
    """Parts P1, P2, … in the order their outer rings are drawn in, and notes on what was left out.

    A ring at even depth is the outside of a part, one at odd depth a hole of the part around it. Where rings overlap,
    so that one at odd depth lies in no part, it is a part, too: the check of the nest tells the overlap. A ring that is
    the same line as an earlier one is dropped; a mark belongs to the part that has most of it.
    """
    if not rings:
        return (), []
    repeats: dict[int, int] = {}
    for first, again in coincident([r.curve for r in rings]):
        repeats.setdefault(again, repeats.get(first, first))
    kept = [k for k in range(len(rings)) if k not in repeats]
    depth, parent = surrounding([rings[k].area for k in kept])
    odd = np.flatnonzero(depth % 2).tolist()
    stray = {n for n in odd if depth[parent[n]] % 2}  # only where rings overlap
    outers = [n for n, d in enumerate(depth.tolist()) if d % 2 == 0 or n in stray]
    holes: dict[int, list[int]] = {n: [] for n in outers}
    for n in odd:
        if n not in stray:
            holes[int(parent[n])].append(n)
    names, parts = {}, []
    for number, n in enumerate(outers, 1):
        part = f"P{number}"
        names[kept[n]] = f"{part}.outer"
        names |= {kept[h]: f"{part}.hole{k}" for k, h in enumerate(holes[n], 1)}
        inner = tuple(Contour(names[kept[h]], part, "hole", rings[kept[h]].curve) for h in holes[n])
        parts.append(Part(part, Contour(names[kept[n]], part, "outer", rings[kept[n]].curve), inner))
    notes = [_repeat(rings[k], rings[first], names[first]) for k, first in sorted(repeats.items())]
    marked, lost = with_marks(parts, marks)
    return marked, notes + lost


def _repeat(again: DrawnCurve, first: DrawnCurve, name: str) -> Note:
    """A note on a ring drawn twice; drawn once as a hole, by its layer, and once not, it is given to two parts."""
    text = f"the ring {again.place} is the same line as {name}; it is cut once, as {name}"
    if bool(HOLES.search(again.layer)) == bool(HOLES.search(first.layer)):
        return Note("warning", text, (name,))
    return Note("warning", text, (f"the ring on layer '{again.layer}'", name), common=True)


def with_marks(parts: Sequence[Part], marks: Sequence[DrawnCurve]) -> tuple[tuple[Part, ...], list[Note]]:
    """The parts with these marks, and notes on marks that are on no part."""
    if not marks:
        return tuple(parts), []
    metal = metal_of(parts)
    lines = np.array([m.curve.line() for m in marks], dtype=object)
    k, on = shapely.STRtree(metal).query(lines, predicate="intersects")
    shared = shapely.length(shapely.intersection(lines[k], metal[on]))
    most = np.lexsort((on, -shared, k))
    owner = {int(mark): int(part) for mark, part in zip(k[most][::-1], on[most][::-1], strict=True)}
    made: list[list[Contour]] = [[] for _ in parts]
    for n, mark in enumerate(marks):
        if n in owner:
            part, own = parts[owner[n]].id, made[owner[n]]
            own.append(Contour(f"{part}.mark{len(own) + 1}", part, "mark", mark.curve))
    lost = [
        Note("warning", f"the mark {m.place} is on no part: left out") for n, m in enumerate(marks) if n not in owner
    ]
    return tuple(Part(p.id, p.outer, p.holes, tuple(own)) for p, own in zip(parts, made, strict=True)), lost
