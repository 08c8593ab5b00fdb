"""G-code: what moves and switches the torch, block by block, as a dialect spells it."""

from __future__ import annotations

import math
import re
import unicodedata
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import chain, pairwise

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.torch_path import CornerFeed, Paced, paced
from kerfwise.postproc.dialects import Dialect, own_wait_s, powers_of
from kerfwise.postproc.dialects.blocks import DWELL
from kerfwise.postproc.dialects.dialect import INCH_MM

from .kerf_by_control import named_path, run_up

CHORD_MM = 0.001
RISE_MM = 0.0025
SPECK_MM = 1e-4
FLAT_RAD = 1e-3
_NO_WAIT_S = 1e-9
_SETS_MOTION = re.compile(r"G0*[0-3](?![0-9])")
_NAMES_PROGRAM = re.compile(r"%.*|[O:][0-9]+")
"""Rows without an N word: those that frame a program and name it."""
_BY_RADIUS_RAD = 1.6
"""An arc that turns further is split where a dialect gives the radius: near a half turn its centre hangs on the last
digit."""


class GcodeWriter:
    """Writes blocks in a dialect; `at` is where the torch stands, in the program's coordinates, mm.

    `powers` are S words, by the names that stand for them; without them those of the dialect hold.

    Points are rounded first and centres computed from the rounded points, so that the radius at an arc's end equals
    the radius at its start to about one unit of the last decimal: controls compare the two (LinuxCNC to 0.0283 mm,
    GRBL to 0.005 mm). Positions that count from the last one are differences of rounded ones, so that nothing adds up.

    Examples
    --------
    >>> from kerfwise.postproc.dialects import load_dialect
    >>> pen = GcodeWriter(load_dialect("linuxcnc"), (0.0, 0.0))
    >>> pen.rapid((10, 5)), pen.path(Curve.of([(10, 5, 1.0), (20, 5)], closed=False), 10.0)
    ('G0 X10 Y5', ['G3 X20 Y5 I5 J0 F600'])
    """

    def __init__(
        self,
        dialect: Dialect,
        at: Point,
        powers: Mapping[str, int] | None = None,
        plant: Mapping[str, str] | None = None,
    ) -> None:
        self.dialect = dialect
        self.powers = powers_of(dialect) if powers is None else powers
        self.plant = plant or {}
        self._per_mm = dialect.per_mm
        spelt = dialect.trailing_zeros or dialect.whole_point or dialect.decimal != "."
        self._plain = not (spelt or dialect.signed or dialect.whole_digits > 1)
        """Whether its lengths are spelt as `number` has them."""
        # Where positions count from the last one, the first is where the torch stands, whatever its digits.
        self._zero = at if dialect.positions == "incremental" else (0.0, 0.0)
        self.at = self._rounded(at)
        self._said: dict[str, str] = {}
        """The words in force, for a dialect that says them only where they change."""
        self.shared: frozenset[tuple[str, ...]] = frozenset()
        """The paths of copies, each from where it begins, that a dialect with subprograms calls."""
        self._marks: bool | None = None
        self.torches = 1
        self.kerf_mm = 0.0
        self._lit: set[int] | None = None
        self.upright = ""
        """Words that bring a tilted head upright: they stand in the next rapid."""
        self.turned = False
        """Whether a head has turned by blocks of its own."""

    def select(self, marks: bool) -> tuple[str, ...]:
        """Select the torch, or what marks, where the other was in use."""
        if marks == self._marks:
            return ()
        self._marks = marks
        return tuple(self.others(self.dialect.mark_station if marks else self.dialect.torch_station))

    def others(self, blocks: Iterable[str]) -> list[str]:
        """Blocks of the dialect's own: what they may have set is said again behind them."""
        lines = list(blocks)
        if self._said and (text := " ".join(lines)):
            if _SETS_MOTION.search(text):
                self._said.pop("motion", None)
            if "F" in text:
                self._said.pop("feed", None)
        return lines

    def leave(self, torches: Collection[int]) -> list[str]:
        """Deselect all further torches but these: before the first cut all others."""
        lit = set(range(2, self.torches + 1)) if self._lit is None else self._lit
        blocks = [
            text for torch in sorted(lit - set(torches)) for text in self._torch(self.dialect.torch_deselect, torch)
        ]
        self._lit = set() if self._lit is None else lit & set(torches)
        return blocks

    def add(self, torches: Collection[int]) -> list[str]:
        """Select these further torches, where they are not."""
        new = set(torches) - (self._lit or set())
        self._lit = {*(self._lit or ()), *new}
        return [text for torch in sorted(new) for text in self._torch(self.dialect.torch_select, torch)]

    @staticmethod
    def _torch(blocks: Sequence[str], torch: int) -> list[str]:
        return [block.format(torch=torch, output=torch - 1) for block in blocks]

    def rapid(self, point: Point) -> str:
        """Travel to a point with the torch off."""
        end = self._rounded(point)
        block = self._spelt(self.dialect.rapid, self._words(end), end)
        self.at = end
        block, self.upright = f"{block} {self.upright}".rstrip(), ""
        return block

    def beside(self, path: Curve, left: bool) -> list[str]:
        """Run up to where a path begins, and have the control keep the torch to its left, or right, from there on."""
        kerf = self.dialect.kerf
        assert kerf is not None
        named = next(chain(*named_path(path.segments, left, self.kerf_mm)))
        length_mm = max(kerf.run_up_mm, self.kerf_mm)
        return [
            self.rapid(run_up(named, length_mm)),
            *self.others([(kerf.left if left else kerf.right).format(**self.powers, **self.plant)]),
            self.rapid(named.start),
        ]

    def start(self, marks: bool, dwell_s: float, feed_mm_s: float) -> list[str]:
        """Start the torch, or what marks, and wait for `dwell_s`, where that is more than nothing."""
        blocks = self.dialect.mark_on if marks else self.dialect.torch_on
        dwell_s -= 0.0 if marks else own_wait_s(self.dialect)
        wait = f"{{{DWELL}}}"
        lines: list[str] = []
        for block in blocks if wait in blocks else (*blocks, wait):
            if block != wait:
                lines.append(block.format(**self._feeds(feed_mm_s), dwell="", **self.powers, **self.plant))
            elif dwell_s > _NO_WAIT_S:
                lines += self.wait(dwell_s)
        return self.others(lines)

    def stop(self, marks: bool) -> tuple[str, ...]:
        """Stop it."""
        return tuple(self.others(self.dialect.mark_off if marks else self.dialect.torch_off))

    def wait(self, seconds: float) -> list[str]:
        """The blocks that wait."""
        time = {"seconds": self._shown(seconds, 3), "milliseconds": self._shown(seconds * 1000, 0)}
        return self.others(block.format(**time) for block in self.dialect.dwell)

    def path(
        self,
        path: Curve,
        feed_mm_s: float,
        corners: CornerFeed | None = None,
        unlit: Sequence[tuple[float, float]] = (),
        left: bool | None = None,
    ) -> list[str]:
        """The blocks that run an open path from its first point, at which the torch already stands.

        With `corners` the feed changes where they say. Over the stretches `unlit`, mm from its start, the torch goes
        out, and moves on. Where the control adds the kerf, and keeps the torch to the `left` or right, the path that it
        is named lies beside that of the torch.

        Arcs beyond a half turn are split, because near a full turn the last decimal decides between all and
        nothing; others where the dialect allows less. Arcs that turn less than 0.001 rad become chords within 0.001 mm,
        those that rise less than 0.0025 mm one line: LinuxCNC refuses a radius under 0.00127 mm.
        """
        dialect = self.dialect
        blocks: list[str] = []
        modal = "feed" in dialect.modal
        in_force = self._said.get("feed", "") if modal else ""
        ends, at_mm = [mm for stretch in unlit for mm in stretch], 0.0
        self.at = self._rounded(path.segments[0].start) if path.segments else self.at
        words: dict[float, str] = {}
        rows: Iterable[Paced] = _split(paced(path, corners), ends) if ends else paced(path, corners)
        named: Iterator[tuple[Segment, ...]] | None = None
        if left is not None:
            rows = list(rows)
            named_rows = named_path([stretch for stretch, _ in rows], left, self.kerf_mm)
            self.at, named = self._rounded(next(chain(*named_rows)).start), iter(named_rows)
        for stretch, share in rows:
            while ends and ends[0] <= at_mm + SPECK_MM:
                blocks += self._over_tab(len(ends) % 2 == 1, feed_mm_s)
                in_force, ends = "", ends[1:]
            at_mm += stretch.length_mm if ends else 0.0
            if share not in words:
                words[share] = dialect.feed.format(**self._feeds(feed_mm_s * share))
            word = words[share]
            ways = (stretch,) if named is None else next(named)
            for piece in chain.from_iterable(self._pieces(way) if way.is_arc else (way,) for way in ways):
                end = self._rounded(piece.end)
                if end == self.at:
                    continue
                motion = self._arc(piece, end) if piece.is_arc else self._spelt(dialect.line, self._words(end), end)
                if word == in_force:
                    blocks.append(motion)
                else:
                    blocks += [word, motion] if dialect.feed_alone else [f"{motion} {word}"]
                in_force, self.at = word, end
                if modal:
                    self._said["feed"] = word
        return blocks

    def feed_word(self, feed_mm_s: float) -> str:
        """The word of a feed."""
        return self.dialect.feed.format(**self._feeds(feed_mm_s))

    def shares_of(self, segment: Segment) -> Iterator[tuple[str, float]]:
        """The blocks of a line or an arc without its feed, each with what share of it is done then."""
        length_mm, done_mm = segment.length_mm, 0.0
        for piece in self._pieces(segment) if segment.is_arc else (segment,):
            done_mm += piece.length_mm
            end = self._rounded(piece.end)
            if end != self.at:
                block = self._arc(piece, end) if piece.is_arc else self._spelt(self.dialect.line, self._words(end), end)
                self.at = end
                yield block, min(done_mm / length_mm, 1.0)

    def called_path(
        self,
        path: Curve,
        feed_mm_s: float,
        corners: CornerFeed | None = None,
        unlit: Sequence[tuple[float, float]] = (),
        only: Collection[tuple[str, ...]] | None = None,
    ) -> list[str]:
        """As `path`, counting from where it begins, so that the path of a copy has the same blocks.

        Where these are not among `only`, the path counts from zero as any other.
        """
        sub = self.dialect.subprogram
        assert sub is not None
        x, y = path.segments[0].start
        pen = GcodeWriter(replace(self.dialect, positions="incremental"), (0.0, 0.0), self.powers, self.plant)
        blocks = (sub.stepwise, *pen.path(path.moved(-x, -y), feed_mm_s, corners, unlit), sub.from_zero)
        if only is not None and blocks not in only:
            return self.path(path, feed_mm_s, corners, unlit)
        self.at = self._rounded((self.at[0] + pen.at[0], self.at[1] + pen.at[1]))
        self._said.clear()
        return list(blocks)

    def _over_tab(self, ends: bool, feed_mm_s: float) -> list[str]:
        """Put the torch out where a tab begins, or light it again where it ends, without a wait."""
        if not ends:
            return self.others(self.dialect.tab_begin or self.dialect.torch_off)
        if not self.dialect.tab_end:
            return self.start(False, 0.0, feed_mm_s)
        return self.others(block.format(**self._feeds(feed_mm_s), **self.powers) for block in self.dialect.tab_end)

    def _arc(self, piece: Segment, end: Point) -> str:
        arc = Segment(self.at, end, piece.bulge)
        cx, cy = arc.centre
        i, j = (cx, cy) if self.dialect.arc_centre == "absolute" else (cx - self.at[0], cy - self.at[1])
        words = self._words(end)
        if self.dialect.arc_centre == "radius":
            words["r"] = self._number(math.dist(self.at, (cx, cy)))
        else:
            words |= {"i": self._number(i), "j": self._number(j)}
        return self._spelt(self.dialect.arc_ccw if piece.bulge > 0 else self.dialect.arc_cw, words, end)

    def _spelt(self, motion: str, words: dict[str, str], end: Point) -> str:
        """A block of a motion: its own text with the words filled in, or its word with all of them behind it.

        A word that is in force is left out, where the dialect says words only where they change.
        """
        if "{" in motion:
            self._said.pop("motion", None)  # the block says a motion word of its own
            return motion.format(**dict.fromkeys("xyijr", "0") | words)
        last_words, modal = self._said, self.dialect.modal
        for axis, letter in enumerate("xy") if modal and self._zero == (0.0, 0.0) else ():
            if letter in modal and last_words.get(letter) and end[axis] == self.at[axis] and end != self.at:
                del words[letter]
            last_words[letter] = letter
        spelt = [f"{letter.upper()}{text}" for letter, text in words.items()]
        if motion and not ("motion" in modal and last_words.get("motion") == motion):
            spelt.insert(0, motion)
        if modal:
            last_words["motion"] = motion
        return " ".join(spelt)

    def _words(self, end: Point) -> dict[str, str]:
        x, y = end
        if self.dialect.positions == "incremental":
            x, y = x - self.at[0], y - self.at[1]
        return {"x": self._number(x), "y": self._number(y)}

    def _number(self, mm: float) -> str:
        if self._plain:
            return number(mm * self._per_mm, self.dialect.decimals)
        text, whole = self._shown(mm * self._per_mm, self.dialect.decimals), self.dialect.whole_digits
        if whole > 1:
            bare = text.lstrip("-")
            text = text[: len(text) - len(bare)] + bare.zfill(whole + len(bare) - len(re.split("[.,]", bare)[0]))
        return f"+{text}" if self.dialect.signed and not text.startswith("-") else text

    def _shown(self, value: float, decimals: int) -> str:
        """A number with the zeros, and the point or comma, that the dialect wants."""
        return shown_number(value, decimals, self.dialect)

    def _feeds(self, feed_mm_s: float) -> dict[str, str]:
        """A feed in each unit; `mm_min` is a minute's way in the units of the program: inches in one in inches."""
        dialect = self.dialect
        digits = (3 if dialect.decimals else 0) if dialect.feed_decimals is None else dialect.feed_decimals
        mm_min = feed_mm_s * 60
        by_unit = {
            "mm_min": mm_min / (INCH_MM if dialect.inch else 1.0),
            "in_min": mm_min / INCH_MM,
            "m_min": mm_min / 1000,
            "mm_s": feed_mm_s,
            "cm_s": feed_mm_s / 10,
        }
        extra = 0 if dialect.feed_decimals is not None else 1 if dialect.decimals else 3
        return {
            unit: self._shown(value, digits if unit == "mm_min" else digits + extra) for unit, value in by_unit.items()
        }

    def _pieces(self, segment: Segment) -> Iterator[Segment]:
        """An arc as lines and arcs that every control makes the same way."""
        dialect = self.dialect
        rise_mm = segment.chord_mm * abs(segment.bulge) / 2
        most_mm = dialect.greatest_radius_mm
        chords = dialect.arc_centre == "none" or (most_mm is not None and segment.radius_mm > most_mm)
        if rise_mm < RISE_MM:
            yield Segment(segment.start, segment.end)
        elif not chords and (count := pieces_of_arc(segment, dialect)) > 1:
            yield from (
                piece for k in range(count) for piece in self._pieces(segment.between(k / count, (k + 1) / count))
            )
        elif chords or abs(segment.sweep_rad) < FLAT_RAD:
            at = segment.start
            for x, y in segment.flatten(dialect.chord_mm if chords else CHORD_MM).tolist():
                yield Segment(at, (x, y))
                at = (x, y)
        else:
            yield segment

    def _rounded(self, point: Point) -> Point:
        d, scale, (x, y) = self.dialect.decimals, self._per_mm, self._zero
        if scale == 1.0 and self._zero == (0.0, 0.0):
            return round(point[0], d), round(point[1], d)
        return x + round((point[0] - x) * scale, d) / scale, y + round((point[1] - y) * scale, d) / scale


