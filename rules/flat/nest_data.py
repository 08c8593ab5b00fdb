"""The data of a rule's model file measured from a nest and its cuts, as the check knows them."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import shapely

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.minizinc_data import (
    PER_MM,
    Fields,
    flags,
    length_table,
    lengths,
    numbers,
    numbers_from_1,
    relation,
    stretch_fields,
    texts,
)
from kerfwise.encoder.nest import KINDS, Nest
from kerfwise.rules.judging.facing import Faced, faced_all_round, faced_by_cuts
from kerfwise.rules.own.criteria import none_has
from kerfwise.rules.own.known_nest import (
    SIDES,
    MeasuredNest,
    attributes,
    edge_gaps_mm,
)
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import USUAL, Plate

# The facts of `facts.mzn` as the check knows them: measured from the nest and its cuts, each cut being a candidate.
#
# Nothing here looks at the facts that models are built on. Only what a rule's file names is measured; the rest is
# there, as MiniZinc wants it, and empty.

NEVER_MS = 10**9


@dataclass(frozen=True, slots=True)
class Limits:
    """What facts hang on: how near is near, shares of a cut, and how long is long.

    `orders_by` are the options of the rules whose pairs are facts, by the rule's id: those of the profile. `plate` is
    the sheet's metal, and how it is cut.
    """

    web_mm: float = 25.0
    edge_band_mm: float = 25.0
    long_ratio: float = 4.0
    offcut_share: float = 0.15
    head_share: float = 0.25
    tail_share: float = 0.25
    orders_by: tuple[tuple[str, Any], ...] = ()
    plate: Plate = USUAL


def missing(cuts: CutSequence, text: str) -> str | None:
    """What the text of a rule names and these cuts do not state, and where to state it; None where nothing is missing.

    All else the check measures for itself.
    """
    named = _words(text)
    unzoned = next((f"cut {k} of {cut.contour}" for k, cut in enumerate(cuts, 1) if cut.zone < 1), None)
    if "zone" in named and unzoned is not None:
        return (
            f"the zone of {unzoned} is not stated: a program says it in comments such as (CUT 1 A.outer ZONE 1 CW), "
            "a case by zones"
        )
    if named & {"level_ahead", "start_side"} and cuts.start_side is None and len(cuts):
        return (
            "the side that cutting starts from is not stated: a program says it in a comment such as "
            "(START SIDE LEFT), a case by start_side"
        )
    if "pause_ms" in named and len(cuts) and not any(cut.end_s for cut in cuts):
        return "the times of the cuts are not stated: a plan and a program have them, a case says them by pause"
    return None


def measured_data(nest: Nest, cuts: CutSequence, limits: Limits, text: str) -> Fields:
    """Every field of `facts.mzn`, and of the cuts what `judged.mzn` reads; what the text does not name is empty."""
    n, contours, named = len(nest.contours), nest.contours, _words(text)
    parent = _parents(nest, cuts, limits)
    at, sheet = cuts.positions(), nest.sheet.polygon
    own = [cuts[at[c.id] - 1] if c.id in at else None for c in contours]
    known = MeasuredNest(nest, cuts, limits.long_ratio, limits.web_mm)
    zones = known.stated_zones
    fields: Fields = [
        ("n_contours", str(n)),
        ("contour_id", texts(c.id for c in contours)),
        ("part", numbers_from_1(nest.owners)),
        ("kind", numbers_from_1(KINDS.index(c.kind) for c in contours)),
        ("parent", numbers_from_1(parent)),
        ("zone", numbers(max(1, zones.get(c.id, _zone_of_part(nest, zones, c.part))) for c in contours)),
        ("long", flags(known.long() if "long" in named else [False] * n)),
        ("start_side", str(SIDES.index(cuts.start_side or "left") + 1)),
        ("contains", relation(_inside(parent), n)),
        *(
            (fact, relation(_pairs(nest, cuts, limits, fact) if fact in named else (), n))
            for fact in ("level_ahead", "in_hull")
        ),
        ("edge_gap", length_table(zip(*(edge_gaps_mm(nest, side) for side in SIDES), strict=True), len(SIDES))),
        *_all_round(nest, limits, named),
        *_sides(nest, limits),
        ("n_candidates", str(n)),
        ("cand_contour", numbers_from_1(range(n))),
        ("cand_x", lengths(0.0 if c is None else c.pierce[0] for c in own)),
        ("cand_y", lengths(0.0 if c is None else c.pierce[1] for c in own)),
        ("cand_end_x", lengths(0.0 if c is None else c.end[0] for c in own)),
        ("cand_end_y", lengths(0.0 if c is None else c.end[1] for c in own)),
        ("cand_ccw", flags(c is not None and c.direction == "ccw" for c in own)),
        ("cand_cut_length", lengths(_torch_on_mm(nest, c) for c in own)),
        ("cand_edge_start", flags(c is not None and not sheet.covers(shapely.Point(c.pierce)) for c in own)),
    ]
    for name, last, share in (("head", False, limits.head_share), ("tail", True, limits.tail_share)):
        wanted = any(word.startswith(f"{name}_") or word == f"n_{name}" for word in named)
        faced = faced_by_cuts(nest, cuts, share, limits.web_mm, limits.edge_band_mm, last=last) if wanted else {}
        fields += _stretch(name, faced, n)
    return fields


def orders_data(nest: Nest, orders: Sequence[CutSequence]) -> Fields:
    """When each contour is cut, in many orders of the same cuts."""
    rows = [dict(order_data(nest, cuts)) for cuts in orders]
    shape = f"1..{len(orders)}, 1..{len(nest.contours)}"
    names = ("position", "begin_ms", "end_ms")
    tables = [(name, ", ".join(row[name].strip("[]") for row in rows)) for name in names]
    return [
        ("n_orders", str(len(orders))),
        *((f"order_{name}", f"array2d({shape}, [{cells}])") for name, cells in tables),
    ]


def order_data(nest: Nest, cuts: CutSequence) -> Fields:
    """When each contour is cut; one that is not cut, as if after all others and much later."""
    at = cuts.positions()
    uncut = [contour.id for contour in nest.contours if contour.id not in at]
    place = at | {name: k for k, name in enumerate(uncut, len(at) + 1)}
    own = [cuts[at[c.id] - 1] if c.id in at else None for c in nest.contours]
    return [
        ("position", numbers(place[c.id] for c in nest.contours)),
        ("begin_ms", numbers(NEVER_MS if c is None else round(c.start_s * 1000) for c in own)),
        ("end_ms", numbers(NEVER_MS if c is None else round(c.end_s * 1000) for c in own)),
    ]


def _words(text: str) -> set[str]:
    return set(re.findall(r"[A-Za-z_]\w*", text))


def _parents(nest: Nest, cuts: CutSequence, limits: Limits) -> list[int]:
    """The contour immediately around each, -1 for none."""
    found = [-1] * len(nest.contours)
    for inner, outer in _pairs(nest, cuts, limits, "parent"):
        found[inner] = outer
    return found


def _pairs(nest: Nest, cuts: CutSequence, limits: Limits, fact: str) -> list[tuple[int, int]]:
    """Pairs of contours of a fact, as the rule that judges by it measures them."""
    orders = dict(limits.orders_by)
    return [
        (nest.index[a], nest.index[b])
        for rule in RULES.values()
        if rule.pairs_are == fact
        for a, b in rule.pairs(nest, cuts, orders[rule.id] if rule.id in orders else rule.Options())
    ]


def _inside(parent: Sequence[int]) -> list[tuple[int, int]]:
    """Each contour with every one that it lies in: (outer, inner)."""
    found = []
    for k, around in enumerate(parent):
        while around >= 0:
            found.append((around, k))
            around = parent[around]
    return found


def _zone_of_part(nest: Nest, zones: Mapping[str, int], part: str) -> int:
    return max((zones.get(c.id, 0) for c in nest.part_of[part]), default=0) if part in nest.part_of else 0


def _all_round(nest: Nest, limits: Limits, named: set[str]) -> Fields:
    n = len(nest.contours)
    wanted = named & {"edge_length", "solid_length", "n_facing", "FACING", "facing_from", "facing_to", "facing_length"}
    faced = faced_all_round(nest, limits.web_mm, limits.edge_band_mm) if wanted else {}
    rows = _facing(faced)
    lines = [c.line for c in nest.contours]
    nearest = _nearest_sides(nest)
    edges = [[faced[k].edge_mm if k in faced and nearest[k] == s else 0.0 for k in range(n)] for s in range(len(SIDES))]
    return [
        ("edge_length", length_table(zip(*edges, strict=True), len(SIDES))),
        ("solid_length", lengths(faced[k].solid_mm if k in faced else 0.0 for k in range(n))),
        ("n_facing", str(len(rows))),
        ("facing_from", numbers_from_1(i for i, _, _ in rows)),
        ("facing_to", numbers_from_1(j for _, j, _ in rows)),
        ("facing_length", lengths(mm for _, _, mm in rows)),
        ("facing_gap", lengths(shapely.distance(lines[i], lines[j]) for i, j, _ in rows)),
    ]


def _nearest_sides(nest: Nest) -> list[int]:
    gaps = [edge_gaps_mm(nest, side) for side in SIDES]
    return [min(range(len(SIDES)), key=lambda s: gaps[s][k]) for k in range(len(nest.contours))]


def _sides(nest: Nest, limits: Limits) -> Fields:
    x0, y0, x1, y1 = nest.sheet.bounds
    extent = (x1 - x0, x1 - x0, y1 - y0, y1 - y0)
    depth = [min([*edge_gaps_mm(nest, side), extent[s]]) for s, side in enumerate(SIDES)]
    far = x1 - x0 + y1 - y0
    a, b, c, d, mx, my = x0 - far, y0 - far, x1 + far, y1 + far, (x0 + x1) / 2, (y0 + y1) / 2
    halves = ((a, b, mx, d), (mx, b, c, d), (a, b, c, my), (a, my, c, d))
    lines = [contour.line for contour in nest.contours if contour.shapes_part]
    outers = [part.outer.polygon for part in nest.parts]
    middle = sorted(o.area for o in outers)[(len(outers) - 1) // 2] if outers else 0.0
    small = [o.centroid for o in outers if o.area <= middle * (1 + 1e-9)]
    return [
        ("offcut_depth", lengths(depth)),
        ("offcut_large", flags(depth[s] > (limits.offcut_share + 1e-9) * extent[s] for s in range(len(SIDES)))),
        ("heat_length", lengths(float(shapely.length(shapely.clip_by_rect(lines, *h)).sum()) for h in halves)),
        ("heat_parts", numbers(sum(bool(shapely.box(*h).contains(p)) for p in small) for h in halves)),
    ]


def _torch_on_mm(nest: Nest, cut: Any) -> float:
    if cut is None:
        return 0.0
    leads = (cut.lead_in, cut.lead_out)
    return float(nest.contour(cut.contour).curve.length_mm + sum(lead.length_mm for lead in leads if lead is not None))


def _stretch(name: str, faced: Mapping[int, Faced], n: int) -> Fields:
    of = [faced.get(k, Faced(0.0, 0.0, 0.0, {})) for k in range(n)]
    columns = ((f.total_mm for f in of), (f.edge_mm for f in of), (f.solid_mm for f in of))
    return stretch_fields(name, *columns, _facing(faced))


def _facing(faced: Mapping[int, Faced]) -> list[tuple[int, int, float]]:
    return [(i, j, mm) for i, own in sorted(faced.items()) for j, mm in sorted(own.contours_mm.items())]


# Words about contours and the sheet beside the facts, of the nest and its plate alone: own rules know them, too.

_WORDS: Mapping[str, tuple[str, int]] = {
    "contour_area": ("area_mm2", 1),
    "contour_length": ("length_mm", PER_MM),
    "contour_width": ("width_mm", PER_MM),
    "contour_height": ("height_mm", PER_MM),
    "short_side": ("short_side_mm", PER_MM),
    "long_side": ("long_side_mm", PER_MM),
    **{f"contour_{key}": (key, 0) for key in ("layer", "colour", "block", "text")},
    "cut_ms": ("cut_s", 1000),
    "part_weight": ("weight_kg", 1000),
}
"""Word → the fact that it is, and its whole units in one of that fact's: 0.01 mm, mm², ms, g; 0 for a text."""


