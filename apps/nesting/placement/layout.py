"""Which parts go on which sheets, the last sheet laid anew, and layouts as nests and text."""

from __future__ import annotations

import io
import random
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import shapely

from kerfwise.encoder.bevels.bevel import Bevel
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import PART_TYPE, QUANTITY_KEY, Contour, Kind, Nest
from kerfwise.encoder.readers.json_nest import dxf_in_mm
from kerfwise.encoder.scrap import largest_rectangle

from .demand import QUARTERS, Demand, Spacing, Stock
from .fill import Going, Room, Taste, fill, largest_first, usable
from .nofit import Placed
from .shapes import Shapes


@dataclass(frozen=True, eq=False)
class Sheetful:
    """One sheet, of the stock of that number in the list, and what lies on it."""

    stock: Stock
    number: int
    placed: tuple[Placed, ...]

    def metal_mm2(self, wanted: Demand) -> float:
        """Metal of the parts on it."""
        return sum(wanted.types[one.kind].area_mm2 for one in self.placed)


def refill_sheet(
    sheet: Sheetful, placed: Iterable[Placed], shapes: Shapes, spacing: Spacing, tastes: Iterable[Taste]
) -> Sheetful | None:
    """The sheet with as many parts of each type as in `placed`, laid by the first taste that has room for all; or None.

    How they lay does not matter.
    """
    left = Counter(one.kind for one in placed)
    for taste in tastes:
        room = Room(shapes, sheet.stock.sheet, spacing)
        laid = fill(room, largest_first(shapes, sorted(left)), left, taste, every=True)
        if len(laid) == left.total():
            return replace(sheet, placed=tuple(laid))
    return None


@dataclass(frozen=True, eq=False)
class Layout:
    """All sheets, in the order in which they were filled; `by` says what laid them so."""

    wanted: Demand
    spacing: Spacing
    sheets: tuple[Sheetful, ...]
    by: str = ""

    @cached_property
    def missing(self) -> tuple[int, ...]:
        """How many of each part type are on no sheet."""
        laid = [one.kind for sheet in self.sheets for one in sheet.placed]
        return tuple(kind.quantity - laid.count(k) for k, kind in enumerate(self.wanted.types))

    @cached_property
    def score(self) -> tuple[float, float, float]:
        """The less the better: metal of parts that are missing, worth of the sheets, less what is left of the last."""
        missing_mm2 = sum(
            n * kind.area_mm2 * 2.0 ** (1 - min(kind.priority, 50))
            for n, kind in zip(self.missing, self.wanted.types, strict=True)
        )
        worth = sum(sheet.stock.worth for sheet in self.sheets if not sheet.stock.remnant)
        return round(missing_mm2, 3), round(worth, 3), -round(self.remnant_mm2, 3)

    @property
    def use(self) -> float:
        """Metal of all parts laid, of that of all sheets taken."""
        return share_used([self])

    @property
    def alike(self) -> tuple[object, ...]:
        """What two layouts have in common that are the same."""
        return tuple((sheet.number, frozenset(sheet.placed)) for sheet in self.sheets)

    @cached_property
    def remnant_mm2(self) -> float:
        """The largest rectangle that is left of the last sheet."""
        if not self.sheets:
            return 0.0
        last = self.sheets[-1]
        x0, y0, x1, y1 = largest_rectangle(last.stock.sheet, self.metal_of(last), self.spacing.gap_mm)
        return (x1 - x0) * (y1 - y0)

    def metal_of(self, sheet: Sheetful) -> list[shapely.Geometry]:
        """The parts on a sheet, as areas."""
        return [one.area(self.wanted.types[one.kind].part.polygon) for one in sheet.placed]


def share_used(layouts: Sequence[Layout]) -> float:
    """Metal of all parts laid, of that of all sheets taken."""
    whole = sum(sheet.stock.area_mm2 for layout in layouts for sheet in layout.sheets)
    metal = sum(sheet.metal_mm2(layout.wanted) for layout in layouts for sheet in layout.sheets)
    return metal / whole if whole else 0.0