def pieces_of_arc(segment: Segment, dialect: Dialect) -> int:
    """In how many pieces an arc is written: none turns further than the dialect says."""
    most = math.radians(dialect.greatest_sweep_deg)
    if dialect.arc_centre == "radius":
        most = min(most, _BY_RADIUS_RAD)
    return max(1, math.ceil(abs(segment.sweep_rad) / most - 1e-6))


def _split(pieces: Iterable[Paced], at_mm: Sequence[float]) -> Iterator[Paced]:
    """The lines and arcs of a path, taken apart at these lengths from its start."""
    begin_mm = 0.0
    for segment, share in pieces:
        length_mm = segment.length_mm
        inner = [mm - begin_mm for mm in at_mm if SPECK_MM < mm - begin_mm < length_mm - SPECK_MM]
        if inner:
            ends = pairwise([0.0, *inner, length_mm])
            yield from ((segment.between(low / length_mm, high / length_mm), share) for low, high in ends)
        else:
            yield segment, share
        begin_mm += length_mm


def shown_number(value: float, decimals: int, dialect: Dialect) -> str:
    """A number with the zeros, and the point or comma, that a dialect wants."""
    text = f"{value:.{decimals}f}" if dialect.trailing_zeros else number(value, decimals)
    if text.startswith("-") and not text.strip("-0."):
        text = text[1:]
    if dialect.whole_point and "." not in text:
        text += "."
    return text.replace(".", dialect.decimal) if dialect.decimal != "." else text


