"""One door for every nest file."""

from __future__ import annotations

import gzip
import hashlib
import io
import os
import re
import unicodedata
import zlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely

from kerfwise.encoder.bridges import with_bridges
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import MOST_BYTES, is_file, read_limited
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.progress_notice import notice_if_long
from kerfwise.encoder.questions import LAYER, OF_DRAWING, Asking, Question, Questions, first_choices, with_gives
from kerfwise.encoder.validate import validated

from .drawing import OpenLines
from .fit_arcs import with_arcs
from .options import ReadOptions
from .reading import Reading
from .repairs import repaired

if TYPE_CHECKING:
    from .drawing import Drawing, DrawnCurve

MOST_PIECES = 60_000
"""Lines of a drawing times choices of its questions up to which it is said what each choice would give."""

SUFFIXES = (".dxf", ".json", ".svg", ".svgz")


class BrokenNest(InputError):
    """A nest that can be read, but not cut as it is drawn: with the nest, so that it can be shown.

    `wrong` are the ids of the contours that the problems name, and of lines that do not close; such are scrap lines of
    the nest here.
    """

    def __init__(self, nest: Nest, error: InputError, file: Path) -> None:
        super().__init__(error.message, file=file, line=error.line, column=error.column, details=error.details)
        words = {word for text in (error.message, *error.details) for word in re.split(r"[\s,:]+", text)}
        self.nest = nest
        is_open = isinstance(error, OpenLines)
        self.wrong = tuple(c.id for c in nest.contours if c.id in words or (is_open and c.kind == "scrap"))


def read_nest(path: str | Path, options: ReadOptions = ReadOptions()) -> Nest:  # noqa: B008 - frozen
    """Read and check a nest: a sheet with the parts placed on it.

    Parameters
    ----------
    path
        A `.json` (kerfwise-nest/1), `.dxf`, `.svg` or `.svgz` file; the suffix decides.
    options
        Units, layers, tolerances, and whether to repair.

    Returns
    -------
    A nest in mm, y up, every contour of it sound; its notes say what was doubtful and what was mended.

    Raises
    ------
    Questions
        When the file does not decide how it is to be read: with all questions, and the choices of each.
    InputError
        When the file cannot be read, or what it holds cannot be cut; the one error lists all that is wrong.

    Examples
    --------
    >>> import tempfile
    >>> text = '{"format": "kerfwise-nest/1", "sheet": {"width": 100, "height": 50}, "parts": ['
    >>> text += '{"id": "A", "outer": [[5, 5], [45, 5], [45, 45], [5, 45]]}]}'
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "small.json")
    ...     _ = file.write_text(text)
    ...     nest = read_nest(file)
    >>> nest.file, [c.id for c in nest.contours], nest.contour("A.outer").polygon.area
    ('small.json', ['A.outer'], 1600.0)
    """
    file = Path(path)
    if os.path.isdir(file):  # unlike the method of a path it answers for any name
        raise InputError("this is a folder; expected a nest file", file=file)
    suffix = known_suffix(file)
    with notice_if_long(f"reading {file.name}"):
        return _read(file, suffix, options)


def _read(file: Path, suffix: str, options: ReadOptions) -> Nest:
    data = file_bytes(file)
    door, asking = _Door(file, suffix, data), Asking(dict(options.answers))
    try:
        checked, failed = door.nest(options, asking), None
    except InputError as error:
        checked, failed = None, error
    if asking.raised:
        questions, viable = _with_gives(door, options, asking)
        if viable or failed is None:
            raise Questions(questions, file=file, reading=None if checked is None else checked.reading)
        try:  # nothing that could be answered helps: what a choice would mend is wrong, too
            door.nest(options, Asking(dict(options.answers), mends=False))
        except InputError as error:
            failed = error
    if failed is not None:
        raise failed
    assert checked is not None
    sha256 = hashlib.sha256(data).hexdigest()
    return replace(checked, file=escape_text(file.name), sha256=sha256, refit_arcs_mm=options.refit_arcs_mm)


@dataclass(frozen=True, eq=False, slots=True)
class Seen:
    """A file as far as it is understood: the nest with the likeliest answers, its reading, and its lines.

    `lines` are the lines of a drawing, each with what it is taken for: cut, mark, ignore, … or unknown. `error` is why
    it cannot be cut, or the questions that it raises; None where it can.
    """

    nest: Nest | None
    reading: Reading | None
    lines: tuple[tuple[str, Curve], ...]
    error: InputError | None


def seen(path: str | Path, options: ReadOptions) -> Seen:
    """How a file is understood, whether it can be cut or not.

    Raises InputError if the file cannot be read at all, such as one that is damaged.
    """
    file = Path(path)
    try:
        nest, error = read_nest(file, options), None
    except Questions as questions:
        likeliest = {**dict(options.answers), **first_choices(questions.questions)}
        found = seen(file, replace(options, answers=tuple(likeliest.items())))
        lines = _asked_about(found.lines, _rows(file, replace(options, answers=tuple(likeliest.items()))), questions)
        return Seen(found.nest, questions.reading or found.reading, lines, questions)
    except InputError as refused:
        nest, error = None, refused
    return Seen(nest, None if nest is None else nest.reading, _as_made(_rows(file, options), nest), error)


