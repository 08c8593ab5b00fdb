"""Links: what the torch burns of waste from one contour to the next, without going off."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import shapely

from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Violation

from .program_rules import tolerance_mm, written_from_profile
from .torch_run import TorchRun

_RULE = "links"
_CORNERS_MM = 1.0
"""Leads are longer than the profile says by what their arcs and the places where they meet the ring add."""
_OTHERS_MM = 25.0
"""How much longer leads of programs may be that were not written from the profile: what others do is no fault yet."""


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


def long_leads(
    runs: Sequence[TorchRun], profile: Profile, comments: Iterable[str], run_up_mm: float
) -> Iterator[Violation]:
    """Where the torch stays lit before or behind a contour for longer than a lead or an overcut asks for.

    What it burns there of its own ring again is told as that. `run_up_mm` is how far off the sheet a cut may begin.
    """
    ours = written_from_profile(comments)
    leads, kerf_mm = profile.leads, profile.material.kerf_mm
    more_mm = 2 * kerf_mm + _CORNERS_MM + (0.0 if ours else _OTHERS_MM)
    in_mm = 1.6 * max(profile.length_mm(leads.lead_in_mm), leads.lead_in_min_mm) + run_up_mm + more_mm
    out_mm = max(profile.length_mm(leads.hole_overcut_mm), leads.lead_out_length_mm) + more_mm
    within_mm = tolerance_mm(kerf_mm)
    for run in runs:
        if run.marks or run.contour is None or not run.contour.encloses:
            continue
        for what, lead, most_mm in (("before", run.lead_in, in_mm), ("behind", run.lead_out, out_mm)):
            if lead is None or lead.length <= most_mm or (what == "before" and run.linked):
                continue
            again_mm = float(lead.intersection(shapely.buffer(run.loop, within_mm)).length)
            at = (run.position,) if run.position else ()
            text = f"{run.where}: the torch is lit for {lead.length:.1f} mm {what} {run.name}"
            if again_mm > most_mm:
                text += f", {again_mm:.1f} mm of them once more along it"
            yield Violation(
                _RULE, (run.contour.id,), f"{text}; the profile's leads and overcuts ask for {most_mm:.1f} mm", at
            )
