"""Blocks of a program: numbers, comments, and a torch path as G1, G2 and G3."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable, Iterator

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.postproc.dialects import Dialect

CHORD_MM = 0.001
RISE_MM = 0.0025
FLAT_RAD = 1e-3


def number(value: float, decimals: int) -> str:
    """A number as a control reads it.

    Examples
    --------
    >>> number(-0.00001, 4), number(12.5, 4), number(100, 4)
    ('0', '12.5', '100')
    """
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def plain(text: str) -> str:
    """`text` without anything a control could take for more than a comment: ASCII letters, digits and ` ._+:,/=-`.

    Examples
    --------
    >>> plain("Плита (20 мм) №3; Ø12 é")
    '_____ _20 ___ No3_ _12 e'
    """
    ascii_text = unicodedata.normalize("NFKD", text)
    ascii_text = "".join(c for c in ascii_text if not unicodedata.combining(c))
    return re.sub(r"[^A-Za-z0-9 ._+:,/=-]", "_", ascii_text)


def comment(dialect: Dialect, head: str, text: str = "", tail: str = "") -> str:
    """A comment block; where it is too long for the control, `text` is cut short."""
    room = dialect.max_line - len(dialect.comment.format(text=f"{head}  {tail}"))
    words = (head, plain(text)[: max(room, 0)], tail)
    return dialect.comment.format(text=" ".join(w for w in words if w))


def is_comment(block: str, dialect: Dialect) -> bool:
    """Whether only a person reads the block."""
    return block.startswith(dialect.comment.partition("{text}")[0])


def numbered(blocks: Iterable[str], dialect: Dialect) -> Iterator[str]:
    """The blocks with their N words; comments have none.

    Raises
    ------
    InputError
        For a block longer than the control takes.
    """
    rule = dialect.line_numbers
    count = 0
    for block in blocks:
        line = block
        if rule is not None and not is_comment(block, dialect):
            line = f"N{rule.start + rule.step * count} {block}"
            count += 1
        if len(line.encode()) > dialect.max_line:
            raise InputError(f"dialect '{dialect.name}': block longer than max_line {dialect.max_line}: {line}")
        yield line


def wait_block(seconds: float, dialect: Dialect) -> str:
    """The block that waits; every value that a dialect may ask for in its `dwell` is filled in here."""
    return dialect.dwell.format(seconds=number(seconds, 3))


def rapid_block(point: Point, dialect: Dialect) -> str:
    """Travel to `point` with the torch off."""
    return f"{dialect.rapid} {_xy(_rounded(point, dialect.decimals), dialect)}"


def path_blocks(path: Curve, feed_mm_s: float, dialect: Dialect) -> list[str]:
    """The blocks that run an open `path` from its first point, at which the torch already stands.

    Points are rounded first and centres computed from the rounded points, so that the radius at an arc's end equals
    the radius at its start to about one unit of the last decimal: controls compare the two (LinuxCNC to 0.0283 mm,
    GRBL to 0.005 mm). Arcs beyond a half turn are split in two, because near a full turn that unit decides between
    all and nothing. Arcs that turn less than 0.001 rad become chords within 0.001 mm, those that rise less than
    0.0025 mm one line: LinuxCNC refuses a radius under 0.00127 mm.
    """
    d = dialect.decimals
    feed = " " + dialect.feed.format(mm_min=number(feed_mm_s * 60, 3))
    blocks: list[str] = []
    at = _rounded(path.segments[0].start, d) if path.segments else (0.0, 0.0)
    for piece in (p for segment in path.segments for p in _pieces(segment)):
        end = _rounded(piece.end, d)
        if end == at:
            continue
        if piece.is_arc:
            cx, cy = Segment(at, end, piece.bulge).centre
            i, j = (cx - at[0], cy - at[1]) if dialect.arc_centre == "relative" else (cx, cy)
            word = dialect.arc_ccw if piece.bulge > 0 else dialect.arc_cw
            blocks.append(f"{word} {_xy(end, dialect)} I{number(i, d)} J{number(j, d)}{feed}")
        else:
            blocks.append(f"{dialect.line} {_xy(end, dialect)}{feed}")
        feed, at = "", end
    return blocks


def _pieces(segment: Segment) -> Iterator[Segment]:
    """The segment as lines and arcs that every control makes the same way."""
    rise_mm = segment.chord_mm * abs(segment.bulge) / 2
    if rise_mm < RISE_MM:
        yield Segment(segment.start, segment.end)
    elif abs(segment.bulge) > 1.0 + 1e-6:
        yield from _pieces(segment.between(0.0, 0.5))
        yield from _pieces(segment.between(0.5, 1.0))
    elif abs(segment.sweep_rad) < FLAT_RAD:
        at = segment.start
        for x, y in segment.flatten(CHORD_MM).tolist():
            yield Segment(at, (x, y))
            at = (x, y)
    else:
        yield segment


def _rounded(point: Point, decimals: int) -> Point:
    return round(point[0], decimals), round(point[1], decimals)


def _xy(point: Point, dialect: Dialect) -> str:
    return f"X{number(point[0], dialect.decimals)} Y{number(point[1], dialect.decimals)}"


def seconds_text(seconds: float) -> str:
    """A time for a person to read.

    Examples
    --------
    >>> seconds_text(4383.2)
    '1 H 13 MIN 04 S'
    """
    minutes, rest = divmod(math.ceil(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} H {minutes:02d} MIN {rest:02d} S"
