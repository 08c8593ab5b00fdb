"""What a program that goes on after a stop says is already cut: comments such as `OUT 3 P1.outer ZONE 1 CW PIERCE 8 3`.

What these say is taken for granted: nobody can see at the desk what lies on the table.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.ops import substring

from kerfwise.encoder.cut import Cut, Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.rules.rule import Violation

from .covering.free import at_tabs
from .covering.intervals import rest
from .names import folded, ids_by_name
from .rings import torch_rings
from .runs_from_cuts import unlit_tabs

_RULE = "every-contour-once"
_NUMBER = r"-?\d+(?:\.\d+)?"
_RESUME = re.compile(r"RESUME AFTER CUT (?P<made>\d{1,9})(?:, CUT \d+ AGAIN)?", re.IGNORECASE)
_OUT = re.compile(
    rf"(?P<how>OUT|BROKEN) (?P<order>\d{{1,9}}) (?P<contour>.+) ZONE (?P<zone>\d{{1,9}}) (?P<way>CW|CCW) "
    rf"PIERCE (?P<x>{_NUMBER}) (?P<y>{_NUMBER})",
    re.IGNORECASE,
)
_LEAD = re.compile(
    r"(?P<how>OUT|BROKEN) (?P<order>\d{1,9}) (?P<what>LEAD|LINK) (?P<which>IN|OUT) "
    rf"(?P<rows>{_NUMBER}(?: {_NUMBER})*)",
    re.IGNORECASE,
)


_TAB = re.compile(
    rf"(?P<how>OUT|BROKEN) (?P<order>\d{{1,9}}) TAB (?P<x>{_NUMBER}) (?P<y>{_NUMBER}) (?P<width>{_NUMBER})",
    re.IGNORECASE,
)
_SLIT = re.compile(r"\.slit\d+$", re.IGNORECASE)


@dataclass(frozen=True, eq=False, slots=True)
class Resumed:
    """The cuts made before, in order, the one that broke off, and what is wrong with how they are told."""

    cuts: tuple[Cut, ...] = ()
    broken_off: Cut | None = None
    violations: tuple[Violation, ...] = ()


def read_resumed(nest: Nest, comments: Iterable[str]) -> Resumed:
    """What the comments of a program say of the cuts before its first."""
    said = list(comments)
    after = next((int(found["made"]) for found in map(_RESUME.fullmatch, said) if found), None)
    if after is None:
        return Resumed()
    ids = ids_by_name(nest, said)
    leads: dict[tuple[str, int, str], list[float]] = defaultdict(list)
    linked: set[tuple[str, int, str]] = set()
    for found in filter(None, map(_LEAD.fullmatch, said)):
        key = (found["how"].upper(), int(found["order"]), found["which"].upper())
        leads[key] += [float(word) for word in found["rows"].split()]
        linked |= {key} if found["what"].upper() == "LINK" else set()
    tabs: dict[tuple[str, int], tuple[Tab, ...]] = defaultdict(tuple)
    for found in filter(None, map(_TAB.fullmatch, said)):
        tab = Tab((float(found["x"]), float(found["y"])), float(found["width"]))
        tabs[found["how"].upper(), int(found["order"])] += (tab,)
    cuts: dict[int, Cut] = {}
    broken_off: Cut | None = None
    wrong: list[str] = []
    for found in filter(None, map(_OUT.fullmatch, said)):
        order, how, name = int(found["order"]), found["how"].upper(), ids.get(folded(found["contour"]))
        if name is None:
            wrong.append(f"cut {order} is said to be of {found['contour']}, which the nest does not have")
            continue
        lead_in, lead_out = (_lead(leads.get((how, order, which), [])) for which in ("IN", "OUT"))
        pierce = (float(found["x"]), float(found["y"]))
        join = pierce if lead_in is None else (float(lead_in.vertices[-1, 0]), float(lead_in.vertices[-1, 1]))
        curve = nest.contour(name).curve
        entry = curve.point_at(curve.project(join)[0])
        way = "cw" if found["way"].upper() == "CW" else "ccw"
        cut = Cut(name, entry, "cw" if way == "cw" else "ccw", pierce, lead_in, lead_out, int(found["zone"]))
        cut = replace(cut, linked=(how, order, "IN") in linked, tabs=tabs[how, order])
        if how == "BROKEN":
            broken_off = cut
        else:
            cuts[order] = cut
    if sorted(cuts) != list(range(1, after + 1)):
        wrong.append(f"it goes on after cut {after}, but lists {len(cuts)} cuts that are out")
    told = tuple(Violation(_RULE, (), text) for text in wrong)
    return Resumed(tuple(cuts[k] for k in sorted(cuts)), broken_off, told)


@dataclass(frozen=True, eq=False, slots=True)
class BurntBefore:
    """What cuts before a stop have burnt: the ways round their contours, but for tabs, and other lines, as leads are.

    `out` are the ids of the contours that they cut.
    """

    rounds: tuple[shapely.LineString, ...] = ()
    others: tuple[shapely.LineString, ...] = ()
    out: frozenset[str] = frozenset()

    @property
    def lines(self) -> tuple[shapely.LineString, ...]:
        """All that is burnt."""
        return (*self.rounds, *self.others)


NOTHING_BURNT = BurntBefore()


def burnt_by(nest: Nest, made: Sequence[Cut], kerf_mm: float) -> BurntBefore:
    """What cuts before a stop have burnt."""
    rows = [(c, cut) for cut in made if cut.contour in nest.index and (c := nest.contour(cut.contour)).kind != "mark"]
    rings = torch_rings([contour for contour, _ in rows], kerf_mm)
    rounds: list[shapely.LineString] = []
    others = [lead.line() for cut in made for lead in (cut.lead_in, cut.lead_out) if lead is not None and lead.segments]
    for (contour, cut), ring in zip(rows, rings, strict=True):
        if ring is not None:
            (rounds if contour.encloses else others).extend(_lit(ring, cut, kerf_mm))
    return BurntBefore(tuple(rounds), tuple(others), frozenset(contour.id for contour, _ in rows))


def _lit(ring: shapely.LineString, cut: Cut, kerf_mm: float) -> Iterator[shapely.LineString]:
    """What of a contour's ring is burnt: all of it but for the tabs of its cut."""
    if not cut.tabs:
        yield ring
        return
    off = at_tabs(ring, unlit_tabs(cut, kerf_mm), 0.0)
    yield from (substring(ring, low, high) for low, high in rest(off, ring.length).tolist())


