"""Facts as JSON that a rule author can read: contours by id, lengths in mm (schema: facts.schema.json)."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.candidates.candidate import Candidate

from .facts import SIDES, Facing, Facts, Stretch

FORMAT = "kerfwise-facts/1"


def facts_json(facts: Facts) -> str:
    """The facts as kerfwise-facts/1 text: stable key order, one zone, one contour, one candidate and one link a line.

    Everything about a contour stands in its row. `level_ahead` and `in_hull` there list the contours that lie ahead
    of it or in its hull, which are those to cut before it. Lengths are rounded to 0.001 mm.
    """
    nest, options = facts.nest, facts.options
    head: dict[str, Any] = {
        "format": FORMAT,
        "nest": {"file": nest.file, "sha256": nest.sha256},
        "options": {f.name: _plain(getattr(options, f.name)) for f in dataclasses.fields(options)},
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


def _contour_rows(facts: Facts) -> list[dict[str, Any]]:
    contours = facts.nest.contours
    ids = [c.id for c in contours]
    contains = _listed(facts.contains[:, 1], facts.contains[:, 0], ids)
    level_ahead = _listed(facts.level_ahead[:, 0], facts.level_ahead[:, 1], ids)
    in_hull = _listed(facts.in_hull[:, 0], facts.in_hull[:, 1], ids)
    beside = _listed(facts.scrap_beside[:, 1], facts.scrap_beside[:, 0], ids)
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
            **({"scrap_framed": bool(facts.scrap_framed[i]), "scrap_beside": beside[i]} if c.kind == "scrap" else {}),
            **({"feed_share": round(c.feed_share, 6)} if c.feed_share < 1 else {}),
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


def _listed(what: Ints, by: Ints, ids: list[str], rows: int | None = None) -> list[list[str]]:
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
