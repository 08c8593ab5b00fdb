"""The burns of a program in another order: each one's lines as they stand, only the travel between them is new."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.postproc.check.reader.old import OldProgram, Traced
from kerfwise.postproc.check.reader.old_words import State
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.postproc.nc.blocks import number

SAME_MM = 0.0005
"""How far a point of a burn may lie, in the new program, from where it was."""
_OURS = "KERFWISE FOR"
_RESUMED = "RESUME AFTER"
_NUMBER = re.compile(r"^\s*N\s*(?P<number>[0-9]+)(?:\.[0-9]*)?\s*", re.IGNORECASE)
_COMMENT_LINE = re.compile(r"^\s*(?:;.*|\([^)]*\)\s*)$")
_SET_BY_ITSELF = frozenset({"F", "power"})
"""What a burn sets before it needs it: that it is the same as before is seen when the program is read back."""
_FROM_THE_START: Mapping[str, tuple[str, ...]] = {"speed": ("M68 E3 Q0",)}
"""What holds where nothing was said yet."""


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """The lines of one burn, from behind the travel to it to where the torch goes off, and what is in force at both.

    `start` and `end` are in the program's own coordinates, mm.
    """

    line: int
    comments: tuple[str, ...]
    body: tuple[str, ...]
    before: State
    after: State
    start: Point
    end: Point


@dataclass(frozen=True, eq=False, slots=True)
class TakenApart:
    """A program as what comes before its first travel, the pieces, and what comes after the last burn.

    `rapid` is the word of its travel, `ours` says that kerfwise wrote it.
    """

    head: tuple[str, ...]
    head_state: State
    pieces: tuple[Piece, ...]
    tail: tuple[str, ...]
    rapid: str
    ours: bool
    numbered: tuple[int, int] | None = None
    burns: tuple[Burn, ...] = field(repr=False, default=())
    file: str = ""


def taken_apart(old: OldProgram, file: str = "") -> TakenApart:
    """Take a program apart into its burns.

    Raises
    ------
    InputError
        With the line, for what belongs to the order of the burns and not to one of them; for a program of no burns.
    """
    rows, burns, texts = old.lines, old.program.burns, [text.removesuffix("\r") for text in old.text.split("\n")]
    if not burns:
        raise InputError("the program cuts nothing: the torch is never on", file=file or None)
    if not rows:
        raise _refused(
            "every line of this control counts from the one before it: its burns are not put into another order here; "
            "plan its contours afresh (--paths new)",
            1,
            file,
        )
    if any(comment.upper().startswith(_RESUMED) for comment in old.program.comments):
        raise InputError(
            "the program goes on after a stop: what was cut before stands in no burn of it; give the first program",
            file=file or None,
            line=1,
        )
    ends = [next(k for k, row in enumerate(rows) if row.burns > n) for n in range(len(burns))]
    first = next(k for k, row in enumerate(rows) if row.travels or row.line >= burns[0].line)
    ours = any(comment.upper().startswith(_OURS) for comment in old.program.comments)
    pieces = []
    for n, (burn, last) in enumerate(zip(burns, ends, strict=True)):
        begin = first if n == 0 else ends[n - 1] + 1
        if n and ends[n - 1] == last:
            raise _refused("one line ends a burn and begins the next", burn.line, file)
        pieces.append(_piece(burn, rows, range(begin, last + 1), texts, ours, file))
    head = tuple(texts[: rows[first].line - 1])
    tail = tuple(texts[rows[ends[-1]].line :])
    rapid = next((row.rapid for row in rows if row.rapid), "")
    state = rows[first - 1].state if first else State()
    return TakenApart(head, state, tuple(pieces), tail, rapid, ours, _numbering(texts), burns, file)


def _piece(burn: Burn, rows: Sequence[Traced], own: range, texts: Sequence[str], ours: bool, file: str) -> Piece:
    travels = [k for k in own if rows[k].travels and rows[k].line < burn.line]
    begin = travels[-1] + 1 if travels else own.start
    for k in own:
        if rows[k].halts:
            raise _refused(
                "the program halts here for the operator (M0, M1): what is cut before it is not ours to change; "
                "take it out",
                rows[k].line,
                file,
            )
        if rows[k].state.get("distance") == ("G91",):
            raise _refused(
                "positions that count from the last one (G91): not supported here; post the program with G90",
                rows[k].line,
                file,
            )
        if k < begin and rows[k].waits:
            raise _refused(
                "a wait with the torch off before a travel: nobody can be sure which burn it belongs to; put it "
                "behind the travel",
                rows[k].line,
                file,
            )
    before = rows[begin - 1].state if begin else State()
    since = rows[own.start].line - 1
    body_from = rows[begin - 1].line if begin > own.start else since
    comments = () if ours else tuple(text for text in texts[since:body_from] if _is_comment(text))
    body = tuple(text for text in texts[body_from : rows[own.stop - 1].line] if not (ours and _is_comment(text)))
    (x0, y0), (x1, y1) = burn.path.vertices[0, :2].tolist(), burn.path.vertices[-1, :2].tolist()
    after = rows[own.stop - 1].state
    return Piece(burn.line, comments, tuple(filter(str.strip, body)), before, after, (x0, y0), (x1, y1))


def _refused(message: str, line: int, file: str) -> InputError:
    return InputError(message, file=file or None, line=line)


def _is_comment(text: str) -> bool:
    return bool(_COMMENT_LINE.match(text))


def _numbering(texts: Sequence[str]) -> tuple[int, int] | None:
    """The first line number and the step to the second, where lines are numbered."""
    found = [int(number["number"]) for text in texts if (number := _NUMBER.match(text))]
    return (found[0], max(found[1] - found[0], 1)) if len(found) > 1 else None


def reordered(
    apart: TakenApart, order: Sequence[int], told: Sequence[str] = (), headings: Sequence[Sequence[str]] = ()
) -> str:
    """The program with its pieces in another order.

    Parameters
    ----------
    apart
        The program.
    order
        The numbers of its pieces, from 0, in the new order.
    told
        Lines, comments of the control, for the program's top.
    headings
        Lines, comments of the control, before each piece, in the new order.

    Raises
    ------
    InputError
        With the line, where what holds for a burn cannot be put in force again.
    """
    lines = [text for text in apart.head if text.strip() and not (apart.ours and _is_comment(text))]
    at_top = 1 if lines and lines[0].strip() == "%" else 0
    lines[at_top:at_top] = told
    state = dict(apart.head_state)
    for place, k in enumerate(order):
        piece = apart.pieces[k]
        lines += headings[place] if headings else ()
        lines += piece.comments
        lines += _restored(state, piece, apart.file)
        lines.append(_travel(piece.start, piece.before, apart.rapid))
        lines += piece.body
        state = dict(piece.after)
    last = apart.pieces[-1]
    if order[-1] != len(apart.pieces) - 1:
        lines += _words(state, last.after)
    lines += [text for text in apart.tail if text.strip() and not (apart.ours and _is_comment(text))]
    return "\n".join([*_renumbered(lines, apart.numbered), ""])


def _restored(state: State, piece: Piece, file: str) -> list[str]:
    """The words that put in force what held for a piece."""
    wanted = dict(piece.before)
    for key in state.keys() - wanted.keys() - _SET_BY_ITSELF:
        if key not in _FROM_THE_START:
            raise _refused(
                f"what holds for the burn that begins here was never said, and {' '.join(state[key])} comes later in "
                "the program: nobody can be sure of it; say it at the program's top",
                piece.line,
                file,
            )
        wanted[key] = _FROM_THE_START[key]
    return _words(state, wanted)


def _words(state: State, wanted: State) -> list[str]:
    """The words that make one state of another; a feed that a material has is asked for again behind its material."""
    missing = [key for key, words in wanted.items() if state.get(key) != words]
    feed = wanted.get("F", ("",))[0]
    if "material" in missing and feed.startswith("F#"):
        missing = [*(key for key in missing if key != "F"), "F"]
    return [word for key in missing for word in wanted[key]]


def _travel(to: Point, state: State, rapid: str) -> str:
    inch = state.get("units") in (("G20",), ("G70",))
    x, y = (number(v / 25.4 if inch else v, 6) for v in to)
    return f"{rapid} X{x} Y{y}".strip()


def _renumbered(lines: Sequence[str], numbering: tuple[int, int] | None) -> list[str]:
    """The lines with their numbers in order again, where they have any; comments and % have none."""
    if numbering is None:
        return list(lines)
    start, step = numbering
    made, count = [], 0
    for text in lines:
        bare = _NUMBER.sub("", text, count=1)
        if _is_comment(bare) or bare.strip() == "%":
            made.append(bare)
            continue
        made.append(f"N{start + step * count} {bare}")
        count += 1
    return made


def expect_same(apart: TakenApart, order: Sequence[int], written: OldProgram) -> None:
    """Refuse a program whose burns, read back, are not the old ones in their new order.

    Raises
    ------
    InputError
        With the line of the old program.
    """
    burns = written.program.burns
    again = taken_apart(written) if len(burns) == len(order) else None
    for place, k in enumerate(order):
        old, piece = apart.burns[k], apart.pieces[k]
        if again is None or not (_alike(old, burns[place]) and _holds(piece, again.pieces[place])):
            raise _refused(
                "the burn that begins here would not be the same in another order, for it leans on words that come "
                "before it; nothing is written; post the program so that each burn says what it needs",
                piece.line,
                apart.file,
            )


def _alike(old: Burn, new: Burn) -> bool:
    if old.tool != new.tool or old.path.vertices.shape != new.path.vertices.shape:
        return False
    off_mm = np.abs(old.path.vertices[:, :2] - new.path.vertices[:, :2]).max()
    bent = np.abs(old.path.vertices[:-1, 2] - new.path.vertices[:-1, 2]).max(initial=0.0)
    was, now = ((b.pierce_s, b.paused_s, b.wait_s, b.moving_s) for b in (old, new))
    return bool(off_mm <= SAME_MM and bent <= 1e-4 and np.allclose(was, now, rtol=1e-4, atol=1e-4))


def _holds(old: Piece, new: Piece) -> bool:
    """Whether what was in force for a burn still is."""
    return all(new.before.get(key) == words for key, words in old.before.items() if key not in _SET_BY_ITSELF)
