"""The burns of a program in another order: each one's lines as they stand, only the travel between them is new."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.postproc.check.reader.old import OldProgram
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.postproc.check.reader.traced import State
from kerfwise.postproc.nc.blocks import number

from .pieces import NUMBER, Piece, TakenApart, is_comment, taken_apart

SAME_MM = 0.0005
"""How far a point of a burn may lie, in the new program, from where it was."""
_SET_BY_ITSELF = frozenset({"F", "power"})
"""What a burn sets before it needs it: that it is the same as before is seen when the program is read back."""
_FROM_THE_START: Mapping[str, tuple[str, ...]] = {"speed": ("M68 E3 Q0",)}
"""What holds where nothing was said yet."""


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
    lines = [text for text in apart.head if text.strip() and not (apart.ours and is_comment(text))]
    at_top = 1 if lines and lines[0].strip() == "%" else 0
    lines[at_top:at_top] = told
    state, at = dict(apart.head_state), apart.begin
    for place, k in enumerate(order):
        piece = apart.pieces[k]
        lines += headings[place] if headings else ()
        lines += piece.comments
        lines += _restored(state, piece, apart.file)
        lines.append(_travel(at, piece.start, piece.before, apart))
        lines += piece.body
        state, at = dict(piece.after), piece.end
    last = apart.pieces[-1]
    if order[-1] != len(apart.pieces) - 1:
        lines += _words(state, last.after)
    tail = list(apart.tail)
    if apart.step_mm and apart.homing is not None and order[-1] != len(apart.pieces) - 1:
        number_of_line, home = apart.homing
        tail[number_of_line] = _step(at, home, apart.step_mm)
    lines += [text for text in tail if text.strip() and not (apart.ours and is_comment(text))]
    return "\n".join([*_renumbered(lines, apart.numbered), ""])


def _restored(state: State, piece: Piece, file: str) -> list[str]:
    """The words that put in force what held for a piece."""
    wanted = dict(piece.before)
    for key in state.keys() - wanted.keys() - _SET_BY_ITSELF:
        if key not in _FROM_THE_START:
            raise InputError(
                f"what holds for the burn that begins here was never said, and {' '.join(state[key])} comes later in "
                "the program: nobody can be sure of it; say it at the program's top",
                file=file or None,
                line=piece.line,
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


def _travel(at: Point, to: Point, state: State, apart: TakenApart) -> str:
    if apart.step_mm:
        return _step(at, to, apart.step_mm)
    inch = state.get("units") in (("G20",), ("G70",))
    x, y = (number(v / 25.4 if inch else v, 6) for v in to)
    return f"{apart.rapid} X{x} Y{y}".strip()


def _step(at: Point, to: Point, step_mm: float) -> str:
    """A move that counts from the last one, in whole steps with their signs."""
    return "".join(f"{round((b - a) / step_mm):+d}" for a, b in zip(at, to, strict=True))


def _renumbered(lines: Sequence[str], numbering: tuple[int, int] | None) -> list[str]:
    """The lines with their numbers in order again, where they have any; comments and % have none."""
    if numbering is None:
        return list(lines)
    start, step = numbering
    made, count = [], 0
    for text in lines:
        bare = NUMBER.sub("", text, count=1)
        if is_comment(bare) or bare.strip() == "%":
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
    was, now = ((b.pierce_s, b.paused_s, b.wait_s, b.moving_s, *np.ravel(b.unlit)) for b in (old, new))
    return bool(off_mm <= SAME_MM and bent <= 1e-4 and np.allclose(was, now, rtol=1e-4, atol=1e-4))


def _holds(old: Piece, new: Piece) -> bool:
    """Whether what was in force for a burn still is."""
    return all(new.before.get(key) == words for key, words in old.before.items() if key not in _SET_BY_ITSELF)
