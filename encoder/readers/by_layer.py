"""The pieces of a drawing, told apart by what their layers, colours and line types are for."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, cast, get_args

import numpy as np
import shapely

from kerfwise.encoder.bevels.bevel import Bevel, EdgeBevel
from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Contour, Nest, Note, Source
from kerfwise.encoder.questions import ANSWERED, LAYER, LIKELIEST, Asking, Choice, Question

from .drawing import DrawnCurve
from .join import join
from .layers import DEFAULT, Purpose, counted, doubtful, setting, surely_cut, surely_sheet
from .options import MM_PER, ReadOptions
from .reading import Taken

SOUNDS_LIKE = {
    "mark": "marks",
    "ignore": "something not to be cut",
    "sheet": "the sheet",
    "scrap": "scrap lines",
    "bridge": "bridges",
    "tab": "tabs",
}
WORDS = {
    "cut": "cut through",
    "mark": "marked, not cut through",
    "ignore": "left out",
    "sheet": "the sheet, and its holes",
    "scrap": "lines that cut up scrap",
    "bridge": "bridges",
    "tab": "tabs",
}
"""What lines of a layer are there for, as a choice says it."""

HELP_LINES = ("center", "hidden", "phantom", "dashdot", "chain", "divide", "border", "acad_iso", "strichpunkt", "axis")
"""How the names of line types begin that draw axes, edges that are not seen, and the like."""

PURPOSES = get_args(Purpose)
_BESIDES: tuple[Purpose, ...] = ("mark", "sheet", "scrap", "bridge", "tab")


class Look(NamedTuple):
    """What can say what a line is for: its names, outermost first, its colour and its line type."""

    names: tuple[str, ...]
    colour: str
    linetype: str


class Use(NamedTuple):
    """What lines are for, and why. `stated` if the plant's profile, or an answer, says that they are cut."""

    purpose: Purpose | None
    because: str
    stated: bool


@dataclass(frozen=True, eq=False)
class ByLayer:
    """What is cut, what is marked, the sheet, what cuts up the skeleton, bridges, tabs, and what is left out."""

    cut: tuple[DrawnCurve, ...]
    mark: tuple[DrawnCurve, ...]
    sheet: tuple[DrawnCurve, ...]
    scrap: tuple[DrawnCurve, ...]
    bridge: tuple[DrawnCurve, ...]
    tab: tuple[DrawnCurve, ...]
    ignored: tuple[DrawnCurve, ...]
    notes: tuple[Note, ...]
    uses: Mapping[Look, Use]

    def stated(self, piece: DrawnCurve) -> bool:
        """Whether the plant's profile, or an answer, says that this piece is cut."""
        use = self.uses[look_of(piece)]
        return use.purpose == "cut" and use.stated

    def taken(self) -> tuple[Taken, ...]:
        """What each layer is taken for; a row for each colour and line type where those are taken otherwise."""
        pieces = (*self.cut, *self.mark, *self.sheet, *self.scrap, *self.bridge, *self.tab, *self.ignored)
        rows: dict[str, Counter[tuple[str, str, str, str]]] = defaultdict(Counter)
        for piece in pieces:
            use = self.uses[look_of(piece)]
            rows[piece.layer][str(use.purpose), use.because, piece.colour, piece.linetype] += 1
        found = []
        for layer, counts in sorted(rows.items()):
            alike: Counter[tuple[str, str]] = Counter()
            for (purpose, because, _, _), count in counts.items():
                alike[purpose, because] += count
            if len(alike) == 1:
                [((purpose, because), count)] = alike.items()
                found.append(Taken(layer, purpose, because, count))
            else:
                found += [Taken(layer, p, b, n, colour, kind) for (p, b, colour, kind), n in sorted(counts.items())]
        return tuple(found)


