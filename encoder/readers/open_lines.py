"""Lines on layers to be cut that do not close: marked where a profile says so, else refused with the places."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import shapely

from kerfwise.arrays import Floats, point_tree
from kerfwise.encoder.contour_checks import metal_of
from kerfwise.encoder.errors import REPAIR
from kerfwise.encoder.nest import Note, Part
from kerfwise.encoder.questions import LAYER, Asking, Choice, Question

from .by_layer import ByLayer
from .closing import SHARED, Closing, closings
from .drawing import SNAP_MM, DrawnCurve, OpenLines
from .join import Joined
from .layers import setting
from .options import REPAIR_FACTOR, ReadOptions

BROKEN = 0.5
"""A line whose ends lie nearer to each other than this share of its length may be a contour that does not close."""


@dataclass(frozen=True, eq=False)
class OpenLineDecision:
    """What becomes of open lines: those that are marked, a word on each; or how some close, and nothing else yet."""

    marks: tuple[DrawnCurve, ...]
    notes: tuple[Note, ...]
    closing: tuple[Closing, ...] = ()


def decide_open_lines(
    drawn: Joined,
    parts: Sequence[Part],
    sheet: Sequence[DrawnCurve],
    bridge_mm: float,
    options: ReadOptions,
    told_apart: ByLayer,
    asking: Asking,
    closed_layers: frozenset[str] = frozenset(),
) -> OpenLineDecision:
    """What is done with open lines on layers that are cut.

    A line no longer than the join tolerance is a crumb, and is left out. On a layer that `layers.cut` names, a line
    that can be no broken contour is marked if it lies in the metal of a part and left out if it lies in waste, or as
    `open_lines` says. With `repair`, a stub on a closed line is left out if it is shorter than the widest gap that
    repair closes, and so is a line that can be no broken contour, on another layer that holds nothing closed. What is
    open on all other layers is asked about, layer by layer: closed lines beside open ones may be marks too. An outline
    with a gap is refused. Raises OpenLines with every line that is left, and by layer what a profile can say of it.
    """
    rings = drawn.rings
    crumbs = [c for c in drawn.chains if c.curve.length_mm <= options.join_tolerance_mm]
    chains = [c for c in drawn.chains if c.curve.length_mm > options.join_tolerance_mm]
    crumb_notes = tuple(_told(crumbs, "shorter than drawing.join_tolerance, and therefore left out"))
    if not chains:
        return OpenLineDecision((), crumb_notes)
    stated = [told_apart.stated(c) for c in chains]
    whole = [not broken for broken in _maybe_broken(chains, options)]
    metal_mm = _in_metal(chains, parts)
    closed = Counter(r.layer for r in rings)
    outlines = shapely.STRtree([r.curve.line() for r in rings])
    repaired = [
        options.repair and (_is_stray(c, own, is_whole, closed) or _is_stub(c, outlines, bridge_mm, options))
        for c, own, is_whole in zip(chains, stated, whole, strict=True)
    ]
    rows = [k for k, gone in enumerate(repaired) if not gone and chains[k].layer not in closed_layers]
    lines = _Lines(
        [chains[k] for k in rows], [stated[k] for k in rows], [whole[k] for k in rows], [metal_mm[k] for k in rows]
    )
    answers, closing = _asked(lines, rings, parts, options, asking)
    if closing:
        return OpenLineDecision((), (), tuple(closing))
    answers |= dict.fromkeys(closed_layers, "open")
    fates: dict[str, list[DrawnCurve]] = {fate: [] for fate in get_args(_Fate)}
    every = _Lines(chains, stated, whole, metal_mm)
    for k, chain in enumerate(chains):
        fates[_fate(every, k, repaired[k], answers.get(chain.layer, ""), options)].append(chain)
    if left := fates["left"]:
        which = "1 line does" if len(left) == 1 else f"{len(left)} lines do"
        cut = {p.layer for p in (*rings, *chains)}
        details = (*_by_layer(left, closed, cut, options, told_apart), *open_end_problems(left, options))
        raise OpenLines(f"{which} not close to contours", left, details, parts, sheet)
    notes = [Note("repaired", f"the open line {ends(c)} is left out: it does not close") for c in fates["dropped"]]
    cut_and = "though the layer is cut, and therefore"
    notes += _told(fates["marked"], f"{cut_and} marked, not cut (drawing.open_lines)")
    notes += _told(fates["ignored"], f"{cut_and} left out (drawing.open_lines)")
    notes += _told(fates["answered"], "left out, as answered")
    notes += _told(fates["in waste"], f"{cut_and} left out, for it lies in no part")
    return OpenLineDecision(tuple(fates["marked"]), (*crumb_notes, *notes))


_Fate = Literal["dropped", "marked", "in waste", "ignored", "answered", "left"]


def _fate(lines: _Lines, k: int, repaired: bool, answer: str, options: ReadOptions) -> _Fate:
    """What becomes of line `k`: marked, left out for one of four reasons, or left, as nobody can tell."""
    inside_mm, slack_mm = lines.metal_mm[k], options.join_tolerance_mm
    if repaired and answer in ("", "open"):
        return "dropped"
    if answer in ("open:ignore", "ignore"):
        return "answered"
    if answer:
        return "in waste" if inside_mm <= slack_mm else "marked"
    if not (lines.stated[k] and lines.whole[k]) or options.open_lines == "refuse":
        return "left"
    if options.open_lines == "ignore":
        return "ignored"
    if inside_mm >= lines.chains[k].curve.length_mm - slack_mm:
        return "marked"
    return "in waste" if inside_mm <= slack_mm else "left"


@dataclass(frozen=True, slots=True)
class _Lines:
    """Open lines by column: whether a plant says that they are cut, whether they can be no contour, mm in metal."""

    chains: list[DrawnCurve]
    stated: list[bool]
    whole: list[bool]
    metal_mm: list[float]


def _asked(
    lines: _Lines, rings: Sequence[DrawnCurve], parts: Sequence[Part], options: ReadOptions, asking: Asking
) -> tuple[dict[str, str], list[Closing]]:
    """What is answered of open lines, by layer, and how some are closed.

    Nothing is asked of a layer that holds an outline with a gap that nobody would close, and of one that a plant says
    is cut only where something on it may be closed. What lies in the metal of a part may be engraved, whether it nearly
    closes or not; lines that cross contours of other layers are notes.
    """
    answers: dict[str, str] = {}
    closed_by: list[Closing] = []
    slack_mm = options.join_tolerance_mm
    outer = {id(part.outer.curve) for part in parts}
    outers = [r for r in rings if id(r.curve) in outer]
    for layer in sorted({c.layer for c in lines.chains}):
        rows = [k for k, c in enumerate(lines.chains) if c.layer == layer]
        chains = [lines.chains[k] for k in rows]
        inside = [k for k in rows if lines.metal_mm[k] >= lines.chains[k].curve.length_mm - slack_mm]
        broken = [lines.chains[k] for k in rows if not lines.whole[k] and k not in inside]
        ways = closings(chains, broken, outers, slack_mm)
        likely = bool(ways) and ways[0].likely and bool(broken) and asking.may_mend(f"{LAYER}{layer}")
        answered = asking.answered(f"{LAYER}{layer}")
        stated = all(lines.stated[k] for k in rows)
        if answered is None and (options.open_lines == "refuse" or (stated and not likely)):
            continue
        noted = _are_notes(broken, layer, rings)
        if not stated and broken and not likely and answered is None and not noted:
            continue
        answer = asking.ask(_question(layer, chains, len(inside), rings, ways, likely, noted))
        closed_by += [way for way in ways if way.choice.value == answer]
        answers[layer] = answer
    return answers, closed_by


def _are_notes(broken: Sequence[DrawnCurve], layer: str, rings: Sequence[DrawnCurve]) -> bool:
    """Whether lines on a layer that holds nothing closed are leaders and the like: most cross what others show."""
    if not broken or any(ring.layer == layer for ring in rings):
        return False
    tree = shapely.STRtree([ring.curve.line() for ring in rings])
    crossing = np.unique(tree.query([c.curve.line() for c in broken], predicate="intersects")[0])
    return 2 * len(crossing) > len(broken)


_T_JUNCTION = "; their ends lie on edges of parts (T-junctions), as where two parts share an edge"


def _question(
    layer: str,
    chains: Sequence[DrawnCurve],
    inside: int,
    rings: Sequence[DrawnCurve],
    ways: Sequence[Closing],
    likely: bool,
    noted: bool,
) -> Question:
    """What open lines of a layer are for; where it holds closed ones, what those are for, too.

    `likely` says that `ways` to close them come first, `noted` that they may be leaders and the like.
    """
    closed = [r for r in rings if r.layer == layer]
    count = len(chains)
    held = f"layer '{layer}' holds {count} open line{'s' if count != 1 else ''}"
    where = f", {inside} of them in the metal of parts" if inside else ", none of them in the metal of a part"
    first = f", the first {ends(chains[0])}{_T_JUNCTION if any(way.choice.value == SHARED for way in ways) else ''}"
    closing = tuple(way.choice for way in ways)
    mark, ignore = Choice("mark", "marked, not cut through"), Choice("ignore", "left out")
    if not closed:
        first_mark = inside == count or (inside > 0 and not noted)
        scrap = Choice("scrap", "lines that cut up scrap")
        alone = (mark, ignore, scrap) if first_mark else (ignore, mark, scrap)
        choices = (*closing, *alone) if likely else (*alone, *closing)
        return Question(f"{LAYER}{layer}", f"{held} and nothing closed{where}{first}: what are they for?", choices)
    beside = f"{len(closed)} closed one{'s' if len(closed) != 1 else ''}"
    some = (
        Choice("open:mark", "the open ones are marked, the closed ones cut"),
        Choice("open:ignore", "the open ones are left out, the closed ones cut"),
    )
    whole = (Choice("mark", "all of the layer is marked"), Choice("ignore", "all of the layer is left out"))
    order = some if inside else some[::-1]
    outer = max(rings, key=lambda ring: abs(ring.curve.signed_area_mm2))
    choices = (*order, *whole) if outer in closed else (whole[0], *order, whole[1])
    choices = (*closing, *choices) if likely else (*choices, *closing)
    return Question(f"{LAYER}{layer}", f"{held} beside {beside}{where}{first}: what are they for?", choices)


def _is_stray(chain: DrawnCurve, stated: bool, whole: bool, closed: Counter[str]) -> bool:
    """Whether a line can be no contour, on a layer that holds nothing closed and that no plant says is cut."""
    return whole and not stated and not closed[chain.layer]


def _is_stub(chain: DrawnCurve, outlines: shapely.STRtree, longest_mm: float, options: ReadOptions) -> bool:
    """Whether a short line begins or ends on a closed one: a corner that was drawn a little too far."""
    ends_at = shapely.points(chain.curve.vertices[[0, -1], :2])
    on = outlines.query(ends_at, predicate="dwithin", distance=options.join_tolerance_mm)[0]
    return chain.curve.length_mm <= longest_mm and len(on) > 0


def _maybe_broken(chains: Sequence[DrawnCurve], options: ReadOptions) -> list[bool]:
    """Which chains may be a contour, or a piece of one, that was meant to close."""
    across = [float(np.hypot(*(c.curve.vertices[-1, :2] - c.curve.vertices[0, :2]))) for c in chains]
    other = nearest_ends(chains).min(axis=1).tolist()
    return [
        own < BROKEN * c.curve.length_mm or gap < min(own - SNAP_MM, REPAIR_FACTOR * options.join_tolerance_mm)
        for c, own, gap in zip(chains, across, other, strict=True)
    ]


def _in_metal(chains: Sequence[DrawnCurve], parts: Sequence[Part]) -> list[float]:
    """How much of each chain lies in the metal of parts, mm."""
    metal = metal_of(parts)
    tree = shapely.STRtree(metal)
    lengths = []
    for line in (c.curve.line() for c in chains):
        near = tree.query(line, predicate="intersects").tolist()
        lengths.append(sum(shapely.length(shapely.intersection(line, metal[k])) for k in near))
    return lengths


def _by_layer(
    left: Sequence[DrawnCurve], closed: Counter[str], cut: set[str], options: ReadOptions, told_apart: ByLayer
) -> list[str]:
    """A sentence for each layer: what it holds, and what a profile can say of it."""
    lines = []
    stated = {c.layer: told_apart.stated(c) for c in left}
    for layer, count in sorted(Counter(c.layer for c in left).items()):
        held = f"layer '{layer}' holds {count} open line{'s' if count != 1 else ''}"
        beside = closed[layer]
        if stated[layer] and options.open_lines == "refuse":
            lines.append(f"{held}, and drawing.open_lines is refuse; with mark or ignore they are not refused")
        elif stated[layer]:
            lines.append(f"{held} that cannot be marked: they may be broken contours, or cross one")
        elif beside:
            lines.append(
                f"{held} beside {beside} closed one{'s' if beside != 1 else ''}, which would be cut through. Say in "
                f"the profile what it is: {setting('mark', layer)} marks all of it; with ignore in place of mark it "
                f"is left out; {setting('cut', *cut)} cuts what is closed, and marks what is open in a part"
            )
        else:
            lines.append(
                f"{held} and nothing closed. If they are no contours, say in the profile what they are: "
                f"{setting('mark', layer)}, or ignore or scrap in place of mark"
            )
    return lines


def _told(chains: Sequence[DrawnCurve], how: str) -> list[Note]:
    by_layer: dict[str, list[DrawnCurve]] = {}
    for chain in chains:
        by_layer.setdefault(chain.layer, []).append(chain)
    return [
        Note(
            "warning",
            f"open on layer '{layer}', {how}: {len(those)} line{'s' if len(those) != 1 else ''}, the first "
            f"{ends(those[0])}",
        )
        for layer, those in sorted(by_layer.items())
    ]


# Lines that do not close, told so that a person finds them in the drawing.


def ends(chain: DrawnCurve) -> str:
    """How long a line is, where it starts and ends, and its layer."""
    (x0, y0), (x1, y1) = chain.curve.vertices[[0, -1], :2].tolist()
    return (
        f"of {chain.curve.length_mm:.3f} mm from ({x0:.3f}, {y0:.3f}) to ({x1:.3f}, {y1:.3f}) on layer '{chain.layer}'"
    )


def nearest_ends(chains: Sequence[DrawnCurve]) -> Floats:
    """Array (n, 2): how far the start and the end of each chain are from the nearest other end, its own too, mm."""
    points = np.concatenate([c.curve.vertices[[0, -1], :2] for c in chains])
    distances: Floats = point_tree(points).query(points, k=2)[0][:, 1].reshape(-1, 2)
    return distances


def open_end_problems(chains: Sequence[DrawnCurve], options: ReadOptions) -> list[str]:
    """A line for each open chain: where its ends are, how far the nearest other open end is, and what to do."""
    problems = []
    for chain, gaps in zip(chains, nearest_ends(chains).tolist(), strict=True):
        gap, (x, y) = min(zip(gaps, chain.curve.vertices[[0, -1], :2].tolist(), strict=True))
        advice = "close the line in CAD"
        if gap <= SNAP_MM:
            advice = "it meets other lines there, as where two parts share an edge: draw each part by a closed line"
        elif gap <= REPAIR_FACTOR * options.join_tolerance_mm:
            or_repair = "" if options.repair else f", or try {REPAIR}"
            advice = f"{advice}, raise drawing.join_tolerance over {gap:.3f} mm{or_repair}"
        problems.append(
            f"the line {ends(chain)} is open: the end at ({x:.3f}, {y:.3f}) is {gap:.3f} mm from any other: {advice}"
        )
    return problems
