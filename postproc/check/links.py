"""Links: what the torch burns of waste from one contour to the next, without going off."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import shapely

from kerfwise.rules.rule import Violation

from .program_rules import tolerance_mm
from .torch_run import TorchRun

_RULE = "links"


def bad_links(runs: Sequence[TorchRun], kerf_mm: float, longest_mm: float) -> Iterator[Violation]:
    """Links that the profile does not allow, and those that cross a kerf that was burnt before.

    At both ends a link is in the kerf of the contour that it leaves, and of the one that it leads to.
    """
    linked = [k for k, run in enumerate(runs) if run.linked and k]
    if not linked:
        return
    lines = [(k, line) for k, run in enumerate(runs) if not run.marks for line in (run.loop, *run.leads)]
    tree = shapely.STRtree([line for _, line in lines])
    half_mm, within_mm = kerf_mm / 2, tolerance_mm(kerf_mm)
    for k in linked:
        run, before = runs[k], runs[k - 1]
        link = run.lead_in
        if link is None:
            continue
        length_mm = float(link.length)
        way = f"{run.where}: the link from {before.name} to {run.name}"
        place = f"at ({link.coords[0][0]:z.1f}, {link.coords[0][1]:z.1f})"
        at = (run.position,) if run.position else ()
        names = tuple(dict.fromkeys(r.contour.id for r in (before, run) if r.contour is not None))
        if length_mm > longest_mm + within_mm:
            text = f"{way} {place} is {length_mm:.1f} mm long: the profile allows "
            text += f"{longest_mm:g} mm" if longest_mm > 0 else "no links"
            yield Violation(_RULE, names, f"{text} (cuts.links.longest)", at)
            continue
        ends = shapely.buffer(shapely.points([link.coords[0], link.coords[-1]]), kerf_mm)
        left = [before.loop, *(() if before.linked else before.leads)]  # as a lead-out may, beside its own lead-in
        rings = shapely.buffer([*left, run.loop], half_mm + within_mm)
        free = shapely.difference(link, shapely.union_all([*ends, *rings]))
        if free.is_empty:
            continue
        for number in sorted(tree.query(free, "dwithin", distance=half_mm - within_mm).tolist()):
            other, line = lines[number]
            if other < k and all(line is not one for one in left):
                x, y = shapely.get_coordinates(shapely.shortest_line(free, line))[0].tolist()
                text = f"{way} crosses the kerf of {runs[other].name} ({runs[other].where}), at ({x:z.1f}, {y:z.1f})"
                yield Violation(_RULE, names, text, at)
                break
