"""The simulation in layers: what tilted torches burn at each depth, by arithmetic of its own.

It shares nothing with the planner, the check or the reader of programs: it has the drawing, the thickness, the
kerfs and the words of the program, which it runs as LinuxCNC does, or by those of EIA's manual. A jet is a line through
the metal. At each depth it burns a disc, and discs must meet no part, leave no face standing, and lie on the sheet.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from kerfwise import Nest, Profile
from kerfwise.encoder.bevels.bevel import Bevel
from kerfwise.encoder.geometry.segment import Segment
from kerfwise.rule_kit import Contour, Part

Floats = NDArray[np.float64]
LAYERS = 7
DISC = 12
STEP_MM = 0.5
DEEP_MM = 0.06
"""How far a jet may reach into a part."""
LOOK_MM = 0.12
"""How far from its face the waste must be burnt."""
_WORDS = re.compile(r"([A-Z])(-?\d+\.?\d*)")


@dataclass(frozen=True, slots=True)
class LayerFinding:
    """What is wrong at one depth, and where."""

    kind: str
    name: str
    depth_mm: float
    at: tuple[float, float]

    def __str__(self) -> str:
        return f"{self.kind}: {self.name}, {self.depth_mm:.2f} mm deep at ({self.at[0]:.2f}, {self.at[1]:.2f})"


def jets_of(program: str, tilt: str = "A", turn: str = "C") -> list[Floats]:
    """Each stretch with the torch on, as rows of x, y, tilt and turn, close together.

    Of a block, told by its settings, each torch whose output is set has such a stretch.
    """
    settings = {int(found[0]): tuple(map(float, found[1:])) for found in _BLOCK.findall(program)}
    jets = []
    for rows, outputs in _runs(program, tilt, turn):
        if outputs <= {1} and np.ptp(rows[:, 3]) < 1e-6:
            jets.append(rows)
            continue
        along = np.radians(rows[:, 3])
        out, left = (np.column_stack([np.cos(along + a), np.sin(along + a)]) for a in (0.0, math.pi / 2))
        for output in sorted(outputs) if settings else ():
            lean, to_left, outwards = settings[output + 1]
            at = rows[:, :2] + to_left * left + outwards * out
            jets.append(np.column_stack([at, np.full(len(at), lean), rows[:, 3]]))
        if not settings:
            jets.append(rows)
    return jets


_BLOCK = re.compile(r"\(BLOCK TORCH (\d)[^)]*? TILT (-?[\d.]+) LEFT (-?[\d.]+) OUT (-?[\d.]+)\)")


def _runs(program: str, tilt: str, turn: str) -> list[tuple[Floats, set[int]]]:
    """Each stretch with the torch on as the program has it, with the outputs that are set meanwhile."""
    outputs, lit_by = set[int](), list[set[int]]()
    state = {"X": 0.0, "Y": 0.0, tilt: 0.0, turn: 0.0}
    motion, lit, jets = 0, False, list[list[Floats]]()
    for raw in program.splitlines():
        line = re.sub(r"\([^)]*\)", "", raw).strip()
        words = {letter: float(number) for letter, number in _WORDS.findall(line) if letter != "N"}
        codes = {float(n) for letter, n in _WORDS.findall(line) if letter == "G"}
        if words.get("M") in (64, 65):
            outputs = outputs - {int(words["P"])} | ({int(words["P"])} if words["M"] == 64 else set())
        if words.get("M") in (37, 38):  # stations
            outputs = outputs - {int(words["T"]) - 1} | ({int(words["T"]) - 1} if words["M"] == 37 else set())
        if words.get("M") in (3, 7):
            lit = True
            jets.append([])
            lit_by.append(outputs)
        elif words.get("M") in (5, 8):
            lit = False
        motion = next((int(code) for code in codes if code in (0, 1, 2, 3)), motion)
        after = state | {letter: value for letter, value in words.items() if letter in state}
        if after == state or 4.0 in codes:
            continue
        if lit:
            assert motion, f"a rapid with the torch on: {raw}"
            jets[-1].append(_moved(state, after, motion, words.get("I", 0.0), words.get("J", 0.0), tilt, turn))
        state = after
    return [(np.concatenate(rows), by) for rows, by in zip(jets, lit_by, strict=True) if rows]


def _moved(a: dict[str, float], b: dict[str, float], motion: int, i: float, j: float, tilt: str, turn: str) -> Floats:
    start, end = np.array([a["X"], a["Y"]]), np.array([b["X"], b["Y"]])
    if motion == 1:
        length = float(np.hypot(*(end - start)))
        count = _count(length, max(abs(a[turn] - b[turn]), abs(a[tilt] - b[tilt])))
        share = np.linspace(0.0, 1.0, count + 1)
        points = start + share[:, None] * (end - start)
    else:
        centre, radius = start + np.array([i, j]), math.hypot(i, j)
        first = math.atan2(-j, -i)
        sweep = math.atan2(*(end - centre)[::-1]) - first
        sweep = sweep % math.tau if motion == 3 else -(-sweep % math.tau)
        count = _count(radius * abs(sweep), max(abs(a[turn] - b[turn]), math.degrees(abs(sweep))))
        share = np.linspace(0.0, 1.0, count + 1)
        points = centre + radius * np.column_stack([np.cos(first + sweep * share), np.sin(first + sweep * share)])
    leans = a[tilt] + share * (b[tilt] - a[tilt])
    return np.column_stack([points, leans, a[turn] + share * (b[turn] - a[turn])])


def _count(length_mm: float, turned_deg: float) -> int:
    return max(1, math.ceil(length_mm / STEP_MM), math.ceil(abs(turned_deg) / 1.0))


def simulate_layers(nest: Nest, program: str, profile: Profile) -> list[LayerFinding]:
    """Burn a program layer by layer; a finding once for each kind and name."""
    drawn, thickness_mm = nest.drawn or nest, profile.material.thickness_mm
    jets = jets_of(program, profile.cuts.bevel.tilt, profile.cuts.bevel.turn)
    found: dict[tuple[str, str], LayerFinding] = {}
    for depth_mm in np.linspace(0.0, thickness_mm, LAYERS).tolist():
        for one in _at_depth(drawn, jets, depth_mm, thickness_mm, profile):
            found.setdefault((one.kind, one.name), one)
    return list(found.values())


def _radii_mm(leans_deg: Floats, profile: Profile) -> Floats:
    table = sorted({0.0: profile.material.kerf_mm, **dict(profile.cuts.bevel.kerfs)}.items())
    kerf_mm = np.interp(np.abs(leans_deg), [row[0] for row in table], [row[1] for row in table])
    radii: Floats = (kerf_mm / 2 / np.cos(np.radians(leans_deg))).round(4)
    return radii


def _behind_mm(bevel: Bevel | None, depth_mm: float, thickness_mm: float) -> float:
    """How far the face lies behind the line that is drawn."""
    if bevel is None:
        return 0.0
    tan, land = math.tan(math.radians(bevel.angle_deg)), bevel.land_mm
    if bevel.kind in ("X", "K"):
        return max(0.0, abs(depth_mm - thickness_mm / 2) - land / 2) * tan
    from_land = thickness_mm - depth_mm if bevel.side == "top" else depth_mm
    return max(0.0, from_land - land) * tan


def _at_depth(
    nest: Nest, jets: Sequence[Floats], depth_mm: float, thickness_mm: float, profile: Profile
) -> Iterator[LayerFinding]:
    ways, radii = [], []
    for jet in jets:
        lean, turn = np.radians(jet[:, 2]), np.radians(jet[:, 3])
        aside = depth_mm * np.tan(lean)
        ways.append(jet[:, :2] + aside[:, None] * np.column_stack([np.cos(turn), np.sin(turn)]))
        radii.append(_radii_mm(jet[:, 2], profile))
    angle = np.linspace(0.0, math.tau, DISC, endpoint=False)
    round_ = np.column_stack([np.cos(angle), np.sin(angle)])
    for way, radius in zip(ways, radii, strict=True):
        disc = (way[:, None, :] + radius[:, None, None] * round_[None, :, :]).reshape(-1, 2)
        inside = shapely.contains_xy(shapely.buffer(nest.sheet.polygon, DEEP_MM), disc)
        if not inside.all():
            yield _found("beyond the sheet", "", depth_mm, disc[~inside][0])
        for part in nest.parts:
            burnt = _in_metal(part, disc, depth_mm, thickness_mm)
            if burnt.any():
                yield _found("burnt", part.id, depth_mm, disc[burnt][0])
    trees = [(cKDTree(way[of == r]), float(r)) for way, of in zip(ways, radii, strict=True) for r in np.unique(of)]
    widest = max(radius for _, radius in trees)
    for part in nest.parts:
        for contour in part:
            if contour.encloses and (left := _standing(contour, trees, widest, depth_mm, thickness_mm)) is not None:
                yield _found("left standing", contour.id, depth_mm, left)


def _found(kind: str, name: str, depth_mm: float, at: Floats) -> LayerFinding:
    return LayerFinding(kind, name, depth_mm, (float(at[0]), float(at[1])))


def _in_metal(part: Part, points: Floats, depth_mm: float, thickness_mm: float) -> NDArray[np.bool_]:
    """Points deeper in the part than allowed."""
    x0, y0, x1, y1 = part.polygon.bounds
    inside = (points[:, 0] > x0) & (points[:, 0] < x1) & (points[:, 1] > y0) & (points[:, 1] < y1)
    inside[inside] = shapely.contains_xy(part.polygon, points[inside])
    for contour in part:
        if contour.encloses and inside.any():
            away = shapely.distance(contour.line, shapely.points(points[inside]))
            inside[inside] = away > _behind_mm(contour.bevel, depth_mm, thickness_mm) + DEEP_MM
            for edge in _edges(contour):
                along, deep = edge.local(points[inside])
                behind_mm = _behind_mm(edge.bevel, depth_mm, thickness_mm)
                low, high = (-edge.on_mm(end, behind_mm) - DEEP_MM for end in (0, 1))
                taken = (along > low) & (along < edge.length - high) & (deep < behind_mm + DEEP_MM) & (behind_mm > 0)
                inside[inside] = ~(taken & (deep > -DEEP_MM))
    return inside


@dataclass(frozen=True, eq=False, slots=True)
class _Edge:
    """One edge where single edges have bevels: a line or an arc, with how the contour turns at its two ends."""

    segment: Segment
    bevel: Bevel | None
    part_on_left: bool
    turns: tuple[float, float]

    @property
    def length(self) -> float:
        return self.segment.length_mm

    def local(self, points: Floats) -> tuple[Floats, Floats]:
        """How far along the edge points lie, and how far on the part's side of it."""
        s, side = self.segment, 1.0 if self.part_on_left else -1.0
        if not s.is_arc:
            along = np.array(s.tangent_at(0.0))
            off = points - np.array(s.start)
            return off @ along, side * (off @ np.array([-along[1], along[0]]))
        centre, way = np.array(s.centre), 1.0 if s.sweep_rad > 0 else -1.0
        off = points - centre
        begin = math.atan2(s.start[1] - centre[1], s.start[0] - centre[0])
        turned = (way * (np.arctan2(off[:, 1], off[:, 0]) - begin - s.sweep_rad / 2) + math.pi) % math.tau - math.pi
        along = s.radius_mm * (turned + abs(s.sweep_rad) / 2)
        return along, side * way * (s.radius_mm - np.hypot(*off.T))

    def on_mm(self, end: int, behind_mm: float) -> float:
        """How far the slope goes on past an end: past a sharp corner to where the next edge ends it."""
        turn = self.turns[end]
        return behind_mm / math.tan(turn) if math.radians(29.99) < turn < math.pi / 2 else 0.0


