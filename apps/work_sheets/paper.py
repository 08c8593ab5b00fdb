"""Texts, tables and pictures one below the other on sheets of A4: what does not fit goes on to the next page."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np

from kerfwise.app_modules import library
from kerfwise.languages import ENGLISH_TEXTS, Texts
from kerfwise.postproc.report.plot import A4
from kerfwise.postproc.report.scene import FAINT, INK, Item, Scene, SceneLayer, Shape, Style, TextLine, text_width

WIDTH, HEIGHT = A4
MARGIN, FOOT = 34.0, 30.0
ROOM = WIDTH - 2 * MARGIN
"""Width that can be written on, points."""
_LEAD = 1.42
_RULE = Style(stroke="#ced4da", width=0.5)
BOX = "\N{BALLOT BOX}"
"""In a cell of a table: a box to tick."""


class Paper:
    """Pages that are filled from the top; lengths are points, y counts down."""

    def __init__(self, title: str, say: Texts = ENGLISH_TEXTS) -> None:
        self.title, self._say = title, say
        self._pages: list[list[Item]] = [[]]
        self.y = MARGIN

    @property
    def left_over(self) -> float:
        """Height that is still free on this page."""
        return HEIGHT - FOOT - self.y

    def new_page(self) -> None:
        """Go on at the top of another page."""
        self._pages.append([])
        self.y = MARGIN

    def room_for(self, height: float) -> None:
        """Go on at the next page where so much is not free on this one."""
        if height > self.left_over and self.y > MARGIN:
            self.new_page()

    def put(self, items: Iterable[Item]) -> None:
        """Draw on this page, wherever the items say."""
        self._pages[-1].extend(items)

    def skip(self, height: float) -> None:
        """Leave room."""
        self.y += height

    def heading(self, text: str) -> None:
        """A line above what follows, which begins on the same page."""
        self.room_for(40.0)
        self.skip(5.0)
        self.put([TextLine(MARGIN, self.y + 6, text, 9.5, INK, "start", bold=True)])
        self.skip(15.0)

    def lines(self, texts: Iterable[str], size: float = 8.0, mark: str = "") -> None:
        """Texts, each from a line of its own on, broken where they are too long; `mark` stands before each."""
        indent = text_width(mark + " ", size) + 4 if mark else 0.0
        for text in texts:
            for k, line in enumerate(broken(text, size, ROOM - indent)):
                self.room_for(size * _LEAD)
                middle = self.y + size / 2
                if mark and k == 0:
                    self.put(_cell(mark, MARGIN, middle, size, size * 1.5))
                self.put([TextLine(MARGIN + indent, middle, line, size, INK, "start")])
                self.skip(size * _LEAD)

    def pairs(self, facts: Sequence[tuple[str, str]], width: float, name: float = 62.0, size: float = 8.0) -> None:
        """Names with their values, in a column `width` wide."""
        for label, value in facts:
            self.put([TextLine(MARGIN, self.y + size / 2, label, size, FAINT, "start")])
            for line in broken(value, size, width - name):
                self.put([TextLine(MARGIN + name, self.y + size / 2, line, size, INK, "start")])
                self.skip(size * _LEAD)

    def picture(self, scene: Scene) -> None:
        """A picture in the middle; smaller where it is larger than a page."""
        scale = min(ROOM / scene.width, (HEIGHT - MARGIN - FOOT) / scene.height, 1.0)
        self.room_for(scale * scene.height)
        left = MARGIN + (ROOM - scale * scene.width) / 2
        self.put(move_item(item, left, self.y, scale) for layer in scene for item in layer.items)
        self.skip(scale * scene.height)

    def table(self, head: Sequence[str], rows: Sequence[Sequence[str]], blocks: int = 1) -> None:
        """A table under its head, in up to so many blocks side by side, each column as wide as what stands in it.

        Columns in which nothing stands are left out.
        """
        size, high, gap = 7.5, 11.0, 18.0
        if not rows:
            return
        kept = [k for k, column in enumerate(zip(*rows, strict=True)) if any(column)]
        head, *rows = ([row[k] for k in kept] for row in (head, *rows))
        needed = [
            _APART + max(size * 1.1 if text == BOX else text_width(text, size) for text in column)
            for column in zip(head, *rows, strict=True)
        ]
        while blocks > 1 and sum(needed) > (ROOM - gap * (blocks - 1)) / blocks:
            blocks -= 1
        wide = (ROOM - gap * (blocks - 1)) / blocks
        columns = _fitted(needed, wide)
        left_rows = list(rows)
        while left_rows:
            self.room_for(3 * high)
            fits = max(int(self.left_over / high) - 1, 1)
            count = min(fits, math.ceil(len(left_rows) / blocks))
            for block in range(blocks):
                taken, left_rows = left_rows[:count], left_rows[count:]
                if taken:
                    self._block(head, taken, columns, MARGIN + block * (wide + gap), size, high)
            self.skip((count + 1) * high)
            if left_rows:
                self.new_page()

    def _block(
        self, head: Sequence[str], rows: Sequence[Sequence[str]], columns: Sequence[float], x: float, size: float,
        high: float,
    ) -> None:  # fmt: skip
        wide = sum(columns)
        for k, row in enumerate((head, *rows)):
            middle, at = self.y + (k + 0.5) * high, x
            for text, column in zip(row, columns, strict=True):
                self.put(_cell(text, at, middle, size, column - 3, FAINT if k == 0 else INK))
                at += column
            if k % 5 == 0:
                y = self.y + (k + 1) * high
                self.put([Shape((np.array([(x, y), (x + wide, y)]),), _RULE, closed=False)])

    def scenes(self) -> tuple[Scene, ...]:
        """The pages, each with its number at the foot."""
        count = len(self._pages)
        return tuple(
            Scene(WIDTH, HEIGHT, (SceneLayer("page", (*items, *self._foot(k, count))),), self.title)
            for k, items in enumerate(self._pages, 1)
        )

    def _foot(self, page: int, count: int) -> Iterator[Item]:
        y = HEIGHT - FOOT / 2 - 2
        yield TextLine(MARGIN, y, shortened(self.title, 7.0, ROOM - 60), 7.0, FAINT, "start")
        yield TextLine(
            WIDTH - MARGIN, y, self._say.tr("page {page} of {count}").format(page=page, count=count), 7.0, FAINT, "end"
        )


_APART = 4.0


def _fitted(needed: Sequence[float], wide: float) -> list[float]:
    """Widths of columns, `wide` in all: where they need more, the widest become narrower, all alike.

    Examples
    --------
    >>> _fitted([10, 40, 90], 100), _fitted([10, 20], 60)
    ([10, 40, 50.0], [22.0, 38.0])
    """
    spare = min((wide - sum(needed)) / len(needed), 3 * _APART)
    if spare >= 0:
        columns = [one + spare for one in needed]
        columns[-1] += wide - sum(columns)
        return columns
    most, ordered = 0.0, sorted(needed)
    for k, one in enumerate(ordered):  # as many as need less than an equal share of what is left have all
        most = (wide - sum(ordered[:k])) / (len(ordered) - k)
        if one > most:
            break
    return [min(one, most) for one in needed]


def _cell(text: str, x: float, middle: float, size: float, width: float, colour: str = INK) -> Iterator[Item]:
    if text == BOX:
        side = 0.9 * size
        ring = np.array([(x, middle - side / 2), (x + side, middle - side / 2), (x + side, middle + side / 2),
                         (x, middle + side / 2)])  # fmt: skip
        yield Shape((ring,), Style(stroke=INK, width=0.7))
    elif text:
        yield TextLine(x, middle, shortened(text, size, width), size, colour, "start")


def shortened(text: str, size: float, width: float) -> str:
    """The text, or as much of its beginning and its end as the width holds, with an ellipsis between.

    The end of a long name says which copy and which contour it is.

    Examples
    --------
    >>> shortened("P1.outer", 8, 100), shortened("bracket-left-12.outer", 8, 70)
    ('P1.outer', 'bracke…2.outer')
    """
    if text_width(text, size) <= width:
        return text
    head, tail = text[: (len(text) + 1) // 2], text[(len(text) + 1) // 2 :]
    while (head or tail) and text_width(f"{head}…{tail}", size) > width:
        if len(head) >= len(tail):
            head = head[:-1]
        else:
            tail = tail[1:]
    return f"{head}…{tail}"


def broken(text: str, size: float, width: float) -> list[str]:
    """The text in lines no wider than `width`, broken between words, and within one that is longer than a line.

    Examples
    --------
    >>> broken("holes before outlines", 8, 70)
    ['holes before', 'outlines']
    >>> broken("kerf 1.5\\u00a0mm", 8, 40)
    ['kerf', '1.5\\xa0mm']
    """
    lines: list[str] = []
    for word in filter(None, re.split("[ \t\n]+", text)):  # a space that does not break holds a number to its unit
        if lines and text_width(f"{lines[-1]} {word}", size) <= width:
            lines[-1] += f" {word}"
            continue
        while text_width(word, size) > width and len(word) > 1:
            fits = next(k for k in range(len(word) - 1, 0, -1) if k == 1 or text_width(word[:k], size) <= width)
            lines.append(word[:fits])
            word = word[fits:]
        lines.append(word)
    return lines or [""]


def move_item(item: Item, dx: float, dy: float, scale: float = 1.0) -> Item:
    """The item elsewhere on the page, and `scale` times as large."""
    if isinstance(item, TextLine):
        return replace(item, x=scale * item.x + dx, y=scale * item.y + dy, size=scale * item.size)
    style = replace(item.style, width=scale * item.style.width, dash=tuple(scale * d for d in item.style.dash))
    if isinstance(item, Shape):
        return replace(item, lines=tuple(scale * line + np.array([dx, dy]) for line in item.lines), style=style)
    return replace(item, x=scale * item.x + dx, y=scale * item.y + dy, radius=scale * item.radius, style=style)


# A QR code as squares of a scene.


def qr_items(text: str, x: float, y: float, size: float) -> Iterator[Item]:
    """The code of a text, `size` wide, with its corner at the page's (x, y): a bar for each run of dark squares.

    The white margin that readers ask for is left around it by whoever sets it.
    """
    rows = library("segno", "a work sheet", "sheets").make_qr(text, error="m").matrix
    module = size / len(rows)
    bars = []
    for k, row in enumerate(rows):
        at = 0
        for dark, run in groupby(row):
            length = len(list(run))
            if dark:
                left, top = x + at * module, y + k * module
                right, low = left + length * module, top + module
                bars.append(np.array([(left, top), (right, top), (right, low), (left, low)]))
            at += length
    yield Shape(tuple(bars), Style(fill=INK))