def with_subprograms(body: Sequence[str], dialect: Dialect) -> list[str]:
    """The blocks of a program in which paths that come again are called, and stand behind its end."""
    sub = dialect.subprogram
    if sub is None:
        return list(body)
    begins = [k for k, block in enumerate(body) if block == sub.stepwise]
    spans = [(k, next(j for j in range(k, len(body)) if body[j] == sub.from_zero) + 1) for k in begins]
    often = Counter(tuple(body[a:b]) for a, b in spans)
    numbers = {path: sub.first + k for k, path in enumerate(path for path, count in often.items() if count > 1)}
    lines, at = list[str](), 0
    for a, b in spans:
        number_of = numbers.get(tuple(body[a:b]))
        lines += [*body[at:a], *(body[a:b] if number_of is None else [sub.call.format(sub=number_of)])]
        at = b
    frame = ["%"] if body[-1] == "%" else []
    lines += body[at : len(body) - len(frame)]
    for path, number_of in numbers.items():
        lines += [sub.begin.format(sub=number_of), *path, sub.end]
    return lines + frame


# Blocks of a program as text: numbers, comments, and N words.


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
    ascii_text = text
    if not text.isascii():
        ascii_text = "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))
    return re.sub(r"[^A-Za-z0-9 ._+:,/=-]", "_", ascii_text)