def _edges(contour: Contour) -> list[_Edge]:
    if not contour.edge_bevels:
        return []
    segments, left = contour.curve.segments, contour.curve.is_ccw == (contour.kind == "outer")
    turns = []
    for k, after in enumerate(segments):
        (ax, ay), (bx, by) = segments[k - 1].tangent_at(1.0), after.tangent_at(0.0)
        turns.append((1 if left else -1) * math.atan2(ax * by - ay * bx, ax * bx + ay * by))
    ends = zip(turns, [*turns[1:], turns[0]], strict=True)
    return [_Edge(s, b, left, t) for s, b, t in zip(segments, contour.bevel_of_edge, ends, strict=True)]


def _beside_edges(contour: Contour, depth_mm: float, thickness_mm: float, widest_mm: float) -> Floats:
    """Places beside the face of each edge; jets end before corners that are not sharp."""
    found = []
    for edge in _edges(contour):
        count = max(2, math.ceil(edge.length / 1.7))
        for share in np.linspace(0.5 / count, 1 - 0.5 / count, count).tolist():
            rest = [4 * widest_mm + 1 if turn < math.radians(29.99) else 0.0 for turn in edge.turns]
            if not rest[0] <= share * edge.length <= edge.length - rest[1]:
                continue
            (x, y), (ux, uy) = edge.segment.point_at(share), edge.segment.tangent_at(share)
            into = _behind_mm(edge.bevel, depth_mm, thickness_mm) - LOOK_MM
            side = 1.0 if edge.part_on_left else -1.0
            found.append((x - side * uy * into, y + side * ux * into))
    return np.array(found).reshape(-1, 2)


