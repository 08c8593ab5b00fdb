"""What a drawing writes, and its points: engraved on layers for marks, elsewhere left out and said."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
import shapely

from kerfwise.encoder.contour_checks import metal_of
from kerfwise.encoder.nest import Contour, Note, Part
from kerfwise.encoder.questions import Asking, Choice, Question

from .by_layer import WORDS, ByLayer, Use, look_of, use_of
from .drawing import DrawnCurve, DrawnText
from .layers import Purpose
from .options import ReadOptions
from .reading import Taken, Writing

FIRST = 3
"""So many texts and places are shown in a message."""


@dataclass(frozen=True, eq=False)
class Engraved:
    """The texts and points that are engraved, those that are not, and why; `notes` say so."""

    marked: tuple[DrawnText, ...]
    left_out: tuple[DrawnText, ...]
    taken: tuple[Taken, ...]
    notes: tuple[Note, ...]


def engraved(texts: Sequence[DrawnText], layers: ByLayer, options: ReadOptions, asking: Asking) -> Engraved:
    """What becomes of texts and points, by the use of their layers; an answer for those of a layer goes before it.

    Raises InputError for an answer that is none of the choices.
    """
    marked: list[DrawnText] = []
    failed: list[tuple[DrawnText, str]] = []
    left: dict[str, list[DrawnText]] = {"text": [], "point": []}
    rows: Counter[tuple[str, str, str]] = Counter()
    silent: list[DrawnText] = []
    for text in texts:
        use = _use(text, layers, options, asking)
        if use.purpose == "mark" and (why := _why_not(text)):
            failed.append((text, why))
        elif use.purpose == "mark":
            marked.append(text)
            rows[text.look.layer, use.because, "text" if text.text else "point"] += 1
        elif use.purpose == "ignore":
            silent.append(text)
        else:
            left[_what(text)].append(text)
    notes = [note for those in left.values() if those for note in _not_marked(those)]
    notes += [Note("warning", f"left out, as {why}: the {text.place}") for text, why in failed[:MOST_NOTES]]
    if len(failed) > MOST_NOTES:
        notes.append(Note("warning", f"left out, as those before: {len(failed) - MOST_NOTES} more texts"))
    taken = [Taken(layer, "mark", because, n, what=what) for (layer, because, what), n in sorted(rows.items())]
    gone = (*(text for text, _ in failed), *silent, *(text for those in left.values() for text in those))
    return Engraved(tuple(marked), gone, tuple(taken), tuple(notes))


def _why_not(text: DrawnText) -> str:
    """Why a text cannot be engraved, and what to do; "" where it can."""
    if text.text and not text.trouble and text.height_mm < SMALLEST_MM:
        return f"its capitals are {text.height_mm:.3g} mm tall, less than {SMALLEST_MM:g} mm"
    why = text.trouble or ("" if text.strokes else "it has no strokes")
    return f"{why} (turn it into lines in CAD)" if why else ""


SMALLEST_MM = 0.5
"""Nobody reads smaller letters, and no torch writes them."""
MOST_NOTES = 20


def question_of(text: DrawnText) -> str:
    """The id of the answer for the texts, or the points, of a layer: nobody is asked, for without one all is said."""
    return f"{_what(text)}:{text.look.layer}"


def _what(text: DrawnText) -> str:
    return "text" if text.text else "point"


def _use(text: DrawnText, layers: ByLayer, options: ReadOptions, asking: Asking) -> Use:
    """By the answer for its layer, or for all texts or points, else by what its layer is for."""
    name = next((one for one in (question_of(text), _what(text)) if asking.answered(one) is not None), None)
    if name is not None:
        choices = tuple(Choice(purpose, WORDS[purpose]) for purpose in ("mark", "ignore"))
        answer = asking.ask(Question(name, f"what are the {_what(text)}s of layer '{text.look.layer}'", choices))
        return Use(cast(Purpose, answer), asking.because(name), True)
    look = look_of(text.look)
    return layers.uses[look] if look in layers.uses else use_of(look, text.look, options, asking)


def _not_marked(texts: Sequence[DrawnText]) -> list[Note]:
    """How many texts, or points, are left out on which layers, what the first ones say, and what engraves them."""
    layers = sorted({text.look.layer for text in texts})
    if len(layers) > MOST_LAYERS:
        names = f"{', '.join(repr(layer) for layer in layers[:FIRST])}, …"
        return [_note(texts, f"the {len(layers)} layers {names} are", _what(texts[0]))]
    return [
        _note(those, f"layer '{layer}' is" if layer else "what stands in no group is", question_of(those[0]))
        for layer in layers
        for those in [[text for text in texts if text.look.layer == layer]]
    ]


MOST_LAYERS = 3
"""Texts on more layers than this are told together."""


def _note(texts: Sequence[DrawnText], where: str, question: str) -> Note:
    what, one = _what(texts[0]), len(texts) == 1
    shown = [_short(text.text) for text in texts if text.text][:FIRST]
    quoted = f" ({', '.join(shown)}{', …' if len(texts) > len(shown) else ''})" if shown else ""
    flag = Question(question, "", ()).flag(Choice("mark", ""))
    which = f"1 {what}" if one else f"{len(texts)} {what}s"
    done = "engraves" if what == "text" else "marks"
    return Note(
        "warning", f"left out, as {where} not for marks: {which}{quoted}; {flag} {done} {'it' if one else 'them'}"
    )


def _short(text: str) -> str:
    line = " ".join(text.split())
    return f"'{line}'" if len(line) <= 24 else f"'{line[:23]}…'"


# Which part a mark belongs to.


def with_marks(
    parts: Sequence[Part], marks: Sequence[DrawnCurve], texts: Sequence[DrawnText] = ()
) -> tuple[tuple[Part, ...], list[Note], tuple[Writing, ...]]:
    """The parts with these marks, those of writing last; notes on marks that are on no part, and what is written where.

    A mark belongs to the part that has most of it. Of a text that lies on no part, or only partly on one, what is off
    is left out.
    """
    strokes = [stroke for text in texts for stroke in text.strokes]
    if not marks and not strokes:
        return tuple(parts), [], ()
    owner = _owners(parts, [*marks, *strokes])
    new_marks: list[list[Contour]] = [[] for _ in parts]

    def add(n: int, mark: DrawnCurve, text: str = "") -> str:
        part, own = parts[owner[n]].id, new_marks[owner[n]]
        source = replace(mark.source, text=" ".join(text.split()))
        own.append(Contour(f"{part}.mark{len(own) + 1}", part, "mark", mark.curve, source=source))
        return own[-1].id

    for n, mark in enumerate(marks):
        if n in owner:
            add(n, mark)
    notes = [
        Note("warning", f"the mark {m.place} is on no part: left out") for n, m in enumerate(marks) if n not in owner
    ]
    writings, off, partly = list[Writing](), list[DrawnText](), list[str]()
    n = len(marks)
    for text in texts:
        names = [add(n + k, stroke, text.text) for k, stroke in enumerate(text.strokes) if n + k in owner]
        n += len(text.strokes)
        if not names:
            off.append(text)
            continue
        if len(names) < len(text.strokes):
            partly.append(f"the {text.place}: {len(text.strokes) - len(names)} of {len(text.strokes)} strokes")
        writings.append(Writing(text.text, text.look.layer, text.look.curve.start, text.height_mm, tuple(names)))
    notes += _on_no_part(off)
    if partly:
        listed = "; ".join(partly[:FIRST]) + ("; …" if len(partly) > FIRST else "")
        notes.append(Note("warning", f"left out, as it lies in waste: {listed}"))
    found = tuple(replace(p, marks=tuple(own)) for p, own in zip(parts, new_marks, strict=True))
    return found, notes, tuple(writings)


def _owners(parts: Sequence[Part], marks: Sequence[DrawnCurve]) -> dict[int, int]:
    """Mark → the part that has most of it; nothing for one that is on no part."""
    metal = metal_of(parts)
    lines = np.array([m.curve.line() for m in marks], dtype=object)
    k, on = shapely.STRtree(metal).query(lines, predicate="intersects")
    shared = shapely.length(shapely.intersection(lines[k], metal[on]))
    most = np.lexsort((on, -shared, k))
    return {int(mark): int(part) for mark, part in zip(k[most][::-1], on[most][::-1], strict=True)}


def _on_no_part(texts: Iterable[DrawnText]) -> list[Note]:
    """A note for each layer with texts or points on no part."""
    by_layer: dict[str, list[DrawnText]] = defaultdict(list)
    for text in texts:
        by_layer[question_of(text)].append(text)
    notes = []
    for those in by_layer.values():
        if len(those) == 1:
            notes.append(Note("warning", f"left out, as it is on no part: the {those[0].place}"))
        else:
            what = f"{len(those)} {'texts' if those[0].text else 'points'} on layer '{those[0].look.layer}'"
            notes.append(Note("warning", f"left out, as they are on no part: {what}, the first the {those[0].place}"))
    return notes