def _rows(file: Path, options: ReadOptions) -> tuple[tuple[str, DrawnCurve], ...]:
    """The lines of a drawing with what their layers are taken for; none where that cannot be told."""
    if file.suffix.lower() == ".json":
        return ()
    from .nest_from_drawing import taken_apart

    door, asking = _Door(file, file.suffix.lower(), file_bytes(file)), Asking(dict(options.answers))
    try:
        return taken_apart(door.drawing(options, asking), options, asking)
    except InputError:
        return ()


def _as_made(rows: Sequence[tuple[str, DrawnCurve]], nest: Nest | None) -> tuple[tuple[str, Curve], ...]:
    """The lines of a drawing, those to be cut as the nest has them: open ones may be marked, others are left out."""
    if nest is None:
        return tuple(("unknown" if purpose == "cut" else purpose, piece.curve) for purpose, piece in rows)
    curves = [(_KINDS.get(contour.kind, "cut"), contour.curve) for contour in (nest.drawn or nest).contours]
    tree = shapely.STRtree([curve.line() for _, curve in curves])
    found: list[tuple[str, Curve]] = []
    for purpose, piece in rows:
        if not piece.curve.segments:
            continue
        points = shapely.points([piece.curve.point_at(share * piece.curve.length_mm) for share in _SHARES])
        near, of = tree.query(points, predicate="dwithin", distance=_OFF_MM)
        # what is closed is one contour, or none: a frame may run along many others
        count = int(np.bincount(of, minlength=1).max()) if piece.curve.closed else len(np.unique(near))
        if purpose in ("cut", "mark") and count < len(points):
            on_sheet = purpose == "cut" and shapely.distance(nest.sheet.outline.line(), points).max() <= _OFF_MM
            found.append(("sheet" if on_sheet else "ignore", piece.curve))
        elif purpose not in ("cut", "mark"):
            found.append((purpose, piece.curve))
    return (*found, *curves)


_KINDS = {"mark": "mark", "scrap": "scrap"}
_SHARES = (0.02, 0.1, 0.35, 0.5, 0.8, 0.98)
"""Where along a line it is asked whether it is a piece of a contour."""
_OFF_MM = 0.2
"""How far a line may lie off the contour that it has become a piece of."""


def _asked_about(
    lines: Sequence[tuple[str, Curve]], rows: Sequence[tuple[str, DrawnCurve]], questions: Questions
) -> tuple[tuple[str, Curve], ...]:
    """All lines, and those that a question is about once more, as unknown: a frame is the largest one."""
    ids = {question.id for question in questions.questions}
    about = [
        piece.curve
        for _, piece in rows
        if ids & {f"{LAYER}{piece.layer}", f"colour:{piece.colour}", f"linetype:{piece.linetype}"}
    ]
    if "frame" in ids and rows:
        about.append(max((piece.curve for _, piece in rows), key=lambda c: shapely.box(*c.line().bounds).area))
    return (*lines, *(("unknown", curve) for curve in about))


class _Door:
    """One file, read as often as there are answers to try; a drawing is taken apart once for each unit."""

    def __init__(self, file: Path, suffix: str, data: bytes) -> None:
        self.file, self.suffix, self.data = file, suffix, unpacked(data, file)
        self.pieces = 0
        self._drawings: dict[tuple[object, ...], Drawing] = {}

    def nest(self, options: ReadOptions, asking: Asking) -> Nest:
        """The nest, checked."""
        file = self.file
        try:
            nest = self._nest(options, asking)
            drawn = repaired(nest, options, asking)
            drawn = with_arcs(drawn, options.refit_arcs_mm) if options.refit_arcs_mm else drawn
            drawn = _as_told(drawn, nest, asking)
        except OpenLines as error:
            raise BrokenNest(replace(error.nest(), file=escape_text(file.name)), error, file) from error.__cause__
        except InputError as error:
            raise InputError(
                error.message, file=file, line=error.line, column=error.column, details=error.details
            ) from error.__cause__
        try:
            checked = validated(drawn)
            if checked.bridges:
                joined = with_bridges(checked)
                checked = replace(validated(joined), notes=joined.notes)
            return checked
        except InputError as error:
            raise BrokenNest(replace(drawn, file=escape_text(file.name)), error, file) from error.__cause__

    def _nest(self, options: ReadOptions, asking: Asking) -> Nest:
        """Each format's libraries are imported only when such a file is read."""
        if self.suffix == ".json":
            from .json_nest import read_json

            return read_json(self.data, options)
        from .by_layer import with_bevels_by_look
        from .nest_from_drawing import nest_of, with_quantities

        drawing = self.drawing(options, asking)
        nest = with_bevels_by_look(nest_of(drawing, options, asking), drawing.pieces, options.bevels)
        return with_quantities(nest, unicodedata.normalize("NFC", self.file.stem), options.quantity)

    def drawing(self, options: ReadOptions, asking: Asking) -> Drawing:
        """The drawing, not yet taken for anything."""
        own = Asking(asking.given)
        key = (options.units, *(asking.given.get(question) for question in OF_DRAWING))
        if key not in self._drawings or not options.answers:
            self._drawings[key] = self._drawing(options, own)
            self.pieces = len(self._drawings[key].pieces)
            asking.raised |= own.raised
            asking.used |= own.used
        return self._drawings[key]

    def _drawing(self, options: ReadOptions, asking: Asking) -> Drawing:
        if self.suffix == ".dxf":
            from .dxf import read_dxf

            return read_dxf(self.file, self.data, options, asking)
        from .svg import read_svg

        return read_svg(self.data, options, asking)