def _standing(
    contour: Contour, trees: Sequence[tuple[cKDTree, float]], widest_mm: float, depth_mm: float, thickness_mm: float
) -> Floats | None:
    """A place beside the face, on the waste's side, that nothing has burnt; inner corners keep a round rest."""
    if contour.edge_bevels:
        look = _beside_edges(contour, depth_mm, thickness_mm, widest_mm)
        return _not_burnt(look, trees)
    behind_mm = _behind_mm(contour.bevel, depth_mm, thickness_mm)
    line = shapely.LineString(shapely.get_coordinates(contour.line))
    at_mm = np.arange(0.0, line.length, 1.7)
    on, ahead = (shapely.get_coordinates(shapely.line_interpolate_point(line, at_mm + d)) for d in (0.0, 1e-3))
    along = (ahead - on) / np.maximum(np.hypot(*(ahead - on).T), 1e-12)[:, None]
    right = np.column_stack([along[:, 1], -along[:, 0]])
    to_waste = right if contour.curve.is_ccw == (contour.kind == "outer") else -right
    look = on + to_waste * (LOOK_MM - behind_mm)
    corners = _inner_corners(contour)
    if len(corners):
        rest_mm = 3 * (behind_mm + widest_mm) + 1
        clear = cKDTree(corners).query(on)[0] > rest_mm
        look = look[clear]
    return _not_burnt(look, trees)


def _not_burnt(look: Floats, trees: Sequence[tuple[cKDTree, float]]) -> Floats | None:
    burnt = np.zeros(len(look), np.bool_)
    for tree, radius in trees:
        burnt |= tree.query(look, distance_upper_bound=radius + 0.02)[0] <= radius + 0.02
    return None if burnt.all() else look[~burnt][0]


def _inner_corners(contour: Contour) -> Floats:
    """Where the contour bends into the part."""
    found = []
    segments = contour.curve.segments
    for before, after in zip(segments, [*segments[1:], segments[0]], strict=True):
        (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
        left = ax * by - ay * bx
        outwards = left if contour.curve.is_ccw == (contour.kind == "outer") else -left
        if outwards < -0.02:
            found.append(after.start)
    return np.array(found).reshape(-1, 2)