def answered_as_cut(layers: ByLayer, piece: DrawnCurve) -> bool:
    """Whether somebody has answered that the layer of a piece is cut, and no profile for all drawings."""
    use = layers.uses[look_of(piece)]
    return use.purpose == "cut" and use.because in (ANSWERED, LIKELIEST) and use.stated


def look_of(piece: DrawnCurve) -> Look:
    """What can say what a piece is for."""
    return Look(piece.names, piece.colour, piece.linetype)


def by_layer(pieces: Sequence[DrawnCurve], options: ReadOptions, asking: Asking) -> ByLayer:
    """The pieces by the purpose of their layers; colours and line types that differ on cut layers are asked about.

    Raises InputError when there is nothing to cut, or a profile that says which layers are cut says nothing of one that
    is drawn on.
    """
    if not pieces:
        raise InputError("nothing to cut: the drawing holds no line, arc, circle, polyline, ellipse or spline")
    first = {look_of(p): p for p in reversed(pieces)}
    uses = {look: use_of(look, piece, options, asking) for look, piece in first.items()}
    uses |= _by_doubtful_names(pieces, uses, asking)
    uses |= _by_colour(pieces, uses, options.join_tolerance_mm, asking)
    uses |= _by_linetype(pieces, uses, asking)
    of: dict[Purpose | None, list[DrawnCurve]] = defaultdict(list)
    for piece in pieces:
        of[uses[look_of(piece)].purpose].append(piece)
    if of[None]:
        drawn = counted(p.layer for p in of[None])
        raise InputError(
            f"drawing.layers says nothing of some lines: {drawn}; let cut, mark, ignore, sheet, scrap, bridge "
            "or tab match their layers"
        )
    if not of["cut"] and not of["sheet"]:
        raise InputError(nothing_to_cut(pieces, uses))
    notes = [*_left_out(of["ignore"], uses), *_misheard([p for p in of["cut"] if not uses[look_of(p)].stated])]
    mark, sheet, scrap, bridge, tab = (tuple(of[purpose]) for purpose in _BESIDES)
    return ByLayer(tuple(of["cut"]), mark, sheet, scrap, bridge, tab, tuple(of["ignore"]), tuple(notes), uses)


def use_of(look: Look, piece: DrawnCurve, options: ReadOptions, asking: Asking) -> Use:
    """What the plant's patterns, an answer, the plant's colours and line types, or the names of a layer say."""
    purpose, own = options.layers.use(look.names)
    if own and purpose != "cut":
        return Use(purpose, f"by the profile (drawing.layers.{purpose})", True)
    answered = (asking.answered(f"{LAYER}{piece.layer}") or "").split(",")[0]
    if answered in PURPOSES:
        asking.used[f"{LAYER}{piece.layer}"] = asking.given[f"{LAYER}{piece.layer}"]
        return Use(cast(Purpose, answered), ANSWERED, True)
    for what, drawn, value in (
        ("colour", look.colour, options.colours),
        ("linetype", look.linetype, options.linetypes),
    ):
        for name, meant in value:
            if drawn and name.lower() == drawn.lower():
                return Use(meant, f"by the profile (drawing.layers.{what})", True)
    if own:
        return Use(purpose, "by the profile (drawing.layers.cut)", True)
    by_default = purpose == "cut" and not any(surely_cut(name) for name in look.names[-1:])
    return Use(purpose, "by default" if by_default else "by its name", False)


def _asked(question: str, text: str, order: Sequence[Purpose], asking: Asking) -> Use:
    """What somebody answers that some lines are for, or the first of the choices."""
    choices = tuple(Choice(purpose, WORDS[purpose]) for purpose in order)
    answer = cast(Purpose, asking.ask(Question(question, text, choices)))
    return Use(answer, asking.because(question), answer == "cut")