def _as_told(drawn: Nest, read: Nest, asking: Asking) -> Nest:
    """The nest, its reading with what was repaired since it was read, and with all answers that were used."""
    if drawn.reading is None:
        return drawn
    mended = [note.text for note in drawn.notes[len(read.notes) :] if note.severity == "repaired"]
    reading = replace(drawn.reading, repaired=(*drawn.reading.repaired, *mended), answers=dict(asking.used))
    return replace(drawn, reading=reading)


def _with_gives(door: _Door, options: ReadOptions, asking: Asking) -> tuple[list[Question], bool]:
    """The questions with what each choice would give, the other questions answered by their likeliest choices.

    Choices that cannot be cut come last. Whether any choice can be is the second thing. A large drawing is not read
    once more for each choice.
    """
    questions = list(asking.raised.values())
    choices = sum(len(question.choices) for question in questions)
    if door.pieces * choices > MOST_PIECES:
        return questions, True
    likeliest = first_choices(questions)
    told, viable = [], False
    for question in questions:
        gives: dict[str, str] = {}
        refused = []
        for choice in question.choices:
            answers = {**dict(options.answers), **likeliest, question.id: choice.value}
            trial = Asking(answers)
            try:
                nest = door.nest(replace(options, answers=tuple(answers.items())), trial)
                for later in trial.raised.values():  # asked once these are answered
                    answers.setdefault(later.id, later.choices[0].value)
                gives[choice.value] = _given(nest)
            except InputError as error:
                gives[choice.value] = f"it could not be cut: {error.message}"
                refused.append(choice.value)
        viable = viable or len(refused) < len(question.choices)
        told.append(with_gives(question, gives, refused))
    return told, viable


def _given(nest: Nest) -> str:
    """What a reading gives, in a few words: contours, parts and sizes."""
    kinds = Counter[str](contour.kind for contour in nest.contours)
    words = [("outer", "part"), ("hole", "hole"), ("mark", "mark"), ("scrap", "scrap line")]
    counts = ", ".join(f"{n} {word}{'s' if n != 1 else ''}" for kind, word in words if (n := kinds[kind]))
    boxes = np.array([part.polygon.bounds for part in nest.parts])
    sizes = boxes[:, 2:] - boxes[:, :2]
    width, height = sizes[sizes.prod(axis=1).argmax()].tolist()
    largest = f"{width:.6g} × {height:.6g} mm{' the largest' if len(nest.parts) > 1 else ''}"
    reading = nest.reading
    sheet = "" if reading is None else f", sheet {reading.sheet}{' assumed' if reading.assumed else ''}"
    return f"{counts} ({largest}){sheet}"


def known_suffix(file: Path) -> str:
    """The ending of a drawing's name; InputError for another one, naming what lies beside it and is called so."""
    suffix = file.suffix.lower()
    if suffix in SUFFIXES:
        return suffix
    there = [file.stem + end for end in SUFFIXES if file.name and is_file(file.with_suffix(end))]
    meant = "" if is_file(file) or not there else f"; did you mean {' or '.join(map(repr, there))}?"
    raise InputError(f"cannot tell the format of '{file.name}': expected {', '.join(SUFFIXES)}{meant}", file=file)


def file_bytes(file: Path) -> bytes:
    """All bytes of a nest file; InputError if it cannot be opened or is empty."""
    try:
        data = read_limited(file)
    except FileNotFoundError:
        raise InputError("there is no such file", file=file) from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise InputError(f"the file cannot be opened: {error}", file=file) from None
    if not data.strip():
        raise InputError("the file is empty", file=file)
    return data


_GZIP = b"\x1f\x8b"


def unpacked(data: bytes, file: Path) -> bytes:
    """What a file holds; one that was packed by gzip, as .svgz is, is unpacked.

    Raises InputError if what is packed is damaged, or too large.
    """
    if not data.startswith(_GZIP):
        return data
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as packed:
            plain = packed.read(MOST_BYTES + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(f"the file is packed, and damaged: {error}", file=file) from None
    if len(plain) > MOST_BYTES:
        raise InputError(f"holds over {MOST_BYTES // 1_000_000} MB once it is unpacked: too large", file=file)
    return plain