def allot(
    wanted: Demand,
    shapes: Shapes,
    spacing: Spacing,
    order: Sequence[int],
    taste: Taste,
    going: Going = lambda: True,
    left: Mapping[int, int] | None = None,
    gone: Mapping[int, int] | None = None,
    buy: Sequence[int] = (),
    seen: Callable[[Sheetful], None] = lambda sheet: None,
) -> Layout:
    """Fill sheet after sheet until every part lies on one, no stock is left, or what is left fits on none.

    `order` are the part types as they are laid, one after the other; `left` says how many of them are, all where it is
    not given, and `gone` how many sheets of each stock are used already. `buy` are numbers of stock that come
    next after the remnants, in that order; only then sheets are chosen by what they hold. `seen` is told each sheet
    that was filled, whether it is taken or not.
    """
    left = {kind: wanted.types[kind].quantity if left is None else left[kind] for kind in order}
    used = [(gone or {}).get(number, 0) for number in range(len(wanted.stocks))]
    sheets: list[Sheetful] = []
    bought = list(buy)
    while any(left.values()) and going():
        best: Sheetful | None = None
        for number in _next(wanted, used, bought[:1]):
            stock = wanted.stocks[number]
            room = Room(shapes, stock.sheet, spacing)
            placed = fill(room, order, left, taste, going)
            full = Sheetful(stock, number, tuple(placed))
            if placed:
                seen(full)
            if placed and (best is None or _better(full, best, wanted)):
                best = full
            if stock.remnant and placed:
                break
        if bought and (best is None or not best.stock.remnant):
            bought.pop(0)
        elif best is None:
            break
        if best is None:
            continue
        sheets.append(best)
        used[best.number] += 1
        for one in best.placed:
            left[one.kind] -= 1
    return Layout(wanted, spacing, tuple(sheets))


def _next(wanted: Demand, used: Sequence[int], bought: Sequence[int]) -> list[int]:
    """The stock that may be taken next, by number: remnants first, the smallest first; of the rest, what is bought."""
    there = [
        k
        for k, stock in enumerate(wanted.stocks)
        if (stock.count is None or used[k] < stock.count) and (stock.remnant or not bought or k in bought)
    ]
    return sorted(there, key=lambda k: (not wanted.stocks[k].remnant, wanted.stocks[k].area_mm2, k))


def _better(one: Sheetful, other: Sheetful, wanted: Demand) -> bool:
    """Whether a sheet gives more metal of parts for what it is worth; all alike, the larger."""
    mine, its = (full.metal_mm2(wanted) / max(full.stock.worth, 1e-9) for full in (one, other))
    return mine > its * (1 + 1e-9) or (mine > its * (1 - 1e-9) and one.stock.area_mm2 > other.stock.area_mm2)


_ACROSS = (Taste(), Taste(blocks=True), Taste(reach=False))
_UP = (Taste(0.01, 1.0), Taste(0.01, 1.0, blocks=True), Taste(0.01, 1.0, reach=False))
_MORE_MM = 0.5
"""A rectangle has to become so much deeper."""


def squeeze_last_sheet(layout: Layout, shapes: Shapes, tries: int, seed: int, going: Going = lambda: True) -> Layout:
    """The layout with its last sheet laid so that the largest rectangle along a side is left that was found.

    Each try lays all its parts in less room than they have now, from the left or from below, in another order. The
    sheet is a rectangle, else the layout stays as it is.
    """
    if not layout.sheets:
        return layout
    chance, last = random.Random(seed), layout.sheets[-1]
    for number in range(tries):
        if not going():
            break
        last = _tried(layout, last, shapes, chance, number, going) or last
    return layout if last is layout.sheets[-1] else replace(layout, sheets=(*layout.sheets[:-1], last))


def _tried(
    layout: Layout, last: Sheetful, shapes: Shapes, chance: random.Random, number: int, going: Going
) -> Sheetful | None:
    x0, y0, x1, y1 = last.stock.sheet.bounds
    gap_mm = layout.spacing.gap_mm
    a, b, c, d = largest_rectangle(last.stock.sheet, layout.metal_of(last), gap_mm)
    area_mm2 = (c - a) * (d - b)
    if area_mm2 <= 0:
        return None
    across = number % 2 == 0
    right = x1 - gap_mm - area_mm2 / (y1 - y0) - _MORE_MM if across else x1
    top = y1 if across else y1 - gap_mm - area_mm2 / (x1 - x0) - _MORE_MM
    ground = usable(last.stock.sheet, layout.spacing).intersection(
        shapely.box(x0, y0, right + gap_mm / 2, top + gap_mm / 2)
    )
    placed = _all_in(Room(shapes, last.stock.sheet, layout.spacing, ground), last, chance, number, going)
    return None if placed is None else replace(last, placed=tuple(placed))