def _by_doubtful_names(pieces: Sequence[DrawnCurve], uses: Mapping[Look, Use], asking: Asking) -> dict[Look, Use]:
    """What layers are for whose names may mean lines that are not cut, beside others that are cut."""
    cut = [p for p in pieces if uses[look_of(p)].purpose == "cut"]
    loose = [p for p in cut if not uses[look_of(p)].stated]
    orders = {p.layer: doubtful(p.names) for p in loose}
    layers = dict.fromkeys(layer for layer, order in orders.items() if order)
    if all(p.layer in layers for p in cut):
        return {}
    found: dict[Look, Use] = {}
    for layer in layers:
        own = [p for p in loose if p.layer == layer]
        text = f"layer '{layer}' ({_lines(len(own))}) may not be meant to be cut, by its name: what is it?"
        use = _asked(f"{LAYER}{layer}", text, orders[layer], asking)
        found |= {look_of(p): use for p in own}
    return found


def _by_colour(
    pieces: Sequence[DrawnCurve], uses: Mapping[Look, Use], tolerance_mm: float, asking: Asking
) -> dict[Look, Use]:
    """Colours that differ on a layer that is cut by default: what those beside the outlines' own colour are for."""
    loose = [p for p in pieces if uses[look_of(p)] == ("cut", "by default", False)]
    of_layer: dict[str, set[str]] = defaultdict(set)
    for piece in loose:
        of_layer[piece.layer].add(piece.colour)
    mixed = [p for p in loose if len(of_layer[p.layer]) > 1]
    if not mixed:
        return {}
    outlines, marks = _colours_of_outlines(mixed), {p.colour for p in pieces if uses[look_of(p)].purpose == "mark"}
    found: dict[Look, Use] = {}
    for colour in sorted({p.colour for p in mixed} - outlines):
        same = [p for p in mixed if p.colour == colour]
        fillings = all(p.filled for p in same) and not all(p.filled for p in mixed)
        engraved = colour in marks or fillings or bool(join(same, tolerance_mm).chains)
        order: tuple[Purpose, ...] = ("mark", "cut", "ignore") if engraved else ("cut", "mark", "ignore")
        text = (
            f"{counted(p.layer for p in same)} {'is' if len(same) == 1 else 'are'} {_look(same, colour)}, beside lines "
            f"of other colours ({', '.join(sorted(outlines))}): what are they for?"
        )
        use = _asked(f"colour:{colour}", text, order, asking)
        found |= {look_of(p): use._replace(stated=False) for p in same}
    return found


def _look(same: Sequence[DrawnCurve], colour: str) -> str:
    return f"filled {colour}" if all(p.filled for p in same) else colour


def _colours_of_outlines(mixed: Sequence[DrawnCurve]) -> set[str]:
    """The colour of the lines that reach furthest out: whatever else there is, outlines of parts are cut."""
    size: Counter[str] = Counter()
    drawn = [p for p in mixed if not p.filled] or mixed
    for colour in {p.colour for p in mixed}:
        lines = np.array([p.curve.line() for p in drawn if p.colour == colour], dtype=object)
        if len(lines):
            x0, y0, x1, y1 = shapely.total_bounds(lines).tolist()
            size[colour] = int(1000 * (x1 - x0) * (y1 - y0)) + 1
    most = max(size.values(), default=0)
    return (
        {max((c for c in size if size[c] == most), key=lambda c: (c in ("red", "black", "white"), c))}
        if most
        else set()
    )


def _by_linetype(pieces: Sequence[DrawnCurve], uses: Mapping[Look, Use], asking: Asking) -> dict[Look, Use]:
    """Line types that differ among what is cut by default: a dashed line is seldom cut."""
    loose = [p for p in pieces if uses[look_of(p)] == ("cut", "by default", False)]
    found: dict[Look, Use] = {}
    if len({p.linetype for p in loose}) < 2:
        return found
    for kind in sorted({p.linetype for p in loose} - {""}):
        same = [p for p in loose if p.linetype == kind]
        order: tuple[Purpose, ...] = ("ignore", "mark", "cut")
        if not kind.lower().startswith(HELP_LINES):
            order = ("mark", "cut", "ignore")
        text = (
            f"{counted(p.layer for p in same)} {'is' if len(same) == 1 else 'are'} drawn {kind}, beside lines that are "
            "drawn through: what are they for?"
        )
        use = _asked(f"linetype:{kind}", text, order, asking)
        found |= {look_of(p): use._replace(stated=False) for p in same}
    return found


