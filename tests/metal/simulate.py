"""The simulation: a program burns its nest, cut after cut, and what goes wrong is found by geometry alone.

It shares nothing with the planner or the check: no offset curves, no facts, no rules, no reader of programs. It has
the drawing, the program and the width of the kerf.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from kerfwise.tests.metal.burns import burns_of
from kerfwise.tests.metal.coverage import Tabs, uncut, unmarked, wrong_spots
from kerfwise.tests.metal.drawing import Drawing, drawing_of
from kerfwise.tests.metal.erosion import PartMetal
from kerfwise.tests.metal.findings import KINDS, Finding
from kerfwise.tests.metal.passes import holes_of, wrong_passes
from kerfwise.tests.metal.pieces import Pieces
from kerfwise.tests.metal.program import Path, Program, read_program
from kerfwise.tests.metal.slots import Slots
from kerfwise.tests.metal.stock import along_older, cut_apart, not_free, off_sheet, on_loose, twice
from kerfwise.tests.metal.torches import every_order
from kerfwise.tests.metal.void import OlderKerfs

if TYPE_CHECKING:
    from kerfwise import Nest


def simulate(
    nest: Nest,
    program: str | Program,
    kerf_mm: float,
    *,
    before: str | None = None,
    splash_mm: float = 0.0,
    edge_starts: bool = False,
    touching: bool = False,
    slits: bool = False,
    spotted: Collection[str] = (),
    left_out: Collection[str] = (),
    hole_limit_mm: float = 0.0,
    tabs: Tabs | None = None,
    pierce_pass: bool = False,
    common: bool = False,
    features_kerfs: float = 1.0,
    torches: Sequence[tuple[float, float]] = ((0.0, 0.0),),
) -> list[Finding]:
    """Burn a program and say what is wrong with it.

    Parameters
    ----------
    nest
        The sheet and its parts, mm.
    program
        The text of the program, or what it does.
    kerf_mm
        Width of the kerf, over 0.
    before
        The text of the program that was broken off, where `program` takes up its work (RESUME AFTER CUT n).
    splash_mm
        How far a pierce must keep from an older kerf, beyond half a kerf.
    edge_starts
        Whether a cut may begin off the sheet and run in over its edge.
    touching
        Whether parts may touch, as in wood: a ring may then take as much of a neighbour as its kerf is wide.
    slits
        Whether a slot narrower than the kerf may be opened by one pass along its middle, as wide as the kerf.
    spotted, left_out
        Ids of small holes that are marked at their middle, and of those that are left out: their metal is the part's.
    hole_limit_mm
        How wide such a hole may be.
    tabs
        By id of an outer contour x, y and width of each tab: stretches that are to stay, and to hold the part.
    pierce_pass
        Whether all holes of a zone, or of the sheet, are pierced before the cuts that begin there.
    common
        Whether edges of two parts are to be cut once: then a cut may begin in an older kerf, and runs along none.
    features_kerfs
        How many kerfs from every burn a slot, notch or corner too narrow for the torch may be left.
    torches
        Where the torches of the gantry stand, as the first one sees it, itself among them. What several of them burn at
        one time is burnt in every order.

    Returns
    -------
    The findings of `program` in the order of its cuts, then those of the finished sheet.

    Raises
    ------
    UnreadableProgram
        If a program has words that are not known here.
    """
    if kerf_mm <= 0:
        raise ValueError("a burn without width burns nothing: kerf_mm must be over 0")
    drawing, now = drawing_of(nest), read_program(program, kerf_mm) if isinstance(program, str) else program
    if any(path.torches for path in now.paths):
        asked = {
            "before": before, "splash_mm": splash_mm, "edge_starts": edge_starts, "touching": touching, "slits": slits,
            "spotted": spotted, "left_out": left_out, "hole_limit_mm": hole_limit_mm, "tabs": tabs,
            "pierce_pass": pierce_pass, "common": common, "features_kerfs": features_kerfs,
        }  # fmt: skip
        found: dict[tuple[str, tuple[str, ...]], Finding] = {}
        for one in every_order(now, torches):
            for finding in simulate(nest, one, kerf_mm, **asked):
                found.setdefault((finding.kind, finding.contours), finding)
        return list(found.values())
    history: Sequence[Path] = ()
    findings: list[Finding] = []
    if before is not None:
        upto = now.resumed_after
        if upto is None:
            return [_resumed("the program does not say after which cut it takes up the work")]
        old = (path.upto(upto) for path in _on_drawing(read_program(before, kerf_mm), drawing))
        history = tuple(path for path in old if path is not None)
        if now.paths and now.paths[0].order != upto + 1:
            findings.append(_resumed(f"the work stopped after cut {upto}, the program begins with", now.paths[0].order))
    elif now.resumed_after:
        raise ValueError("the program takes up the work of another: give that one as `before`")
    paths = [*history, *_on_drawing(now, drawing)]
    findings += wrong_spots(drawing, spotted, left_out, hole_limit_mm, paths)
    drawing = drawing.without_holes({*spotted, *left_out})
    burns = burns_of(paths, drawing, kerf_mm)
    first = len(burns_of(history, drawing, kerf_mm))
    slots = Slots(drawing, kerf_mm, slits)
    pieces, metal = Pieces(drawing.sheet), PartMetal(drawing, kerf_mm, touching, slots)
    own = holes_of(burns) if pierce_pass else {}
    kerfs = OlderKerfs(burns, drawing.sheet, kerf_mm, splash_mm, own, kerf_starts=common)
    for k, burn in enumerate(burns):
        if k >= first:
            findings += metal.judge(burn)
            findings += kerfs.judge(k)
            findings += off_sheet(burn, drawing.sheet, edge_starts)
            findings += on_loose(burn, pieces, drawing)
        pieces.burn(burn.kerf(kerf_mm / 2))
    findings += [found for k, found in twice(burns) if k >= first]
    findings += wrong_passes(burns, own, drawing.sheet, common) if pierce_pass else []
    findings += [found for k, found in along_older(burns) if k >= first] if common else []
    findings += uncut(drawing, burns, kerf_mm, tabs or {}, features_kerfs)
    findings += slots.shut(burns)
    findings += unmarked(drawing, paths)
    findings += not_free(drawing, pieces, {b.contour.id for b in burns if b.contour is not None}, tabs or {})
    findings += cut_apart(drawing, pieces)
    return findings


def _on_drawing(program: Program, drawing: Drawing) -> tuple[Path, ...]:
    """The paths in the drawing's coordinates."""
    if not program.from_corner:
        return program.paths
    corner = drawing.sheet.bounds[:2]
    return tuple(replace(path, points=path.points + corner) for path in program.paths)


def _resumed(text: str, order: int = 0) -> Finding:
    return Finding("resumed-wrong", order, (), (0.0, 0.0), float(order), "", text)


def by_kind(findings: Sequence[Finding]) -> dict[str, int]:
    """How many findings there are of each kind, in the order of reports."""
    return {kind: n for kind in KINDS if (n := sum(f.kind == kind for f in findings))}
