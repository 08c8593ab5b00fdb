"""Facts with candidates set by hand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kerfwise import Nest
from kerfwise.encoder.facts import compute_facts
from kerfwise.rule_kit import Candidate, Direction, FactOptions, Facts, Point

Way = tuple[Point, Direction, Point]


def facts_with(sheet: Nest, ways: Mapping[str, Sequence[Way]], options: FactOptions | None = None) -> Facts:
    """The facts of a sheet, each contour having the candidates (entry, direction, pierce) given for it."""
    facts = compute_facts(sheet, options or FactOptions(), ())
    made = [
        Candidate(k, contour.curve.project(entry)[0], entry, direction, pierce, None, None, entry, 0.0)
        for k, contour in enumerate(sheet.contours)
        for entry, direction, pierce in ways.get(contour.id, ())
    ]
    first = np.searchsorted([c.contour for c in made], np.arange(len(sheet.contours) + 1)).astype(np.int64)
    return replace(facts, candidates=tuple(made), first=first)
