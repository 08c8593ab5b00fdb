"""The pieces of a drawing, told apart by what their layers are for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.listed import listed
from kerfwise.encoder.nest import Note

from .drawing import DrawnCurve
from .layers import DEFAULT, Layers, Purpose, Use, counted, setting

SOUNDS_LIKE = {
    "mark": "marks",
    "ignore": "something not to be cut",
    "sheet": "the sheet",
    "scrap": "scrap lines",
    "bridge": "bridges",
    "tab": "tabs",
}

_BESIDES: tuple[Purpose, ...] = ("mark", "sheet", "scrap", "bridge", "tab")


@dataclass(frozen=True, eq=False)
class ByLayer:
    """What is cut, what is marked, the sheet, what cuts up the skeleton, bridges, tabs, and what is left out."""

    cut: tuple[DrawnCurve, ...]
    mark: tuple[DrawnCurve, ...]
    sheet: tuple[DrawnCurve, ...]
    scrap: tuple[DrawnCurve, ...]
    bridge: tuple[DrawnCurve, ...]
    tab: tuple[DrawnCurve, ...]
    notes: tuple[Note, ...]


def by_layer(pieces: Sequence[DrawnCurve], layers: Layers) -> ByLayer:
    """The pieces by the purpose of their layers.

    Raises
    ------
    InputError
        When there is nothing to cut, or a profile that says which layers are cut says nothing of one that is drawn on.
    """
    if not pieces:
        raise InputError("nothing to cut: the drawing holds no line, arc, circle, polyline, ellipse or spline")
    uses = {names: layers.use(names) for names in dict.fromkeys(p.names for p in pieces)}
    of: dict[Purpose | None, list[DrawnCurve]] = {}
    for piece in pieces:
        of.setdefault(uses[piece.names].purpose, []).append(piece)
    if None in of:
        drawn = counted(p.layer for p in of[None])
        raise InputError(
            f"drawing.layers says nothing of some lines: {drawn}; let cut, mark, ignore, sheet, scrap, bridge "
            "or tab match their layers"
        )
    if "cut" not in of:
        raise InputError(_nothing(pieces, uses))
    notes = [*_left_out(of), *_misheard([p for p in of["cut"] if not uses[p.names].stated])]
    mark, sheet, scrap, bridge, tab = (tuple(of.get(purpose, ())) for purpose in _BESIDES)
    return ByLayer(tuple(of["cut"]), mark, sheet, scrap, bridge, tab, tuple(notes))


def _left_out(of: dict[Purpose | None, list[DrawnCurve]]) -> list[Note]:
    ignored = of.get("ignore")
    if not ignored:
        return []
    text = f"left out, as drawing.layers.ignore matches their layers: {counted(p.layer for p in ignored)}"
    return [Note("warning", text)]


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


def _nothing(pieces: Sequence[DrawnCurve], uses: Mapping[tuple[str, ...], Use]) -> str:
    layers = {p.layer: uses[p.names] for p in pieces}
    said = listed([f"'{layer}' is {_word(layers[layer])}" for layer in sorted(layers)], 8)
    count = Counter(p.layer for p in pieces)
    likely = min(layers, key=lambda layer: (layers[layer].purpose == "sheet", -count[layer], layer))
    if layers[likely].stated:
        advice = f"let drawing.layers.{layers[likely].purpose} match less"
    else:
        advice = f"to cut one, say so in the profile: {setting('cut', likely)}"
    return f"nothing to cut: every line is on a layer that is not cut ({said}); {advice}"


def _word(use: Use) -> str:
    return {**SOUNDS_LIKE, "mark": "marked", "ignore": "left out"}[str(use.purpose)]
