"""A program taken apart into its burns, which of them must stay before which, and the same burns in another order."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.postproc.check.reader.program import Burn, LineEffect, State
from kerfwise.postproc.check.reader.read_program import OldProgram
from kerfwise.postproc.nc.gcode import number

# A program taken apart into its burns: the lines of each, as they stand, and what is in force for it.

NUMBER = re.compile(r"^\s*N\s*(?P<number>[0-9]+)(?:\.[0-9]*)?\s*", re.IGNORECASE)
"""The number of a line."""
_OURS = "KERFWISE FOR"
_RESUMED = "RESUME AFTER"
_COMMENT_LINE = re.compile(r"^\s*(?:;.*|\([^)]*\)\s*)$")


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """The lines of one burn, from behind the travel to it to where the torch goes off, and what is in force at both.

    `sets` are the things that its own lines set before the torch moves. `start` and `end` are in the program's own
    coordinates, mm.
    """

    line: int
    comments: tuple[str, ...]
    body: tuple[str, ...]
    before: State
    after: State
    sets: frozenset[str]
    start: Point
    end: Point


@dataclass(frozen=True, eq=False, slots=True)
class SplitProgram:
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
    newline: str = "\n"


def split_program(old: OldProgram, file: str = "") -> SplitProgram:
    """Take a program apart into its burns.

    Raises InputError with the line, for what belongs to the order of the burns and not to one of them; for a program of
    no burns.
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
    ends = [_with_rest(rows, end, burns[n + 1].line if n + 1 < len(burns) else None) for n, end in enumerate(ends)]
    ours = any(comment.upper().startswith(_OURS) for comment in old.program.comments)
    pieces = []
    for n, (burn, last) in enumerate(zip(burns, ends, strict=True)):
        begin = first if n == 0 else ends[n - 1] + 1
        if n and ends[n - 1] == last:
            raise _refused("one line ends a burn and begins the next", burn.line, file)
        since = rows[ends[n - 1]].line if n else rows[first].line - 1
        pieces.append(_piece(burn, rows, range(begin, last + 1), since, texts, ours, file))
    head = tuple(texts[: rows[first].line - 1])
    tail = tuple(_said_motion(texts, rows[ends[-1] + 1 :])[rows[ends[-1]].line :])
    words = [row.rapid for row in rows if row.rapid]
    rapid = next((word for word in words if not word.endswith("1")), words[0] if words else "")
    state = rows[first - 1].state if first else State()
    step_mm, end = old.program.step_mm, rows[ends[-1]].line
    numbering = None if step_mm else _numbering(texts)
    return SplitProgram(
        head, state, tuple(pieces), tail, rapid, ours, numbering, burns, file, step_mm, old.begin, _homing(old, end),
        old.newline,
    )  # fmt: skip


def _with_rest(rows: Sequence[LineEffect], end: int, next_line: int | None) -> int:
    """The last row that belongs to a burn: waits, heights and the like before the next travel are behind its off."""
    last = end
    for k in range(end + 1, len(rows)):
        row = rows[k]
        if row.travels or row.halts or (next_line is not None and row.line >= next_line):
            break
        last = k if row.waits or row.carries else last
    return last


