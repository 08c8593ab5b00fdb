"""A program taken apart into its burns: the lines of each, as they stand, and what is in force for it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.postproc.check.reader.old import OldProgram
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.postproc.check.reader.traced import State, Traced

NUMBER = re.compile(r"^\s*N\s*(?P<number>[0-9]+)(?:\.[0-9]*)?\s*", re.IGNORECASE)
"""The number of a line."""
_OURS = "KERFWISE FOR"
_RESUMED = "RESUME AFTER"
_COMMENT_LINE = re.compile(r"^\s*(?:;.*|\([^)]*\)\s*)$")


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

    `rapid` is the word of its travel, `ours` says that kerfwise wrote it. Where all moves count from the last one, in
    steps of `step_mm` (else 0), `begin` is where the torch is at first, and `homing` the first travel of the tail: the
    number of its line, from 0, and where it leads.
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
    step_mm: float = 0.0
    begin: Point = (0.0, 0.0)
    homing: tuple[int, Point] | None = None


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
    if any(comment.upper().startswith(_RESUMED) for comment in old.program.comments):
        raise InputError(
            "the program goes on after a stop: what was cut before stands in no burn of it; give the first program",
            file=file or None,
            line=1,
        )
    counts = [row.burns for row in rows]  # a burn that goes on behind a tab was over, and is not
    ends = [next((k for k in range(len(rows), 0, -1) if counts[k - 1] <= n), 0) for n in range(len(burns))]
    first = next(k for k, row in enumerate(rows) if row.travels or row.line >= burns[0].line)
    ours = any(comment.upper().startswith(_OURS) for comment in old.program.comments)
    pieces = []
    for n, (burn, last) in enumerate(zip(burns, ends, strict=True)):
        begin = first if n == 0 else ends[n - 1] + 1
        if n and ends[n - 1] == last:
            raise _refused("one line ends a burn and begins the next", burn.line, file)
        since = rows[ends[n - 1]].line if n else rows[first].line - 1
        pieces.append(_piece(burn, rows, range(begin, last + 1), since, texts, ours, file))
    head = tuple(texts[: rows[first].line - 1])
    tail = tuple(texts[rows[ends[-1]].line :])
    rapid = next((row.rapid for row in rows if row.rapid), "")
    state = rows[first - 1].state if first else State()
    step_mm, end = old.program.step_mm, rows[ends[-1]].line
    numbering = None if step_mm else _numbering(texts)
    return TakenApart(
        head, state, tuple(pieces), tail, rapid, ours, numbering, burns, file, step_mm, old.begin, _homing(old, end)
    )


def _piece(
    burn: Burn, rows: Sequence[Traced], own: range, since: int, texts: Sequence[str], ours: bool, file: str
) -> Piece:
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
    body_from = rows[begin - 1].line if begin > own.start else since
    comments = () if ours else tuple(_for_people(texts[since:body_from]))
    body = tuple(text for text in texts[body_from : rows[own.stop - 1].line] if not (ours and is_comment(text)))
    (x0, y0), (x1, y1) = burn.path.vertices[0, :2].tolist(), burn.path.vertices[-1, :2].tolist()
    after = rows[own.stop - 1].state
    return Piece(burn.line, comments, tuple(filter(str.strip, body)), before, after, (x0, y0), (x1, y1))


def _homing(old: OldProgram, after: int) -> tuple[int, Point] | None:
    """The first travel behind a line: the number of its line from there on, from 0, and where it leads."""
    return next(((line - after - 1, at) for line, at in old.program.rapids if line > after), None)


def _refused(message: str, line: int, file: str) -> InputError:
    return InputError(message, file=file or None, line=line)


def is_comment(text: str) -> bool:
    """Whether a line is for people only."""
    return bool(_COMMENT_LINE.match(text))


def _for_people(texts: Sequence[str]) -> Iterator[str]:
    """The lines that are for people only, those between 3 and 4 of ESSI, too."""
    between = False
    for text in texts:
        begins, ends = not between and text.strip() == "3", between and text.strip() == "4"
        if between or begins or is_comment(text):
            yield text
        between = (between or begins) and not ends


def _numbering(texts: Sequence[str]) -> tuple[int, int] | None:
    """The first line number and the step to the second, where lines are numbered."""
    found = [int(number["number"]) for text in texts if (number := NUMBER.match(text))]
    return (found[0], max(found[1] - found[0], 1)) if len(found) > 1 else None
