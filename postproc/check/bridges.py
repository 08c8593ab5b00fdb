"""Bridges: parts that strips join hang together when all is cut, and the strips are what was drawn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import shapely

from kerfwise.encoder.bridges.bridge import Bridge
from kerfwise.encoder.nest import Nest
from kerfwise.rules.rule import Violation

from .metal import SLACK_MM, every_metal_of
from .program_rules import tolerance_mm
from .torch_run import TorchRun

_RULE = "bridges"
_SAME_MM = 0.02
"""What the chords of two outlines may make of where these lie."""


def broken_bridges(nest: Nest, runs: Sequence[TorchRun], kerf_mm: float) -> Iterator[Violation]:
    """Bridges that a kerf enters, that meet a third part, or that the outline and holes which are cut do not have.

    The areas of parts and strips are put together here once more, from the parts and bridges as they were drawn.
    """
    if not nest.bridges:
        return
    metal = dict(zip((part.id for part in nest.apart), every_metal_of(nest.apart), strict=True))
    yield from _third_parts(nest, metal)
    yield from _other_outlines(nest, metal)
    paths = [(run, line) for run in runs if not run.marks for line in (run.loop, *run.leads)]
    tree = shapely.STRtree([line for _, line in paths])
    reach_mm = kerf_mm / 2 - tolerance_mm(kerf_mm) - SLACK_MM
    for bridge in nest.bridges:
        strip = _strip(bridge)
        for k in sorted(tree.query(strip, "dwithin", distance=max(reach_mm, 0.0)).tolist()):
            run, line = paths[k]
            x, y = shapely.get_coordinates(shapely.shortest_line(line, strip))[0].tolist()
            text = f"{run.where}: the kerf of {run.name} enters {bridge.name} at ({x:z.1f}, {y:z.1f})"
            names = () if run.contour is None else (run.contour.id,)
            yield Violation(_RULE, names, text, (run.position,) if run.position else ())
            break


def _third_parts(nest: Nest, metal: Mapping[str, shapely.Geometry]) -> Iterator[Violation]:
    for bridge in nest.bridges:
        for part in nest.apart:
            if part.id not in bridge.parts and shapely.intersects(_strip(bridge), metal[part.id]):
                yield Violation(
                    _RULE, (part.outer.id,), f"{bridge.name} lies on part {part.id}, which it does not join"
                )


def _other_outlines(nest: Nest, metal: Mapping[str, shapely.Geometry]) -> Iterator[Violation]:
    """What is cut round against what is drawn, both as areas: outlines, then holes and waste that bridges enclose.

    Holes are those of the drawing: a profile may have small ones marked, or left out.
    """
    made = [part for part in nest.parts if part.id not in metal]
    with_all_holes = {part.id: part for part in (nest.drawn or nest).parts}
    for group in _groups(nest.bridges):
        names = dict.fromkeys(name for bridge in group for name in bridge.parts)
        strips = [shapely.buffer(_strip(bridge), _SAME_MM, join_style="mitre") for bridge in group]
        meant = shapely.union_all([*(metal[name] for name in names), *strips])
        outline = shapely.union_all([shapely.Polygon(area.exterior) for area in shapely.get_parts(meant)])
        apart = [shapely.symmetric_difference(outline, part.outer.polygon) for part in made]
        k = min(range(len(made)), key=lambda k: float(apart[k].area))
        holes = shapely.union_all([shapely.make_valid(h.polygon) for h in with_all_holes[made[k].id].holes])
        other_holes = shapely.symmetric_difference(shapely.difference(outline, meant), holes)
        outer = made[k].outer.id
        for wrong, text in (
            (apart[k], f"{outer} is not the outline of its parts and bridges"),
            (other_holes, f"the holes in {outer} are not those that its parts and bridges leave"),
        ):
            if not shapely.is_empty(rest := shapely.buffer(wrong, -2 * _SAME_MM)):
                at = shapely.point_on_surface(rest)
                yield Violation(_RULE, (outer,), f"{text} at ({at.x:z.1f}, {at.y:z.1f})")


def _strip(bridge: Bridge) -> shapely.Polygon:
    """The rectangle that a bridge is, made anew: a wrong one would be scrap."""
    return shapely.buffer(shapely.LineString([bridge.start, bridge.end]), bridge.width_mm / 2, cap_style="flat")


def _groups(bridges: Sequence[Bridge]) -> list[list[Bridge]]:
    """Bridges whose parts hang together."""
    groups: list[list[Bridge]] = []
    for bridge in bridges:
        with_it = [group for group in groups if any(set(bridge.parts) & set(other.parts) for other in group)]
        groups = [group for group in groups if group not in with_it]
        groups.append([bridge, *(other for group in with_it for other in group)])
    return groups
