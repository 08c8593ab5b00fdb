"""Facts as JSON that a rule author can read, and as MiniZinc data."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.minizinc_data import (
    Fields,
    assignments,
    flags,
    length_table,
    lengths,
    numbers,
    numbers_from_1,
    relation,
    stretch_fields,
    texts,
)
from kerfwise.encoder.nest import KINDS

from .facts import SIDES, Facing, Facts, Stretch

FORMAT = "kerfwise-facts/1"


def facts_json(facts: Facts) -> str:
    """The facts as kerfwise-facts/1 text: stable key order, one zone, one contour, one candidate and one link a line.

    Everything about a contour stands in its row. `level_ahead` and `in_hull` there list the contours that lie ahead
    of it or in its hull, which are those to cut before it. Lengths are rounded to 0.001 mm.
    """
    nest, options = facts.nest, facts.options
    thresholds = (f.name for f in dataclasses.fields(options) if f.name != "columns")
    head: dict[str, Any] = {
        "format": FORMAT,
        "nest": {"file": nest.file, "sha256": nest.sha256},
        "options": {name: _plain(getattr(options, name)) for name in thresholds},
        "sheet_bounds_mm": [_mm(v) for v in nest.sheet.bounds],
        "start_side": facts.start_side,
        "start_side_because": facts.start_side_because,
        "sides": {
            side: {
                "offcut_mm": _mm(facts.offcut_mm[k]),
                "offcut_large": bool(facts.offcut_large[k]),
                "heat_mm": _mm(facts.heat_mm[k]),
                "heat_parts": int(facts.heat_parts[k]),
            }
            for k, side in enumerate(SIDES)
        },
    }
    if nest.not_cut:
        head["small_holes"] = {"marked": nest.spotted, "left_out": nest.left_out}
    lines = [f' "{key}": {_text(value)}' for key, value in head.items()]
    lines += [f' "zones": {_rows(_zone_rows(facts))}']
    lines += [f' "contours": {_rows(_contour_rows(facts))}', f' "candidates": {_rows(_candidate_rows(facts))}']
    lines += [f' "links": {_rows(_link_rows(facts))}'] if facts.links else []
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _plain(value: Any) -> Any:
    """A set as a sorted list: the same facts give the same text."""
    return sorted(value) if isinstance(value, frozenset) else value


def _zone_rows(facts: Facts) -> list[dict[str, Any]]:
    if not facts.n:
        return []
    heat_kj, contours = facts.zone_heat_kj, np.bincount(facts.zone)[1:]
    return [
        {"zone": k, "contours": int(of), "heat_kj": _kj(kj)}
        for k, (of, kj) in enumerate(zip(contours, heat_kj, strict=True), 1)
    ]


DRAWN = ("layer", "colour", "linetype", "block", "text")
"""What the drawing says of a contour, where it does."""


def _contour_rows(facts: Facts) -> list[dict[str, Any]]:
    contours = facts.nest.contours
    ids = [c.id for c in contours]
    contains = _listed(facts.contains[:, 1], facts.contains[:, 0], ids)
    level_ahead = _listed(facts.level_ahead[:, 0], facts.level_ahead[:, 1], ids)
    in_hull = _listed(facts.in_hull[:, 0], facts.in_hull[:, 1], ids)
    own: dict[str, list[Any]] = {
        name: _listed(column.values[:, 1], column.values[:, 0], ids) if column.pairs else column.values.tolist()
        for name, column in facts.columns.items()
    }
    neighbours: list[list[dict[str, Any]]] = [[] for _ in ids]
    for row, other, length_mm, gap_mm in _facing_rows(facts.neighbours):
        neighbours[row].append({"contour": ids[other], "length_mm": _mm(length_mm), "gap_mm": _mm(gap_mm)})
    return [
        {
            "id": c.id,
            "part": c.part,
            "kind": c.kind,
            "parent": ids[facts.parent[i]] if facts.parent[i] >= 0 else None,
            "zone": int(facts.zone[i]),
            "long": bool(facts.long[i]),
            "length_mm": _mm(c.curve.length_mm),
            "heat_kj": _kj(facts.torch_heat_kj[i]),
            "contains": contains[i],
            "level_ahead": level_ahead[i],
            "in_hull": in_hull[i],
            "neighbours": neighbours[i],
            "edge_gap_mm": _by_side(facts.edge_gap_mm[i]),
            "edge_length_mm": _by_side(facts.edge_length_mm[i]),
            "solid_mm": _mm(facts.solid_mm[i]),
            **{name: rows[i] for name, rows in own.items() if facts.columns[name].kind in (None, c.kind)},
            **({"feed_share": round(c.feed_share, 6)} if c.feed_share < 1 else {}),
            **{key: value for key in DRAWN if (value := getattr(c.source, key))},
        }
        for i, c in enumerate(contours)
    ]


def _candidate_rows(facts: Facts) -> list[dict[str, Any]]:
    ids = [c.id for c in facts.nest.contours]
    head, tail = _stretch_rows(facts.head, ids), _stretch_rows(facts.tail, ids)
    rings = _listed(facts.older_kerfs.rings[:, 1], facts.older_kerfs.rings[:, 0], ids, len(facts.candidates))
    leads: list[list[int]] = [[] for _ in facts.candidates]
    for later, earlier in facts.older_kerfs.leads.tolist():
        leads[later].append(earlier)
    return [
        {
            "candidate": k,
            **_candidate(c, ids),
            "meets_kerfs_of": rings[k],
            "meets_leads_of": leads[k],
            "head": head[k],
            "tail": tail[k],
        }
        for k, c in enumerate(facts.candidates)
    ]


def _link_rows(facts: Facts) -> list[dict[str, Any]]:
    contours, candidates = facts.nest.contours, facts.candidates
    return [
        {
            "from": contours[candidates[link.leave[0]].contour].id,
            "to": contours[candidates[link.reach[0]].contour].id,
            "leave": link.leave,
            "reach": link.reach,
            "path": [[_mm(v) for v in at] for at in link.path],
            "length_mm": _mm(link.length_mm),
        }
        for link in facts.links
    ]


def _candidate(candidate: Candidate, ids: list[str]) -> dict[str, Any]:
    return {
        "contour": ids[candidate.contour],
        "entry": [_mm(v) for v in candidate.entry],
        "entry_mm": _mm(candidate.entry_mm),
        "direction": candidate.direction,
        "pierce": [_mm(v) for v in candidate.pierce],
        "end": [_mm(v) for v in candidate.end],
        "cut_mm": _mm(candidate.cut_mm),
        "edge_start": candidate.edge_start,
        **({"kerf_start": candidate.kerf_start, "out": list(candidate.out)} if candidate.span is not None else {}),
        **({"still_in": list(candidate.still_in)} if candidate.still_in else {}),
    }


def _stretch_rows(stretch: Stretch, ids: list[str]) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = [
        {"total_mm": _mm(total), "edge_mm": _mm(edge), "solid_mm": _mm(solid), "neighbours": []}
        for total, edge, solid in zip(stretch.total_mm, stretch.edge_mm, stretch.solid_mm, strict=True)
    ]
    for row, other, length_mm, _ in _facing_rows(stretch.neighbours):
        rows[row]["neighbours"].append({"contour": ids[other], "length_mm": _mm(length_mm)})
    return rows


def _facing_rows(facing: Facing) -> zip[tuple[int, int, float, float]]:
    arrays = (facing.row, facing.neighbour, facing.length_mm, facing.gap_mm)
    return zip(*(a.tolist() for a in arrays), strict=True)


def _listed(what: Any, by: Any, ids: list[str], rows: int | None = None) -> list[list[str]]:
    """For each contour (or each of so many rows) the ids of the `what` whose `by` it is."""
    lists: list[list[str]] = [[] for _ in range(len(ids) if rows is None else rows)]
    for w, b in zip(what.tolist(), by.tolist(), strict=True):
        lists[b].append(ids[w])
    return lists


def _by_side(values: Floats) -> dict[str, float]:
    return {side: _mm(value) for side, value in zip(SIDES, values, strict=True)}


def _mm(value: float) -> float:
    return round(float(value), 3) + 0.0  # never -0.0


def _kj(value: float) -> float | None:
    """Heat, None where it is not known."""
    return None if math.isnan(value) else round(float(value), 3)


def _text(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


def _rows(rows: list[dict[str, Any]]) -> str:
    return "[\n  " + ",\n  ".join(map(_text, rows)) + "\n ]" if rows else "[]"


# Facts as MiniZinc data, for rule authors and the MiniZinc engine.

CONTOURS_MAX = 2000

HEADER = """\
% Facts of a nest for MiniZinc (kerfwise-facts/1). Contours 1..n_contours, candidates 1..n_candidates.
% Every length and coordinate is an integer in 0.01 mm. Sides: 1 left, 2 right, 3 bottom, 4 top.
%
%   n_contours                number of contours
%   contour_id[i]             id of contour i, as in plans and reports
%   part[i]                   number of the part of i, in the order of the nest; each scrap line has its own
%   kind[i]                   1 outer, 2 hole, 3 mark, 4 slit, 5 scrap
%   parent[i]                 the contour that immediately contains i, 0 if none does
%   zone[i]                   zone of i, from 1
%   long[i]                   i is an outer contour, one side at least long_ratio times the other
%   start_side                the side where cutting starts
%   contains[i, j]            j lies inside i, directly or not
%   level_ahead[j, i]         j lies between the start side and i, on the level of i
%   in_hull[j, i]             j lies in the concavity of i
%   edge_gap[i, side]         distance of i from the side
%   edge_length[i, side]      boundary of i that faces the edge of the sheet there
%   solid_length[i]           boundary of i that faces wide uncut metal
%   n_facing                  pairs of contours that face each other closely; for each pair p
%   facing_from[p]            the contour whose boundary it is
%   facing_to[p]              the outer contour that it faces
%   facing_length[p]          length of that stretch of boundary
%   facing_gap[p]             smallest distance between the two
%   offcut_depth[side]        depth of the empty strip along the side
%   offcut_large[side]        it is large
%   heat_length[side]         cut length in the half of the sheet at the side
%   heat_parts[side]          small parts in that half
%   n_candidates              number of candidates; those of a contour follow each other; for each candidate c
%   cand_contour[c]           the contour it cuts
%   cand_x[c], cand_y[c]      where it pierces: idle travel arrives here
%   cand_end_x[c], cand_end_y[c]   where the torch goes off: idle travel leaves from here
%   cand_ccw[c]               it runs counter-clockwise (an open line: along it)
%   cand_cut_length[c]        torch-on path, leads and overcut included
%   cand_edge_start[c]        it comes in from the edge of the sheet and nothing is pierced
%   head_length[c]            the first stretch of its path round the contour, of which
%   head_edge[c], head_solid[c]    face the edge and solid metal, and the rest, for each p in 1..n_head,
%   head_cand[p], head_contour[p], head_facing[p]    faces that contour for that length
%   tail_length, tail_edge, tail_solid, n_tail, tail_cand, tail_contour, tail_facing    the same of the last stretch
"""


def facts_dzn(facts: Facts) -> str:
    """The facts as MiniZinc data text; its first lines say what each field is.

    Raises InputError if the nest has more than 2000 contours: relations are square arrays there, and exact models of
    that size are out of reach. JSON has no such limit.
    """
    n = facts.n
    if n > CONTOURS_MAX:
        raise InputError(f"{n} contours are too many for MiniZinc data (at most {CONTOURS_MAX}); write .json instead")
    contours = facts.nest.contours
    cands, near = facts.candidates, facts.neighbours
    fields: Fields = [
        ("n_contours", str(n)),
        ("contour_id", texts(c.id for c in contours)),
        ("part", numbers_from_1(facts.nest.owners)),
        ("kind", numbers_from_1(KINDS.index(c.kind) for c in contours)),
        ("parent", numbers_from_1(facts.parent)),
        ("zone", numbers(facts.zone)),
        ("long", flags(facts.long)),
        ("start_side", str(SIDES.index(facts.start_side) + 1)),
        ("contains", relation(facts.contains, n)),
        ("level_ahead", relation(facts.level_ahead, n)),
        ("in_hull", relation(facts.in_hull, n)),
        ("edge_gap", length_table(facts.edge_gap_mm.tolist(), len(SIDES))),
        ("edge_length", length_table(facts.edge_length_mm.tolist(), len(SIDES))),
        ("solid_length", lengths(facts.solid_mm)),
        ("n_facing", str(len(near.row))),
        ("facing_from", numbers_from_1(near.row)),
        ("facing_to", numbers_from_1(near.neighbour)),
        ("facing_length", lengths(near.length_mm)),
        ("facing_gap", lengths(near.gap_mm)),
        ("offcut_depth", lengths(facts.offcut_mm)),
        ("offcut_large", flags(facts.offcut_large)),
        ("heat_length", lengths(facts.heat_mm)),
        ("heat_parts", numbers(facts.heat_parts)),
        ("n_candidates", str(len(cands))),
        ("cand_contour", numbers_from_1(c.contour for c in cands)),
        ("cand_x", lengths(c.pierce[0] for c in cands)),
        ("cand_y", lengths(c.pierce[1] for c in cands)),
        ("cand_end_x", lengths(c.end[0] for c in cands)),
        ("cand_end_y", lengths(c.end[1] for c in cands)),
        ("cand_ccw", flags(c.direction == "ccw" for c in cands)),
        ("cand_cut_length", lengths(c.cut_mm for c in cands)),
        ("cand_edge_start", flags(c.edge_start for c in cands)),
        *_stretch_fields("head", facts.head),
        *_stretch_fields("tail", facts.tail),
    ]
    return HEADER + assignments(fields)


def _stretch_fields(name: str, stretch: Stretch) -> Fields:
    facing = ((i, j, mm) for i, j, mm, _ in _facing_rows(stretch.neighbours))
    return stretch_fields(name, stretch.total_mm, stretch.edge_mm, stretch.solid_mm, facing)
