"""Programs whose burns are joined by hand into chains: the torch stays on from one contour to the next."""

from __future__ import annotations

import re
from dataclasses import dataclass

import shapely
from shapely.ops import substring

from kerfwise import Nest
from kerfwise.rule_kit import Cut
from kerfwise.tests.postproc.plans import cut_of

_COMMENT = re.compile(r"\((?:CUT|MARK) \d+ (?P<contour>\S+) ")
_PLACE = re.compile(r"X(?P<x>-?[\d.]+) Y(?P<y>-?[\d.]+)")


@dataclass(frozen=True)
class CutBlocks:
    """The blocks of one cut, from its comment to the torch off, and where its torch joins and goes off."""

    contour: str
    lines: list[str]
    joins: tuple[float, float]
    ends: tuple[float, float]

    @property
    def moves(self) -> list[str]:
        """Its moves after the lead-in."""
        feeds = [line for line in self.lines if re.match(r"(N\d+ )?G[123] ", line)]
        return feeds[1:]


@dataclass(frozen=True)
class Chained:
    """A program, and the contours of each of its burns."""

    text: str
    burns: list[list[str]]


def cuts_of(program: str) -> tuple[list[str], list[CutBlocks], list[str]]:
    """A program as its head, the blocks of its cuts, and its end."""
    lines = program.splitlines()
    begins = [k for k, line in enumerate(lines) if _COMMENT.match(line)]
    ends = [next(k for k in range(b, len(lines)) if re.match(r"N\d+ M(5|65)\b", lines[k])) for b in begins]
    cuts = []
    for b, e in zip(begins, ends, strict=True):
        rows = lines[b : e + 1]
        at = [_xy(line) for line in rows if re.match(r"N\d+ G[0123] ", line)]
        places = [xy for xy in at if xy is not None]
        cuts.append(CutBlocks(_COMMENT.match(rows[0])["contour"], rows, places[1], places[-1]))  # type: ignore[index]
    return lines[: begins[0]], cuts, lines[ends[-1] + 1 :]


def _xy(line: str) -> tuple[float, float] | None:
    found = _PLACE.search(line)
    return (float(found["x"]), float(found["y"])) if found else None


def chained(program: str, nest: Nest, kerf_mm: float, most: int) -> Chained:
    """Join up to `most` burns that follow each other by straight links, where these lie in waste."""
    head, cuts, end = cuts_of(program)
    parts = [shapely.make_valid(part.outer.polygon) for part in nest.parts]
    rings = shapely.STRtree(shapely.buffer(parts, kerf_mm / 2 - 0.02))
    near = shapely.STRtree(shapely.buffer(parts, kerf_mm / 2 + 0.3))
    text, burns = list(head), list[list[str]]()
    for k, cut in enumerate(cuts):
        link = shapely.LineString([cuts[k - 1].ends, cut.joins])
        joined = (
            k > 0
            and len(burns[-1]) < most
            and all(name.endswith(".outer") for name in (cut.contour, cuts[k - 1].contour))
            and link.length > 2 * kerf_mm
            and not len(near.query(substring(link, kerf_mm, link.length - kerf_mm), "intersects"))
            and not len(rings.query(link, "intersects"))
        )
        if not joined:
            text += cut.lines
            burns.append([cut.contour])
            continue
        text.pop()  # the torch stays on
        text += [cut.lines[0], f"G1 X{cut.joins[0]} Y{cut.joins[1]}", *cut.moves, cut.lines[-1]]
        burns[-1].append(cut.contour)
    return Chained("\n".join([*text, *end, ""]), burns)


def cuts_in_rows(nest: Nest, kerf_mm: float, parts_in_a_row: int = 5, ways: int = 24) -> list[Cut]:
    """Cuts of a nest, the holes of a few parts first and then their outlines, each joined where a link to it is free.

    Where there is no such place, the nearest will do. Nobody minds rules here.
    """
    areas = [shapely.make_valid(part.outer.polygon) for part in nest.parts]
    rings = shapely.STRtree(shapely.buffer(areas, kerf_mm / 2 - 0.02))
    made: list[Cut] = []
    for k in range(0, len(nest.parts), parts_in_a_row):
        row = nest.parts[k : k + parts_in_a_row]
        made += [cut_of(hole, 0.1, "ccw", kerf_mm=kerf_mm, lead_mm=1.0) for part in row for hole in part.holes]
        for number, part in enumerate(row):
            tried = [cut_of(part.outer, way / ways, "cw", kerf_mm=kerf_mm, lead_mm=2.0) for way in range(ways)]
            if number == 0:
                to = row[1].outer.line if len(row) > 1 else part.outer.line
                made.append(min(tried, key=lambda cut: to.distance(shapely.Point(cut.end))))
                continue
            links = [shapely.LineString([made[-1].end, cut.lead_in.vertices[-1, :2]]) for cut in tried if cut.lead_in]
            blocked = [len(rings.query(link, "intersects")) > 0 for link in links]
            best = min(range(ways), key=lambda way: (blocked[way], links[way].length))
            made.append(tried[best])
    return made
