"""All facts of a nest, family after family."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.candidates.older_kerfs import OlderKerfs, older_kerfs
from kerfwise.encoder.nest import Nest

from .cells import cells_of
from .containment import closure_of, parents_of
from .facts import FactOptions, Facts
from .heat import heat
from .hulls import in_hull
from .long_parts import long_parts
from .neighbours import outlook_of, surroundings_of
from .offcut import edge_gaps, offcuts
from .outlines import outlines_of
from .shadows import level_ahead
from .skeleton import skeleton_of
from .start_side import start_side
from .stretches import runs_of, stretch_of
from .zones import respected_orders, zones_of


def compute_facts(
    nest: Nest,
    options: FactOptions,
    candidates: Sequence[Candidate] = (),
    heat_kj: Floats | None = None,
    met: OlderKerfs | None = None,
) -> Facts:
    """The facts of a nest and of the candidates of its contours.

    Parameters
    ----------
    nest
        A validated nest.
    options
        Thresholds, and what a profile fixes.
    candidates
        Sorted by contour index; may be empty.
    heat_kj
        The most heat that cutting each contour leaves in the sheet, (n,), which the machine and the material decide.
    met
        What the candidates meet of cuts made before them under the same options, where that is known already.

    Raises
    ------
    InputError
        If `options` name contours or parts that the nest does not have, or zones that contradict each other.
    ValueError
        If `options` give a zone a budget of heat, but `heat_kj` is missing.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> two = nest(400, 100, part("A", rect(10, 10, 80, 80)), part("B", rect(100, 10, 80, 80)))
    >>> facts = compute_facts(two, FactOptions())
    >>> facts.start_side, facts.start_side_because, facts.level_ahead.tolist()
    ('left', 'offcut', [[0, 1]])
    """
    if heat_kj is None:
        if options.zone_heat_kj is not None:
            raise ValueError("zones have a budget of heat, but the heat of the contours is not given")
        heat_kj = np.full(len(nest.contours), np.nan)
    outlines, sheet_mm = outlines_of(nest), nest.sheet.bounds
    parent = parents_of(outlines)
    contains = closure_of(parent)

    is_long = long_parts(outlines, options.long_ratio)
    edge_gap_mm = edge_gaps(outlines, sheet_mm)
    offcut_mm, offcut_large = offcuts(edge_gap_mm[outlines.outers], sheet_mm, options.offcut_share)
    heat_mm, heat_parts = heat(outlines, sheet_mm)
    side, because = start_side(sheet_mm, options, is_long, edge_gap_mm, offcut_large, heat_mm, heat_parts)

    ahead = level_ahead(outlines, parent, side)
    hull = in_hull(outlines, parent)
    respected = respected_orders(contains, ahead, hull, options)
    zone = zones_of(nest, outlines, parent, side, respected, options, heat_kj)

    outlook = outlook_of(outlines, parent, nest.sheet, cells_of(outlines), options)
    surroundings = surroundings_of(outlines, parent, outlook)
    runs, skeleton = runs_of(outlook), skeleton_of(nest, options.kerf_mm)
    contour = np.fromiter((c.contour for c in candidates), np.int64, len(candidates))
    return Facts(
        nest=nest,
        options=options,
        parent=parent,
        contains=contains,
        start_side=side,
        start_side_because=because,
        level_ahead=ahead,
        in_hull=hull,
        neighbours=surroundings.neighbours,
        edge_gap_mm=edge_gap_mm,
        edge_length_mm=surroundings.edge_length_mm,
        solid_mm=surroundings.solid_mm,
        long=is_long,
        offcut_mm=offcut_mm,
        offcut_large=offcut_large,
        heat_mm=heat_mm,
        heat_parts=heat_parts,
        zone=zone,
        torch_heat_kj=heat_kj,
        candidates=tuple(candidates),
        first=np.searchsorted(contour, np.arange(outlines.n + 1)),
        head=stretch_of(outlines, runs, candidates, options.head_share, "head"),
        tail=stretch_of(outlines, runs, candidates, options.tail_share, "tail"),
        older_kerfs=_older_kerfs(nest, options, candidates, met),
        scrap_framed=skeleton.framed,
        scrap_beside=skeleton.beside,
    )


def _older_kerfs(
    nest: Nest, options: FactOptions, candidates: Sequence[Candidate], met: OlderKerfs | None
) -> OlderKerfs:
    if options.splash_mm is None:
        return OlderKerfs.none()
    return older_kerfs(nest, candidates, options.kerf_mm, options.splash_mm) if met is None else met