def sheet_by_name(read_layers: ByLayer, options: ReadOptions, asking: Asking) -> ByLayer:
    """The same, once it is clear of each layer that only sounds like the sheet whether it is: PLATE names parts, too.

    A name that says the sheet and nothing else decides, and so does one that says the size of its outline. Else the
    layer is asked about, unless something in the drawing makes it plain.
    """
    loose = [p for p in read_layers.sheet if not read_layers.uses[look_of(p)].stated]
    layers = dict.fromkeys(p.layer for p in loose)
    for layer in layers:
        own = [p for p in loose if p.layer == layer]
        others = [p for p in (*read_layers.cut, *read_layers.mark) if p.layer != layer]
        if is_surely_sheet(own, read_layers.cut, options):
            continue
        sheet_first = len(read_layers.cut) > 0 and _holds_parts(own, read_layers.cut)
        order: tuple[Purpose, ...] = ("sheet", "cut", "ignore") if sheet_first else ("cut", "sheet", "ignore")
        beside = f"; {_lines(len(others))} on other layers" if others else ""
        text = f"layer '{layer}' ({_lines(len(own))}) may be the sheet by its name, or a part{beside}: what is it?"
        if (use := _asked(f"{LAYER}{layer}", text, order, asking)).purpose != "sheet":
            read_layers = _moved(read_layers, own, use)
    return read_layers


def _lines(count: int) -> str:
    return "1 line" if count == 1 else f"{count} lines"


def is_surely_sheet(own: Sequence[DrawnCurve], cut: Sequence[DrawnCurve], options: ReadOptions) -> bool:
    """Whether a layer that sounds like the sheet can be nothing else, by its name or by its size."""
    names = {name for p in own for name in p.names[-1:]}
    if cut and all(surely_sheet(name) for name in names):
        return True
    lines = np.array([p.curve.line() for p in own], dtype=object)
    x0, y0, x1, y1 = shapely.total_bounds(lines).tolist()
    for per_unit in MM_PER.values():
        sides = {f"{(x1 - x0) / per_unit:.0f}", f"{(y1 - y0) / per_unit:.0f}"}
        if cut and any(sides <= set(re.findall(r"\d+", name)) for name in names):
            return True
    size = options.sheet_size_mm
    return size is not None and abs(x1 - x0 - size[0]) < 1.0 and abs(y1 - y0 - size[1]) < 1.0


def _holds_parts(own: Sequence[DrawnCurve], cut: Sequence[DrawnCurve]) -> bool:
    """Whether lines of a layer hold closed lines that hold closed lines themselves: parts with holes, most likely."""
    rings = [p for p in cut if p.curve.closed]
    if not rings:
        return False
    areas = np.array([p.area for p in rings], dtype=object)
    inner, outer = shapely.STRtree(areas).query(areas, predicate="within")
    return bool((inner != outer).any())


def _moved(layers: ByLayer, pieces: Sequence[DrawnCurve], use: Use) -> ByLayer:
    """The same with some of the sheet's pieces for something else."""
    gone = set(map(id, pieces))
    kept = tuple(p for p in layers.sheet if id(p) not in gone)
    uses = {**layers.uses, **{look_of(p): use for p in pieces}}
    now = replace(layers, sheet=kept, uses=uses)
    if use.purpose == "cut":
        return replace(now, cut=tuple(sorted((*layers.cut, *pieces), key=lambda p: p.order)))
    return replace(now, ignored=(*layers.ignored, *pieces))