_COMPARED = re.compile(r'contour_(layer|colour|block|text)\s*\[[^\]]*\]\s*==?\s*"([^"]*)"')


def unknown_words(nest: Nest, text: str) -> str | None:
    """That a file compares what a drawing says of contours with what it says of none, such as another layer's name."""
    for key, words in _COMPARED.findall(text):
        there = {getattr(contour.source, key) for contour in nest.contours}
        if words and words not in there:
            return f"it compares with the {key} of no contour: {none_has(key, words, there)}"
    return None


def further_words(nest: Nest, text: str, plate: Plate = USUAL) -> str:
    """MiniZinc text that defines, with their values, the further words that a rule's text names.

    `attribute_NAME[i]` is what the nest's file says of the part of contour i: a number, rounded, or a text; 0 or ""
    where it says nothing, and there `has_attribute_NAME[i]` is false.
    """
    named = set(re.findall(r"[A-Za-z_]\w*", text))
    limits = Limits(plate=plate)
    known = MeasuredNest(nest, None, limits.long_ratio, limits.web_mm, plate)
    lines = []
    for word, (fact, per) in _WORDS.items():
        if word in named:
            values = known.values(fact)
            written = numbers(round(v * per) for v in values) if per else texts(values)
            lines.append(f"array[CONTOUR] of {'int' if per else 'string'}: {word} = {written};")
    of_sheet = {
        "int: sheet_thickness": round(plate.thickness_mm * PER_MM),
        "string: sheet_material": json.dumps(plate.material, ensure_ascii=False),
        "string: cutting_process": json.dumps(plate.process, ensure_ascii=False),
    }
    lines += [f"{word} = {value};" for word, value in of_sheet.items() if word.split()[1] in named]
    wanted = {re.sub(r"^(has_)?attribute_", "", w) for w in named if re.match(r"(has_)?attribute_\w", w)}
    for name in sorted(wanted):
        values = attributes(nest, name)
        present = [v for v in values if v is not None]
        lines.append(f"array[CONTOUR] of bool: has_attribute_{name} = {flags(v is not None for v in values)};")
        if all(isinstance(v, int | float) for v in present):
            lines.append(f"array[CONTOUR] of int: attribute_{name} = {numbers(round(v or 0) for v in values)};")
        else:
            written = texts("" if v is None else str(v) for v in values)
            lines.append(f"array[CONTOUR] of string: attribute_{name} = {written};")
    return "".join(f"{line}\n" for line in lines)
