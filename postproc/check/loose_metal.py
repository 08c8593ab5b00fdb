"""Burns in metal that has come loose, skeletons cut up as the profile asks, and bridges that hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import shapely

from kerfwise.encoder.cut import Side
from kerfwise.encoder.nest import Bridge, Contour, Nest
from kerfwise.rules.judging.holding import frame_of, is_in_frame, largest_of, wide_enough
from kerfwise.rules.judging.loose_metal import OVER_MM, Face, beside_metal, crumbs, loosened
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.profile.values import ProfileValues

from .gouging import SLACK_MM, metal_of_parts, part_metal
from .torch_run import TorchRun, tolerance_mm, torch_rings

# Burns in metal that has come loose, waste or part, whatever cut it off: seen from all kerfs in order of time.
#
# Whole rounds, rounds whose kerfs meet, common edges, links, leads and what was cut before a stop: metal that all of
# these together have cut off the frame of the sheet holds to nothing, and nothing may be burnt in it any more.

_RULE = "loose-metal"
_AT_MM = 1e-6
_KERF_MM = 0.02
"""What a torch without a kerf cuts apart."""


def cuts_in_loose_metal(
    nest: Nest, runs: Sequence[TorchRun], kerf_mm: float, before: Sequence[shapely.Geometry] = ()
) -> Iterator[Violation]:
    """Runs that burn metal which is loose when they begin; `before` are lines that were burnt before a stop."""
    torch = [run for run in runs if not run.marks]
    first = len(before)
    lines = [*before, *(shapely.union_all([run.loop, *run.leads]) for run in torch)]
    faces = loosened(shapely.make_valid(nest.sheet.polygon), lines, max(kerf_mm, _KERF_MM))
    if not faces:
        return
    areas = np.array([face.area for face in faces], dtype=object)
    kept = np.flatnonzero(~crumbs(areas)).tolist()
    faces, areas = [faces[k] for k in kept], areas[kept]
    since, gone = (np.array([getattr(face, name) for face in faces]) for name in ("since", "gone"))
    of, burnt = shapely.STRtree(lines).query(areas, "intersects")
    late = (since[of] < burnt) & (burnt <= gone[of]) & (burnt >= first)
    of, burnt = of[late], burnt[late]
    over = shapely.intersection(np.array(lines, dtype=object)[burnt], areas[of])
    over = beside_metal(over, metal_of_parts(nest), kerf_mm)
    over_mm = shapely.length(over)
    for k in np.unique(burnt).tolist():
        mine = np.flatnonzero(burnt == k)
        run = torch[k - first]
        begun = [] if run.linked else [j for j in mine.tolist() if shapely.dwithin(over[j], _begin(run), _AT_MM)]
        if over_mm[mine].sum() > OVER_MM or begun:
            j = int(max(mine.tolist(), key=lambda j: (j in begun, over_mm[j])))
            yield _violation(run, faces[of[j]], [None] * first + list(torch), float(over_mm[mine].sum()))


def _begin(run: TorchRun) -> shapely.Point:
    """Where the torch is lit."""
    return shapely.get_point(run.loop if run.lead_in is None else run.lead_in, 0)


def _violation(run: TorchRun, face: Face, runs: Sequence[TorchRun | None], over_mm: float) -> Violation:
    x, y = shapely.point_on_surface(face.area).coords[0]
    closed = runs[face.since]
    since = "what was cut before the stop" if closed is None else closed.where
    text = (
        f"{run.name} is cut in metal that is loose since {since}: the piece at ({x:z.1f}, {y:z.1f}) holds "
        f"to nothing any more, and {over_mm:.1f} mm are burnt in it"
    )
    return run.wrong(_RULE, text)


# Burns in pieces of the skeleton that scrap lines have cut off, seen from the kerfs themselves.
#
# From the first burn along a scrap line on, the sheet is looked at before each burn. The frame is the largest piece
# that the kerfs of all lines leave of the largest piece that those of all parts leave; leads do not tell which is
# larger. Before each burn the frame is part of some larger piece of metal, and only in that may be cut, or where the
# metal is narrower than the kerf and holds nothing anyway.


def cuts_in_loose_skeleton(
    nest: Nest, runs: Sequence[TorchRun], cut_contours: Sequence[Contour], kerf_mm: float
) -> Iterator[Violation]:
    """Contours that are cut, from the first scrap line on, in metal that does not hold to the frame.

    `cut_contours` were cut before a stop: their kerfs are there from the start.
    """
    torch = [run for run in runs if not run.marks]
    of_scrap = [run.contour is not None and run.contour.kind == "scrap" for run in torch]
    if kerf_mm <= 0 or not any(of_scrap):
        return
    lines = np.array([run.loop for run in torch], dtype=object)
    kerfs = shapely.buffer(lines, kerf_mm / 2, quad_segs=4)
    leads = [shapely.union_all(run.leads).buffer(kerf_mm / 2, quad_segs=4) for run in torch]
    begin = of_scrap.index(True) if not any(c.kind == "scrap" for c in cut_contours) else 0
    older = [ring.buffer(kerf_mm / 2, quad_segs=4) for ring in torch_rings(cut_contours, kerf_mm) if ring is not None]
    metal = shapely.make_valid(nest.sheet.polygon) - shapely.union_all([*older, *kerfs[:begin]])
    metal = wide_enough(metal, kerf_mm)
    parts = shapely.union_all(shapely.make_valid([part.outer.polygon for part in nest.parts]))
    along = np.array(of_scrap)
    skeleton = metal - shapely.union_all(kerfs[begin:][~along[begin:]]) - parts
    frame = frame_of(skeleton, shapely.union_all(kerfs[along]), kerf_mm)
    left = [] if frame is None else shapely.get_parts(frame - shapely.union_all(leads)).tolist()
    if not left:
        return
    inside = shapely.point_on_surface(max(left, key=lambda piece: piece.area))
    metal -= shapely.union_all(leads[:begin])
    for k, (run, line, kerf) in enumerate(zip(torch, lines.tolist(), kerfs.tolist(), strict=True)):
        if k < begin:
            continue
        if run.contour is not None and not is_in_frame(line, metal, inside, kerf_mm):
            x, y = shapely.line_interpolate_point(run.loop, 0.5, normalized=True).coords[0]
            text = f"{run.name} is cut at ({x:z.1f}, {y:z.1f}) in metal that is cut off the skeleton, and loose"
            yield run.wrong(_RULE, text)
        metal -= shapely.union(kerf, leads[k])


# Whether a skeleton is cut up as the profile asks, seen from the kerfs of the program alone.
#
# Where the lines lie that were made for it is not asked: what they leave is measured.

_PIECES_RULE = "scrap-pieces"
_SLACK_MM = 0.1
"""Chords, and the accuracy of programs."""
_NARROW_MM = 0.05
"""A web may be so much wider than the kerf, on either side, and still be no piece."""
_LEAST_PIECE_MM = 50.0
"""A remnant with a shorter side is not worth keeping."""
_FILLED = 0.995
"""A rectangle fills so much of its bounds."""


def wrong_pieces(
    nest: Nest, runs: Sequence[TorchRun], cut_contours: Sequence[Contour], profile: ProfileValues
) -> Iterator[Violation]:
    """Pieces of the skeleton that are larger than the grid asked for, and a remnant that is not saved.

    `cut_contours` were cut before a stop. Only the largest piece is looked at that the parts leave of the skeleton:
    what else came loose with them, before any line was cut, is not cut up, however large it is. Nor is metal narrower
    than the kerf: a line along it would leave nothing of it.
    """
    asked, kerf_mm = profile.cuts.scrap, profile.material.kerf_mm
    if kerf_mm <= 0 or (asked.grid_mm is None and asked.remnant is None):
        return
    rows = [(run.contour, shapely.union_all([run.loop, *run.leads])) for run in runs if not run.marks]
    rows += [
        (c, ring) for c, ring in zip(cut_contours, torch_rings(cut_contours, kerf_mm), strict=True) if ring is not None
    ]
    of_line = np.array([contour is not None and contour.kind == "scrap" for contour, _ in rows], dtype=np.bool_)
    burnt = shapely.buffer(np.array([line for _, line in rows], dtype=object), kerf_mm / 2, quad_segs=4)
    parts = shapely.make_valid([part.outer.polygon for part in nest.parts])
    gone = shapely.union_all(shapely.buffer(parts, kerf_mm, quad_segs=4))  # what tabs leave of a kerf is no piece
    half_mm = kerf_mm / 2 + _NARROW_MM
    skeleton = shapely.make_valid(nest.sheet.polygon) - gone
    skeleton = skeleton.buffer(-half_mm, quad_segs=4).buffer(half_mm, quad_segs=4) - shapely.union_all(burnt[~of_line])
    if skeleton.is_empty:
        return
    frame = largest_of(shapely.get_parts(skeleton).tolist())
    pieces = [p for p in shapely.get_parts(frame - shapely.union_all(burnt[of_line])) if p.area > kerf_mm**2]
    kept = None
    if asked.remnant is not None:
        kept = _along(pieces, asked.remnant, nest)
        if kept is None:
            text = f"no rectangle with sides of {_LEAST_PIECE_MM:g} mm or more is saved along the {asked.remnant} side"
            yield Violation(_PIECES_RULE, (), f"{text} (cuts.scrap.remnant)")
    for piece in pieces:
        x0, y0, x1, y1 = piece.bounds
        if asked.grid_mm is not None and piece is not kept and max(x1 - x0, y1 - y0) > asked.grid_mm + _SLACK_MM:
            at = shapely.point_on_surface(piece)
            text = f"a piece of the skeleton of {x1 - x0:.0f} × {y1 - y0:.0f} mm is left at ({at.x:z.1f}, {at.y:z.1f})"
            yield Violation(_PIECES_RULE, (), f"{text}, more than {asked.grid_mm:g} mm (cuts.scrap.grid)")


def _along(pieces: Sequence[shapely.Polygon], side: Side, nest: Nest) -> shapely.Polygon | None:
    """The largest rectangle among the pieces at a side of the sheet."""
    number = {"left": 0, "bottom": 1, "right": 2, "top": 3}[side]
    edge = nest.sheet.bounds[number]
    found = [
        piece
        for piece in pieces
        if abs(piece.bounds[number] - edge) < _SLACK_MM
        and piece.area > _FILLED * shapely.box(*piece.bounds).area
        and min(piece.bounds[2] - piece.bounds[0], piece.bounds[3] - piece.bounds[1]) > _LEAST_PIECE_MM - _SLACK_MM
    ]
    return max(found, key=lambda piece: piece.area, default=None)


# Bridges: parts that strips join hang together when all is cut, and the strips are what was drawn.

_BRIDGE_RULE = "bridges"
_SAME_MM = 0.02
"""What the chords of two outlines may make of where these lie."""


def broken_bridges(nest: Nest, runs: Sequence[TorchRun], kerf_mm: float) -> Iterator[Violation]:
    """Bridges that a kerf enters, or that the outline and holes which are cut do not have.

    The kerf of a third part enters the bridge that lies on it. The areas of parts and strips are put together here once
    more, from the parts and bridges as they were drawn.
    """
    if not nest.bridges:
        return
    metal = dict(zip((part.id for part in nest.apart), part_metal(nest.apart), strict=True))
    yield from _other_outlines(nest, metal)
    paths = [(run, line) for run in runs if not run.marks for line in (run.loop, *run.leads)]
    tree = shapely.STRtree([line for _, line in paths])
    reach_mm = kerf_mm / 2 - tolerance_mm(kerf_mm) - SLACK_MM
    for bridge in nest.bridges:
        strip = _strip(bridge)
        for k in sorted(tree.query(strip, "dwithin", distance=max(reach_mm, 0.0)).tolist()):
            run, line = paths[k]
            x, y = shapely.get_coordinates(shapely.shortest_line(line, strip))[0].tolist()
            text = f"the kerf of {run.name} enters {bridge.name} at ({x:z.1f}, {y:z.1f})"
            yield run.wrong(_BRIDGE_RULE, text)
            break


def _other_outlines(nest: Nest, metal: Mapping[str, shapely.Geometry]) -> Iterator[Violation]:
    """What is cut round against what is drawn, both as areas: outlines, then holes and waste that bridges enclose.

    Holes are those of the drawing: a profile may have small ones marked, or left out.
    """
    parts = [part for part in nest.parts if part.id not in metal]
    with_all_holes = {part.id: part for part in (nest.drawn or nest).parts}
    for group in _groups(nest.bridges):
        names = dict.fromkeys(name for bridge in group for name in bridge.parts)
        strips = [shapely.buffer(_strip(bridge), _SAME_MM, join_style="mitre") for bridge in group]
        meant = shapely.union_all([*(metal[name] for name in names), *strips])
        outline = shapely.union_all([shapely.Polygon(area.exterior) for area in shapely.get_parts(meant)])
        apart = [shapely.symmetric_difference(outline, part.outer.polygon) for part in parts]
        k = min(range(len(parts)), key=lambda k: float(apart[k].area))
        holes = shapely.union_all([shapely.make_valid(h.polygon) for h in with_all_holes[parts[k].id].holes])
        other_holes = shapely.symmetric_difference(shapely.difference(outline, meant), holes)
        outer = parts[k].outer.id
        for wrong, text in (
            (apart[k], f"{outer} is not the outline of its parts and bridges"),
            (other_holes, f"the holes in {outer} are not those that its parts and bridges leave"),
        ):
            if not shapely.is_empty(rest := shapely.buffer(wrong, -2 * _SAME_MM)):
                at = shapely.point_on_surface(rest)
                yield Violation(_BRIDGE_RULE, (outer,), f"{text} at ({at.x:z.1f}, {at.y:z.1f})")


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
