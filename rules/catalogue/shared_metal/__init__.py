"""Rule shared-metal."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.judging.holding import burnt_parts
from kerfwise.rules.rule import Rule, Violation
from kerfwise.rules.statements import AtLeast

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

CHORD_MM = 0.002
"""Contours are measured by chords that lie this close to them."""
COARSE_MM = 0.04
"""More than the chords that those which may be near are found by lie off two contours."""


@dataclass(frozen=True, slots=True)
class SharedMetalOptions:
    """`kerf_mm` is that of the material."""

    kerf_mm: float = 1.5


class SharedMetal(Rule[SharedMetalOptions]):
    """No cut burns the metal of another part.

    ## What it does

    The kerf of a contour is a strip as wide as `material.kerf`, on the side of its waste: outside an outer contour,
    inside a hole. Two contours of different parts that bound waste towards each other (two outer contours side by side,
    or a hole and a part that lies in it) and are nearer to each other than the kerf burn each other's metal: each kerf
    reaches as deep into the other part as the gap falls short of the kerf. More than 0.05 mm (a quarter of a kerf under
    0.2 mm) is refused, since no order and no entry helps: `solve` names every such pair with place, gap and depth. A
    line that the nest gives to two parts (or a drawing to a layer of holes and to another) is such a pair as well.
    `--relax` relaxes these pairs, and marks them in the plan, the program and the check. A web between a hole and the
    outer contour of the same part may be as thin as it likes: both kerfs lie in waste. Marks burn nothing through.
    Where the rule is off, as in wood, contours may touch; the check then only warns.

    ## Links, tabs and other cuts

    - **Links**: A link keeps as far off every part as a cut does; no-gouging of the check measures it.
    - **Tabs**: They change nothing: the two kerfs are compared all round.
    - **Common cuts**: They change nothing: the kerf between two parts is as wide as the gap, and enters neither. With
      `cuts.common.accept_loss` parts whose straight edges touch are judged as they are without the half kerf that each
      loses there; `edge-loss` of the check measures that.
    - **Scrap lines**: One that comes nearer than a kerf to a part is refused when the nest is read, whatever the rule
      is.

    ## Why

    Parts of metal must keep their size. Pavlov 1999 (section 1) lets contours touch in wood only; in metal a common cut
    of two parts is a way of cutting of its own.

    ## Wrong

    A and B 0.5 mm apart with a kerf of 1.5 mm: the cut of each takes 1 mm of the other.

    ## Right

    A and B 1.5 mm apart or more.
    """

    id = "shared-metal"
    sentence = "No cut burns the metal of another part."
    source = "Pavlov 1999, section 1; Petunin 2009"
    Options = SharedMetalOptions
    takes_no_file = "the check measures by it how deep kerfs reach into other parts, which no order decides"
    strengths = ("hard", "off")
    relaxable = True
    guards_metal = True
    minds_what_is_out = True

    def statements(self, facts: Facts, options: SharedMetalOptions) -> Iterator[AtLeast]:
        whole = facts if facts.past is None else facts.past.whole
        for i, j, gap_mm, place in near_contours(whole, options.kerf_mm):
            a, b = whole.nest.contours[i].id, whole.nest.contours[j].id
            if a not in facts.nest.index and b not in facts.nest.index:
                continue  # both are cut
            sentence = _said(a, b, gap_mm, place, options.kerf_mm)
            yield AtLeast((), (), 1, self.about((a, b), sentence))
        for dropped, kept in one_line(facts.nest, options.kerf_mm):
            yield AtLeast(
                (), (), 1, self.about((kept,), _one_line_sentence(facts.nest, dropped, kept, options.kerf_mm))
            )

    def violations(self, nest: Nest, cuts: CutSequence, options: SharedMetalOptions) -> list[Violation]:
        at, found = cuts.positions(), []
        for burnt in burnt_parts(nest, at, options.kerf_mm):
            a, b = burnt.contours
            places = tuple(sorted(at[name] for name in burnt.contours if name in at))
            text = _said(a, b, burnt.gap_mm, burnt.place, options.kerf_mm)
            found.append(Violation(self.id, burnt.contours, text, places))
        for dropped, kept in one_line(nest, options.kerf_mm):
            if kept in at:
                text = _one_line_sentence(nest, dropped, kept, options.kerf_mm)
                found.append(Violation(self.id, (kept,), text, (at[kept],)))
        return found


def near_contours(facts: Facts, kerf_mm: float) -> list[tuple[int, int, float, Point]]:
    """Pairs of contour numbers nearer than the kerf, one in the waste of the other: with the gap, mm, and its place.

    The waste of a hole is all inside it, that of an outer contour all outside.
    """
    reach_mm = kerf_mm - tolerance_mm(kerf_mm)
    contours = facts.nest.contours
    cut = np.array([k for k, c in enumerate(contours) if c.encloses], dtype=np.int64)
    if reach_mm <= 0 or len(cut) < 2:
        return []
    coarse = np.array([contours[k].line for k in cut], dtype=object)
    near = shapely.STRtree(coarse).query(coarse, predicate="dwithin", distance=reach_mm + COARSE_MM)
    cut = cut[np.unique(near[:, near[0] != near[1]])]
    lines = np.array([contours[k].curve.line(CHORD_MM) for k in cut], dtype=object)
    inside = set(map(tuple, facts.contains.tolist()))
    i, j = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=reach_mm)
    found = []
    for a, b in sorted(zip(i[i < j].tolist(), j[i < j].tolist(), strict=True)):
        one, other = int(cut[a]), int(cut[b])
        if not _in_waste(contours[one], contours[other], (one, other) in inside, (other, one) in inside):
            continue
        gap_mm = float(shapely.distance(lines[a], lines[b]))
        if gap_mm < reach_mm - 1e-6:
            middle = shapely.shortest_line(lines[a], lines[b]).centroid
            found.append((one, other, gap_mm, (middle.x, middle.y)))
    return found


def _in_waste(one: Contour, other: Contour, holds_other: bool, lies_in_other: bool) -> bool:
    """Whether the kerf of one of two contours is on the side of the other's part."""
    if one.part == other.part or one.kind == other.kind == "hole":
        return False
    if one.kind == other.kind:
        return not (holds_other or lies_in_other)
    return holds_other if one.kind == "hole" else lies_in_other


def one_line(nest: Nest, kerf_mm: float) -> list[tuple[str, str]]:
    """Lines that the nest gives to contours of two parts: the id that is not cut, and the one that it is cut as."""
    if kerf_mm <= tolerance_mm(kerf_mm):
        return []
    return [(note.contours[0], note.contours[1]) for note in nest.notes if note.common]


def _one_line_sentence(nest: Nest, dropped: str, kept: str, kerf_mm: float) -> str:
    x, y = nest.contour(kept).curve.vertices[0, :2].tolist()
    return (
        f"{kept} and {dropped} are one line at ({x:z.1f}, {y:z.1f}), given to two parts: on either side of it the kerf "
        f"of {kerf_mm:g} mm is metal of one of them; it can only be cut once, as {kept}"
    )


def _said(one: str, other: str, gap_mm: float, place: Point, kerf_mm: float) -> str:
    apart = f"are {gap_mm:.3f} mm apart" if gap_mm >= 0.0005 else "touch"
    return (
        f"{one} and {other} {apart} at ({place[0]:z.1f}, {place[1]:z.1f}): the kerf of {kerf_mm:g} mm reaches "
        f"{kerf_mm - gap_mm:.3f} mm into the other part"
    )