def _piece(
    burn: Burn, rows: Sequence[LineEffect], own: range, since: int, texts: Sequence[str], ours: bool, file: str
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
        if k < begin and (rows[k].waits or rows[k].carries) and not rows[k].travels and own.start > 0:
            raise _refused(
                "a wait, a height or the like between two travels: nobody can be sure which burn it belongs to; put it "
                "behind the travel",
                rows[k].line,
                file,
            )
    before = rows[begin - 1].state if begin else State()
    body_from = rows[begin - 1].line if begin > own.start else since
    comments = () if ours else tuple(_for_people(texts[since:body_from]))
    body_texts = _said_motion(texts, [rows[k] for k in own if k >= begin])
    body = tuple(text for text in body_texts[body_from : rows[own.stop - 1].line] if not (ours and is_comment(text)))
    (x0, y0), (x1, y1) = burn.path.start, burn.path.end
    after = rows[own.stop - 1].state
    moving = next((k for k in own if rows[k].line > burn.line and (rows[k].moves or rows[k].implied)), own.start + 1)
    sets = frozenset(key for key, words in rows[moving - 1].state.items() if before.get(key) != words)
    return Piece(burn.line, comments, tuple(filter(str.strip, body)), before, after, sets, (x0, y0), (x1, y1))


def _said_motion(texts: Sequence[str], own: Sequence[LineEffect]) -> Sequence[str]:
    """The lines of a program; the first move of a piece that leans on a motion word before it says that itself."""
    first = next((row for row in own if row.implied or row.moves), None)
    if first is None or not first.implied:
        return texts
    lines = list(texts)
    number, text = NUMBER.match(lines[first.line - 1]), lines[first.line - 1]
    at = number.end() if number else len(text) - len(text.lstrip())
    lines[first.line - 1] = f"{text[:at]}{first.implied} {text[at:]}"
    return lines


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


# Which burns of a program must stay before which, told from the burns alone, where they make no nest.

_KEPT_IN_ROWS = ("material", "tool")
"""What costs time to change, and nobody knows how much: burns keep the order of these."""


def orders_between(burns: Sequence[Burn], pieces: Sequence[Piece], kerf_mm: float) -> Ints:
    """Pairs (before, after) of burns that no new order may turn round, (k, 2), sorted.

    What lies in an area that another burn goes round comes before it. Burns whose kerfs meet stay as they are, since
    the second may need the metal, or the void, that the first has left. So do burns of another material or tool.

    Examples
    --------
    >>> from kerfwise.encoder.geometry.curve import Curve
    >>> def burn(*points):
    ...     return Burn(0, 1, Curve.of(points, closed=False), 0.0, 0.0, "")
    >>> frame = burn((0, 0), (90, 0), (90, 90), (0, 90), (0, 0))
    >>> orders_between([frame, burn((40, 40), (50, 40)), burn((200, 0), (210, 0))], [], 1.5).tolist()
    [[1, 0]]
    """
    lines = [burn.path.line() for burn in burns]
    areas = [shapely.union_all(shapely.get_parts(shapely.polygonize([shapely.node(line)]))) for line in lines]
    pairs: set[tuple[int, int]] = set()
    tree = shapely.STRtree(lines)
    for k, area in enumerate(areas):
        if not area.is_empty:
            inside = {
                j for j in tree.query(area, predicate="intersects").tolist() if j != k and _within(lines[j], area)
            }
            pairs |= {(j, k) for j in inside if not _within(lines[k], areas[j])}
    first, second = tree.query(lines, predicate="dwithin", distance=kerf_mm)
    for a, b in zip(first.tolist(), second.tolist(), strict=True):
        if a < b and (b, a) not in pairs:
            pairs.add((a, b))
    pairs |= tool_orders(pieces)
    return np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2)


def _within(line: shapely.LineString, area: shapely.Geometry) -> bool:
    """Whether most of a burn lies in an area."""
    if area.is_empty:
        return False
    if line.length == 0:
        return bool(area.intersects(line))
    return bool(shapely.intersection(line, area).length > line.length / 2)


def tool_orders(pieces: Sequence[Piece]) -> set[tuple[int, int]]:
    """Pairs (before, after): all burns of one material and tool before all of the next."""
    rows: list[list[int]] = []
    last = None
    for k, piece in enumerate(pieces):
        now = tuple(piece.before.get(key) for key in _KEPT_IN_ROWS)
        if rows and now == last:
            rows[-1].append(k)
        else:
            rows.append([k])
        last = now
    return {(a, b) for one, then in pairwise(rows) for a in one for b in then}


# The burns of a program in another order: each one's lines as they stand, only the travel between them is new.

SAME_MM = 0.0005
"""How far a point of a burn may lie, in the new program, from where it was."""
_SET_BY_ITSELF = frozenset({"F", "power"})
"""What a burn sets before it needs it: that it is the same as before is seen when the program is read back."""
_STEPWISE = ("G91",)
_FROM_THE_START: Mapping[str, tuple[str, ...]] = {"speed": ("M68 E3 Q0",), "kerf": ("G40",)}
"""What holds where nothing was said yet."""


def reordered(
    apart: SplitProgram, order: Sequence[int], texts: Sequence[str] = (), headings: Sequence[Sequence[str]] = ()
) -> str:
    """The program with its pieces in another order.

    `order`: the numbers of its pieces, from 0, in the new order. `texts`: lines, comments of the control, for the
    program's top. `headings`: lines, comments of the control, before each piece, in the new order. Raises InputError
    with the line, where what holds for a burn cannot be put in force again.
    """
    lines = [text for text in apart.head if text.strip() and not (apart.ours and is_comment(text))]
    at_top = 1 if lines and lines[0].strip() == "%" else 0
    lines[at_top:at_top] = texts
    state, at = dict(apart.head_state), apart.begin
    for place, k in enumerate(order):
        piece = apart.pieces[k]
        lines += headings[place] if headings else ()
        lines += piece.comments
        lines += _restored(state, piece, apart.file)
        lines += _travel(at, piece.start, piece.before, apart)
        lines += piece.body
        state, at = dict(piece.after), piece.end
    last = apart.pieces[-1]
    if order[-1] != len(apart.pieces) - 1:
        lines += _words(state, last.after)
    tail = list(apart.tail)
    counts = apart.step_mm or last.after.get("distance") == _STEPWISE
    if counts and apart.homing is not None and order[-1] != len(apart.pieces) - 1:
        number_of_line, home = apart.homing
        tail[number_of_line : number_of_line + 1] = _travel(at, home, last.after, apart)
    lines += [text for text in tail if text.strip() and not (apart.ours and is_comment(text))]
    return apart.newline.join([*_renumbered(lines, apart.numbered), ""])


