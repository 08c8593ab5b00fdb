"""The facts of what is left of a nest: those of the whole, less what is already cut.

Nothing is measured anew. Boundary that faces a part which is out faces neither a neighbour nor solid metal any more,
so that it counts as free; the start side and the zones are those of the whole sheet.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.already_cut import AlreadyCut, loose_contours, rest_of
from kerfwise.encoder.candidates.older_kerfs import OlderKerfs
from kerfwise.encoder.nest import Nest

from .containment import parents_of
from .facts import Facing, Facts, Past, Stretch
from .outlines import outlines_of


def loose_in(nest: Nest, out: frozenset[str]) -> dict[str, str]:
    """Contours that can no longer be cut, each with the contour around it that is out."""
    ids = [c.id for c in nest.contours]
    parents = parents_of(outlines_of(nest)).tolist()
    return loose_contours(nest, {ids[k]: ids[p] for k, p in enumerate(parents) if p >= 0}, out)


def remaining(whole: Facts, already: AlreadyCut) -> Facts:
    """The facts of what is left; only contours that are left may have candidates.

    Examples
    --------
    >>> from kerfwise.encoder.cut import Cut
    >>> from kerfwise.encoder.facts import FactOptions, compute_facts
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> row = [part(name, rect(10 + 100 * k, 10, 80, 80)) for k, name in enumerate("ABC")]
    >>> facts = compute_facts(nest(400, 100, *row), FactOptions())
    >>> left = remaining(facts, AlreadyCut((Cut("A.outer", (10, 10), "cw", (5, 10)),)))
    >>> [c.id for c in left.nest.contours], facts.level_ahead.tolist(), left.level_ahead.tolist()
    (['B.outer', 'C.outer'], [[0, 1], [0, 2], [1, 2]], [[0, 1]])
    """
    out = already.contours
    loose = loose_in(whole.nest, out)
    nest = rest_of(whole.nest, out | loose.keys())
    left = np.array([whole.nest.index[c.id] for c in nest.contours], dtype=np.int64)
    number = np.full(whole.n, -1, dtype=np.int64)
    number[left] = np.arange(len(left))

    def pairs(given: Ints) -> Ints:
        there = (number[given] >= 0).all(axis=1)
        return np.asarray(number[given[there]], dtype=np.int64).reshape(-1, 2)

    def facing(given: Facing, of_contours: bool) -> Facing:
        row = number[given.row] if of_contours else given.row
        there = (number[given.neighbour] >= 0) & (row >= 0)
        neighbour = number[given.neighbour[there]]
        return Facing(row[there], neighbour, given.length_mm[there], given.gap_mm[there])

    def stretch(given: Stretch) -> Stretch:
        return replace(given, neighbours=facing(given.neighbours, of_contours=False))

    def rings(given: Ints) -> Ints:
        """Kerfs of contours that are left; no candidate has been made over those that are out."""
        there = number[given[:, 1]] >= 0
        return np.column_stack([given[there, 0], number[given[there, 1]]])

    parent = whole.parent[left]
    candidates = tuple(replace(c, contour=int(number[c.contour])) for c in whole.candidates)
    return replace(
        whole,
        nest=nest,
        parent=np.where(parent >= 0, number[parent], -1),
        contains=pairs(whole.contains),
        level_ahead=pairs(whole.level_ahead),
        in_hull=pairs(whole.in_hull),
        neighbours=facing(whole.neighbours, of_contours=True),
        edge_gap_mm=whole.edge_gap_mm[left],
        edge_length_mm=whole.edge_length_mm[left],
        solid_mm=whole.solid_mm[left],
        long=whole.long[left],
        zone=whole.zone[left],
        torch_heat_kj=whole.torch_heat_kj[left],
        candidates=candidates,
        first=np.searchsorted(np.array([c.contour for c in candidates], dtype=np.int64), np.arange(len(left) + 1)),
        head=stretch(whole.head),
        tail=stretch(whole.tail),
        scrap_framed=whole.scrap_framed[left],
        scrap_beside=pairs(whole.scrap_beside),
        older_kerfs=OlderKerfs(rings(whole.older_kerfs.rings), whole.older_kerfs.leads),
        past=Past(whole, already, number, tuple(loose.items())),
    )