def told_ends(comments: Iterable[str]) -> Iterator[tuple[str, Point, Point]]:
    """Name, where its lead-in ends and where the torch went off, of each slit that comments say is already cut."""
    said = list(comments)
    leads: dict[tuple[str, str], list[float]] = defaultdict(list)
    for found in filter(None, map(_LEAD.fullmatch, said)):
        leads[f"{found['how']} {found['order']}".upper(), found["which"].upper()] += map(float, found["rows"].split())
    for found in filter(None, map(_OUT.fullmatch, said)):
        head, name = f"OUT {found['order']}", found["contour"]
        lead_in, lead_out = (_lead(leads.get((head, which), [])) for which in ("IN", "OUT"))
        if found["how"].upper() == "OUT" and _SLIT.search(name) and lead_out is not None:
            pierce = (float(found["x"]), float(found["y"]))
            start = pierce if lead_in is None else lead_in.vertices[-1, :2].tolist()
            x, y = lead_out.vertices[-1, :2].tolist()
            yield name, (start[0], start[1]), (x, y)


def _lead(numbers: list[float]) -> Curve | None:
    """x, y and bulge of each vertex."""
    if not numbers or len(numbers) % 3:
        return None
    return Curve(np.array(numbers).reshape(-1, 3), closed=False)