def _restored(state: State, piece: Piece, file: str) -> list[str]:
    """The words that put in force what held for a piece."""
    wanted = dict(piece.before)
    for key in state.keys() - wanted.keys() - _SET_BY_ITSELF - piece.sets:
        if key not in _FROM_THE_START:
            raise InputError(
                f"what holds for the burn that begins here was never said, and {' '.join(state[key])} comes later in "
                "the program: nobody can be sure of it; say it at the program's top",
                file=file or None,
                line=piece.line,
            )
        wanted[key] = _FROM_THE_START[key]
    if wanted.get("distance") == _STEPWISE:  # the travel counts from zero, and says G91 behind it
        wanted.pop("distance")
    return _words(state, wanted)


def _words(state: State, wanted: State) -> list[str]:
    """The words that make one state of another; a feed that a material has is asked for again behind its material."""
    missing = [key for key, words in wanted.items() if state.get(key) != words]
    feed = wanted.get("F", ("",))[0]
    if "material" in missing and feed.startswith("F#"):
        missing = [*(key for key in missing if key != "F"), "F"]
    return [word for key in missing for word in wanted[key]]


def _travel(at: Point, to: Point, state: State, apart: SplitProgram) -> list[str]:
    if apart.step_mm:
        return [_step(at, to, apart.step_mm)]
    inch = state.get("units") in (("G20",), ("G70",))
    x, y = (number(v / 25.4 if inch else v, 6) for v in to)
    block = f"{apart.rapid} X{x} Y{y}".strip()
    return [f"G90 {block}", "G91"] if state.get("distance") == _STEPWISE else [block]


def _step(at: Point, to: Point, step_mm: float) -> str:
    """A move that counts from the last one, in whole steps with their signs."""
    return "".join(f"{round((b - a) / step_mm):+d}" for a, b in zip(at, to, strict=True))


def _renumbered(lines: Sequence[str], numbering: tuple[int, int] | None) -> list[str]:
    """The lines with their numbers in order again, where they have any; comments and % have none."""
    if numbering is None:
        return list(lines)
    start, step = numbering
    numbered, count = [], 0
    for text in lines:
        bare = NUMBER.sub("", text, count=1)
        if is_comment(bare) or bare.strip() == "%":
            numbered.append(bare)
            continue
        numbered.append(f"N{start + step * count} {bare}")
        count += 1
    return numbered


def expect_same(apart: SplitProgram, order: Sequence[int], written: OldProgram) -> None:
    """Refuse a program whose burns, read back, are not the old ones in their new order.

    Raises InputError with the line of the old program.
    """
    burns = written.program.burns
    again = split_program(written) if len(burns) == len(order) else None
    for place, k in enumerate(order):
        old, piece = apart.burns[k], apart.pieces[k]
        if again is None or not (_alike(old, burns[place]) and _holds(piece, again.pieces[place])):
            raise InputError(
                "the burn that begins here would not be the same in another order, for it leans on words that come "
                "before it; nothing is written; post the program so that each burn says what it needs",
                file=apart.file or None,
                line=piece.line,
            )


def _alike(old: Burn, new: Burn) -> bool:
    if old.tool != new.tool or len(old.unlit) != len(new.unlit) or old.path.vertices.shape != new.path.vertices.shape:
        return False
    off_mm = np.abs(old.path.vertices[:, :2] - new.path.vertices[:, :2]).max()
    bent = np.abs(old.path.vertices[:-1, 2] - new.path.vertices[:-1, 2]).max(initial=0.0)
    was, now = ((b.pierce_s, b.paused_s, b.moving_s, *np.ravel(b.unlit)) for b in (old, new))
    return bool(off_mm <= SAME_MM and bent <= 1e-4 and np.allclose(was, now, rtol=1e-4, atol=1e-4))


def _holds(old: Piece, new: Piece) -> bool:
    """Whether what was in force for a burn still is."""
    by_itself = _SET_BY_ITSELF | {"distance"}
    return all(new.before.get(key) == words for key, words in old.before.items() if key not in by_itself)
