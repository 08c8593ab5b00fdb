"""The facts of what is left of a nest: those of the whole, less what is already cut.

Nothing is measured anew. Boundary that faces a part which is out faces neither a neighbour nor solid metal any more,
so that it counts as free; the start side and the zones are those of the whole sheet.
"""

from __future__ import annotations

from dataclasses import replace

from kerfwise.encoder.already_cut import AlreadyCut, loose_contours, rest_of
from kerfwise.encoder.nest import Nest

from .containment import parents_of
from .facts import Facts, Past
from .narrowed import narrowed, numbered
from .outlines import outlines_of


def loose_in(nest: Nest, out: frozenset[str]) -> dict[str, str]:
    """Contours that can no longer be cut, each with the contour around it that is out."""
    if not out:
        return {}
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
    number = numbered(whole.n, [whole.nest.index[c.id] for c in nest.contours])
    return replace(narrowed(whole, nest, number), past=Past(whole, already, number, tuple(loose.items())))
