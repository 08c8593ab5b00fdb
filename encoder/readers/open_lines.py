"""Lines on layers to be cut that do not close: marked where a profile says so, else refused with the places."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.spatial import cKDTree

from kerfwise.arrays import Floats
from kerfwise.encoder.contour_checks import metal_of
from kerfwise.encoder.errors import REPAIR
from kerfwise.encoder.nest import Note, Part
from kerfwise.encoder.questions import LAYER, Asking, Choice, Question

from .by_layer import ByLayer
from .drawing import SNAP_MM, DrawnCurve, OpenLines
from .layers import setting
from .options import ReadOptions

BROKEN = 0.5
"""A line whose ends lie nearer to each other than this share of its length may be a contour that does not close."""


@dataclass(frozen=True, eq=False)
class OpenLineDecision:
    """What becomes of open lines: those that are marked, and a word on each."""

    marks: tuple[DrawnCurve, ...]
    notes: tuple[Note, ...]


def decide_open_lines(
    chains: Sequence[DrawnCurve],
    rings: Sequence[DrawnCurve],
    parts: Sequence[Part],
    sheet: Sequence[DrawnCurve],
    bridge_mm: float,
    options: ReadOptions,
    told_apart: ByLayer,
    asking: Asking,
) -> OpenLineDecision:
    """What is done with open lines on layers that are cut.

    A line no longer than the join tolerance is a crumb, and is left out. On a layer that `layers.cut` names, a line
    that can be no broken contour is marked if it lies in the metal of a part and left out if it lies in waste, or as
    `open_lines` says. With `repair`, a stub on a closed line is left out if it is shorter than the widest gap that
    repair closes, and so is a line that can be no broken contour, on another layer that holds nothing closed. What is
    open on all other layers is asked about, layer by layer: closed lines beside open ones may be marks too. An outline
    with a gap is refused.

    Raises
    ------
    OpenLines
        With every line that is left, and by layer what a profile can say of it.
    """
    crumbs = [c for c in chains if c.curve.length_mm <= options.join_tolerance_mm]
    chains = [c for c in chains if c.curve.length_mm > options.join_tolerance_mm]
    crumb_notes = tuple(_told(crumbs, "shorter than drawing.join_tolerance, and therefore left out"))
    if not chains:
        return OpenLineDecision((), crumb_notes)
    stated = [told_apart.stated(c) for c in chains]
    whole = [not broken for broken in _maybe_broken(chains, options)]
    metal_mm = _in_metal(chains, parts)
    asked = _asked(chains, stated, whole, metal_mm, rings, options, asking)
    slack_mm = options.join_tolerance_mm
    closed = Counter(r.layer for r in rings)
    outlines = shapely.STRtree([r.curve.line() for r in rings])
    dropped: list[DrawnCurve] = []
    marked: list[DrawnCurve] = []
    in_waste: list[DrawnCurve] = []
    ignored: list[DrawnCurve] = []
    answered: list[DrawnCurve] = []
    left: list[DrawnCurve] = []
    for chain, is_stated, is_whole, inside_mm in zip(chains, stated, whole, metal_mm, strict=True):
        is_stray = is_whole and not is_stated and not closed[chain.layer]
        said = "" if is_stated else asked.get(chain.layer, "")
        if (
            options.repair
            and not said
            and (is_stray or (chain.curve.length_mm <= bridge_mm and _is_stub(chain, outlines, options)))
        ):
            dropped.append(chain)
        elif said in ("open:ignore", "ignore"):
            answered.append(chain)
        elif said:
            (in_waste if inside_mm <= slack_mm else marked).append(chain)
        elif not (is_stated and is_whole) or options.open_lines == "refuse":
            left.append(chain)
        elif options.open_lines == "ignore":
            ignored.append(chain)
        elif inside_mm >= chain.curve.length_mm - slack_mm:
            marked.append(chain)
        else:
            (in_waste if inside_mm <= slack_mm else left).append(chain)
    if left:
        which = "1 line does" if len(left) == 1 else f"{len(left)} lines do"
        cut = {p.layer for p in (*rings, *chains)}
        details = (*_by_layer(left, closed, cut, options, told_apart), *open_end_problems(left, options))
        raise OpenLines(f"{which} not close to contours", left, details, parts, sheet)
    notes = [Note("repaired", f"the open line {ends(c)} is left out: it does not close") for c in dropped]
    cut_and = "though the layer is cut, and therefore"
    notes += _told(marked, f"{cut_and} marked, not cut (drawing.open_lines)")
    notes += _told(ignored, f"{cut_and} left out (drawing.open_lines)")
    notes += _told(answered, "left out, as answered")
    notes += _told(in_waste, f"{cut_and} left out, for it lies in no part")
    return OpenLineDecision(tuple(marked), (*crumb_notes, *notes))


def _asked(
    chains: Sequence[DrawnCurve],
    stated: Sequence[bool],
    whole: Sequence[bool],
    metal_mm: Sequence[float],
    rings: Sequence[DrawnCurve],
    options: ReadOptions,
    asking: Asking,
) -> dict[str, str]:
    """What is answered of open lines, by layer; nothing of a layer that holds an outline with a gap.

    What lies in the metal of a part may be engraved, whether it nearly closes or not.
    """
    if options.repair or options.open_lines == "refuse":
        repaired = {layer for layer in {c.layer for c in chains} if asking.answered(f"{LAYER}{layer}") is None}
    else:
        repaired = set()
    answers: dict[str, str] = {}
    slack_mm = options.join_tolerance_mm
    for layer in sorted({c.layer for c, own in zip(chains, stated, strict=True) if not own} - repaired):
        rows = [k for k, c in enumerate(chains) if c.layer == layer]
        inside = [k for k in rows if metal_mm[k] >= chains[k].curve.length_mm - slack_mm]
        if any(not whole[k] and k not in inside for k in rows) and asking.answered(f"{LAYER}{layer}") is None:
            continue
        closed = [r for r in rings if r.layer == layer]
        answers[layer] = asking.ask(_question(layer, [chains[k] for k in rows], len(inside), closed, rings))
    return answers


def _question(
    layer: str, chains: Sequence[DrawnCurve], inside: int, closed: Sequence[DrawnCurve], rings: Sequence[DrawnCurve]
) -> Question:
    """What open lines of a layer are for; where it holds closed ones, what those are for, too."""
    count = len(chains)
    held = f"layer '{layer}' holds {count} open line{'s' if count != 1 else ''}"
    where = f", {inside} of them in the metal of parts" if inside else ", none of them in the metal of a part"
    first = f", the first {ends(chains[0])}"
    mark, ignore = Choice("mark", "marked, not cut through"), Choice("ignore", "left out")
    if not closed:
        order = (mark, ignore) if inside else (ignore, mark)
        scrap = Choice("scrap", "lines that cut up scrap")
        return Question(
            f"{LAYER}{layer}", f"{held} and nothing closed{where}{first}: what are they for?", (*order, scrap)
        )
    beside = f"{len(closed)} closed one{'s' if len(closed) != 1 else ''}"
    some = (
        Choice("open:mark", "the open ones are marked, the closed ones cut"),
        Choice("open:ignore", "the open ones are left out, the closed ones cut"),
    )
    whole = (Choice("mark", "all of the layer is marked"), Choice("ignore", "all of the layer is left out"))
    order = some if inside else some[::-1]
    outer = max(rings, key=lambda ring: abs(ring.curve.signed_area_mm2))
    choices = (*order, *whole) if outer in closed else (whole[0], *order, whole[1])
    return Question(f"{LAYER}{layer}", f"{held} beside {beside}{where}{first}: what are they for?", choices)


def _is_stub(chain: DrawnCurve, outlines: shapely.STRtree, options: ReadOptions) -> bool:
    """Whether a line begins or ends on a closed one: a corner that was drawn a little too far."""
    ends_at = shapely.points(chain.curve.vertices[[0, -1], :2])
    return len(outlines.query(ends_at, predicate="dwithin", distance=options.join_tolerance_mm)[0]) > 0


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
    said = []
    stated = {c.layer: told_apart.stated(c) for c in left}
    for layer, count in sorted(Counter(c.layer for c in left).items()):
        held = f"layer '{layer}' holds {count} open line{'s' if count != 1 else ''}"
        beside = closed[layer]
        if stated[layer] and options.open_lines == "refuse":
            said.append(f"{held}, and drawing.open_lines is refuse; with mark or ignore they are not refused")
        elif stated[layer]:
            said.append(f"{held} that cannot be marked: they may be broken contours, or cross one")
        elif beside:
            said.append(
                f"{held} beside {beside} closed one{'s' if beside != 1 else ''}, which would be cut through. Say in "
                f"the profile what it is: {setting('mark', layer)} marks all of it; with ignore in place of mark it "
                f"is left out; {setting('cut', *cut)} cuts what is closed, and marks what is open in a part"
            )
        else:
            said.append(
                f"{held} and nothing closed. If they are no contours, say in the profile what they are: "
                f"{setting('mark', layer)}, or ignore or scrap in place of mark"
            )
    return said


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

REPAIR_FACTOR = 10
"""With `repair`, gaps up to this many times the join tolerance are closed."""


def ends(chain: DrawnCurve) -> str:
    """How long a line is, where it starts and ends, and its layer."""
    (x0, y0), (x1, y1) = chain.curve.vertices[[0, -1], :2].tolist()
    return (
        f"of {chain.curve.length_mm:.3f} mm from ({x0:.3f}, {y0:.3f}) to ({x1:.3f}, {y1:.3f}) on layer '{chain.layer}'"
    )


def nearest_ends(chains: Sequence[DrawnCurve]) -> Floats:
    """Array (n, 2): how far the start and the end of each chain are from the nearest other end, its own too, mm."""
    points = np.concatenate([c.curve.vertices[[0, -1], :2] for c in chains])
    distances: Floats = cKDTree(points).query(points, k=2)[0][:, 1].reshape(-1, 2)
    return distances


def open_end_problems(chains: Sequence[DrawnCurve], options: ReadOptions) -> list[str]:
    """A line for each open chain: where its ends are, how far the nearest other open end is, and what to do."""
    problems = []
    for chain, gaps in zip(chains, nearest_ends(chains).tolist(), strict=True):
        gap, (x, y) = min(zip(gaps, chain.curve.vertices[[0, -1], :2].tolist(), strict=True))
        advice = "close the line in CAD"
        if gap <= REPAIR_FACTOR * options.join_tolerance_mm:
            advice = f"{advice}, raise drawing.join_tolerance over {gap:.3f} mm, or try {REPAIR}"
        problems.append(
            f"the line {ends(chain)} is open: the end at ({x:.3f}, {y:.3f}) is {gap:.3f} mm from any other: {advice}"
        )
    return problems