def comment(dialect: Dialect, head: str, text: str = "", tail: str = "") -> str:
    """A comment block; where it is too long for the control, `text` is cut short. "" where there are no comments."""
    if dialect.comment is None:
        return ""
    words = (head, plain(text)[: max(room_for(dialect, head, tail), 0)], tail)
    return dialect.comment.format(text=" ".join(w for w in words if w))


def room_for(dialect: Dialect, head: str, tail: str = "") -> int:
    """How many characters fit into a comment between two texts."""
    return dialect.max_line - len((dialect.comment or "{text}").format(text=f"{head}  {tail}"))


def is_comment(block: str, dialect: Dialect) -> bool:
    """Whether only a person reads the block."""
    return not block or (dialect.comment is not None and block.startswith(_begin_of(dialect.comment)))


@lru_cache
def _begin_of(comment_form: str) -> str:
    return comment_form.partition("{text}")[0]


def number_blocks(blocks: Iterable[str], dialect: Dialect) -> Iterator[str]:
    """The blocks with their N words, empty ones left out; comments have none.

    Raises InputError for a block longer than the control takes.
    """
    rule = dialect.line_numbers
    number_of_block = rule.start if rule is not None else 0
    for block in filter(None, blocks):
        line, told = block, is_comment(block, dialect)
        if rule is not None and not told and not _NAMES_PROGRAM.fullmatch(block):
            line = f"N{number_of_block} {block}"
            number_of_block += rule.step
            if rule.highest and number_of_block > rule.highest:
                number_of_block = rule.start
        if not dialect.blanks and not told:
            line = line.replace(" ", "")
        if len(line.encode()) > dialect.max_line:
            raise InputError(f"dialect '{dialect.name}': block longer than max_line {dialect.max_line}: {line}")
        yield line


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