def _left_out(ignored: Sequence[DrawnCurve], uses: Mapping[Look, Use]) -> list[Note]:
    by_name = [p for p in ignored if uses[look_of(p)].because not in (ANSWERED, LIKELIEST)]
    answered = [p for p in ignored if uses[look_of(p)].because in (ANSWERED, LIKELIEST)]
    notes = []
    if by_name:
        text = f"left out, as drawing.layers.ignore matches their layers: {counted(p.layer for p in by_name)}"
        notes.append(Note("warning", text))
    if answered:
        notes.append(Note("warning", f"left out, as answered: {counted(p.layer for p in answered)}"))
    return notes


def _misheard(cut: Sequence[DrawnCurve]) -> list[Note]:
    """Layers that are cut since a plant's own pattern took the place of the one that would have matched them."""
    heard = {p.layer: DEFAULT.use(p.names).purpose for p in cut}
    return [
        Note(
            "warning",
            f"layer '{layer}' is cut, though it sounds like {SOUNDS_LIKE[purpose]}: drawing.layers.{purpose} does not "
            "match it",
        )
        for layer, purpose in sorted(heard.items())
        if purpose is not None and purpose in SOUNDS_LIKE
    ]


def nothing_to_cut(pieces: Sequence[DrawnCurve], uses: Mapping[Look, Use]) -> str:
    """That there is nothing to cut, what each layer is taken for, and what to say in the profile."""
    layers = {p.layer: uses[look_of(p)] for p in pieces}
    count = Counter(p.layer for p in pieces)
    likely = min(layers, key=lambda layer: (layers[layer].purpose == "sheet", -count[layer], layer))
    text = join_names([f"'{layer}' is {_word(layers[layer])}" for layer in sorted(layers)], 8)
    if layers[likely].stated:
        advice = f"let drawing.layers.{layers[likely].purpose} match less"
    else:
        advice = f"to cut one, say so in the profile: {setting('cut', likely)}"
    return f"nothing to cut: every line is on a layer that is not cut ({text}); {advice}"


def _word(use: Use) -> str:
    return {**SOUNDS_LIKE, "mark": "marked", "ignore": "left out"}[str(use.purpose)]


# Bevels by layer or colour, as a plant maps them.


def with_bevels_by_look(nest: Nest, pieces: Sequence[DrawnCurve], bevels: Sequence[tuple[str, Bevel]]) -> Nest:
    """The nest with a bevel on each outer contour and hole whose layer matches a pattern, or whose colour is its name.

    The first that fits counts. Where a contour is drawn in several `pieces` each says so of its own edges.
    """
    if not bevels:
        return nest

    def looked_up(source: Source) -> Bevel | None:
        found = (
            bevel
            for key, bevel in bevels
            if key.lower() == source.colour.lower()
            or re.search(key, unicodedata.normalize("NFC", source.layer), re.IGNORECASE)
        )
        return next(found, None)

    of_pieces = [(piece.curve, looked_up(piece.source)) for piece in pieces if not piece.curve.closed]
    edges = [EdgeBevel(bevel, curve) for curve, bevel in of_pieces if bevel is not None]
    tree = shapely.STRtree([one.edge.line() for one in edges])

    def made(contour: Contour) -> Contour:
        near = [edges[k] for k in sorted(tree.query(contour.line, "dwithin", distance=_NEAR_MM).tolist())]
        mine = tuple(one for one in near if any(map(one.is_on, contour.curve.segments)))
        if mine:
            return replace(contour, edge_bevels=mine).with_one_bevel
        bevel = looked_up(contour.source)
        return contour if bevel is None else replace(contour, bevel=bevel)

    parts = (replace(part, outer=made(part.outer), holes=tuple(map(made, part.holes))) for part in nest.parts)
    return replace(nest, parts=tuple(parts))


_NEAR_MM = 0.1