def _all_in(room: Room, last: Sheetful, chance: random.Random, number: int, going: Going) -> list[Placed] | None:
    """All parts of the sheet in that room, or None."""
    left = Counter(one.kind for one in last.placed)
    order = largest_first(room.shapes, sorted(left))
    if number >= 2 * len(_ACROSS):
        weight = {k: (room.shapes.types[k].area_mm2 ** 0.5) * chance.uniform(0.6, 1.4) for k in order}
        order.sort(key=lambda k: -weight[k])
    tastes = _ACROSS if number % 2 == 0 else _UP
    placed = fill(room, order, left, tastes[number // 2 % len(tastes)], going, every=True)
    return placed if len(placed) == len(last.placed) else None


# Layouts as nests, and nests as text: kerfwise-nest/1, arcs as arcs, and DXF.

TURNS = "turns"
"""The key of a part in a nest that says how it may lie, degrees, where it may not lie in all quarters."""


def nests_of(layout: Layout) -> list[Nest]:
    """A nest a sheet; copies are numbered through all sheets: `name-1`, `name-2`…"""
    count: Counter[int] = Counter()
    nests = []
    for sheet in layout.sheets:
        parts = []
        for one in sheet.placed:
            count[one.kind] += 1
            kind = layout.wanted.types[one.kind]
            part = one.part(kind.part, f"{kind.name}-{count[one.kind]}")
            part.attributes.pop(QUANTITY_KEY, None)  # each is one of them now
            attributes: dict[str, object] = {PART_TYPE: kind.name, "priority": kind.priority}
            more = {"order": kind.order, "due": kind.due, "material": kind.material, "thickness": kind.thickness_mm}
            part.attributes.update(attributes | {key: value for key, value in more.items() if value})
            if not kind.free and kind.turns_deg != QUARTERS:
                part.attributes[TURNS] = list(kind.turns_deg)
            parts.append(part)
        nests.append(Nest(sheet.stock.sheet, tuple(parts)))
    return nests


def nest_dxf(nest: Nest) -> str:
    """The nest as DXF R12, mm: the sheet on layer SHEET, contours on CUT, marks on MARK, arcs as bulges.

    Where parts have orders or due dates each is a block, with what is said of it in invisible attributes.
    """
    sheet = _polylines([(curve, "SHEET") for curve in (nest.sheet.outline, *nest.sheet.holes)])
    if not any(part.attributes.get(key) for part in nest.parts for key in ("order", "due")):
        return dxf_in_mm(_section("ENTITIES", sheet + _polylines(_drawn(nest.contours))) + _tags((0, "EOF")))
    blocks, inserts = "", ""
    for part in nest.parts:
        (x, y), contours = part.outer.curve.start, (part.outer, *part.holes, *part.marks)
        at = ((10, 0.0), (20, 0.0), (30, 0.0))
        blocks += _tags((0, "BLOCK"), (8, "0"), (2, part.id), (70, 2), *at, (3, part.id))
        blocks += _polylines(_drawn(contours)) + _tags((0, "ENDBLK"), (8, "0"))
        inserts += _tags((0, "INSERT"), (8, "0"), (66, 1), (2, part.id), *at)
        for key in (PART_TYPE, "order", "due", "priority", "material", "thickness"):
            if value := part.attributes.get(key):
                place = ((10, x), (20, y), (30, 0.0), (40, 1.0))
                text = escape_text(str(value))
                inserts += _tags((0, "ATTRIB"), (8, "0"), *place, (1, text), (2, key), (70, 1))
        inserts += _tags((0, "SEQEND"), (8, "0"))
    return dxf_in_mm(_section("BLOCKS", blocks) + _section("ENTITIES", sheet + inserts) + _tags((0, "EOF")))


def _drawn(contours: Iterable[Contour]) -> list[tuple[Curve, str]]:
    """Contours with their layers; one with bevels on single edges is drawn edge by edge."""
    found = []
    for contour in contours:
        if not contour.edge_bevels:
            found.append((contour.curve, _layer(contour.kind, contour.bevel)))
            continue
        for segment, bevel in zip(contour.curve.segments, contour.bevel_of_edge, strict=True):
            edge = Curve.of([(*segment.start, segment.bulge), segment.end], closed=False)
            found.append((edge, _layer(contour.kind, bevel)))
    return found


def _layer(kind: Kind, bevel: Bevel | None) -> str:
    """MARK, CUT, or a bevel, for a plant that maps such layers: `BEVEL_V_45_TOP`."""
    if bevel is not None:
        return f"BEVEL {bevel}".upper().replace(" ", "_")
    return "MARK" if kind == "mark" else "CUT"


def _polylines(curves: Iterable[tuple[Curve, str]]) -> str:
    """Curves with their layers, as the entities of a drawing."""
    from ezdxf.addons.r12writer import r12writer  # loaded by those who ask for a drawing only

    text = io.StringIO(newline="")
    with r12writer(text) as drawing:
        for curve, layer in curves:
            rows = curve.vertices.tolist()
            drawing.add_polyline_2d(rows, format="xyb", closed=curve.closed, layer=layer)
    whole = text.getvalue()
    begin, end = _tags((0, "SECTION"), (2, "ENTITIES")), _tags((0, "ENDSEC"), (0, "EOF"))
    return whole[whole.index(begin) + len(begin) : whole.rindex(end)]


def _section(name: str, entities: str) -> str:
    return _tags((0, "SECTION"), (2, name)) + entities + _tags((0, "ENDSEC"))


def _tags(*tags: tuple[int, object]) -> str:
    return "".join(f"{code}\n{value}\n" for code, value in tags)
