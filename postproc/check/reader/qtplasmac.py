"""QtPlasmaC: what its filter makes of a program before it runs, and its words for material, tool and speed."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from kerfwise.encoder.errors import InputError

from .controls import COMMENT, Row, without
from .grammar import ModalState
from .program import State, Track

# What QtPlasmaC's filter makes of a program before it runs: it rewrites lines, and comments some out.
#
# The filter (`qtplasmac_gcode`, part of LinuxCNC) looks for letters anywhere in a line, its comments included. Where
# it would change what a line does, the check has read another program than the one that runs.

_NUMBER = re.compile(r"[Nn](?P<digits>[0-9.\s]*)")
_MAGIC = re.compile(r"\(\s*o\s*=|;conversational block|;qtplasmac filtered G-code file", re.IGNORECASE)
_TAKEN_FOR_WORDS = re.compile(r"z[0-9. \[-]|g2[01]|g4[012]|g9[01]|m66|\[#<")
_MOVES = ("g0x", "g0y", "g1x", "g1y")


@dataclass(slots=True)
class Filter:
    """Follows the filter; it starts no tool before it has seen a line that begins with a move of X or Y."""

    track: Track
    moved: bool = False
    raised: bool = False

    def pass_(self, raw: str, row: Row, line: int, absolute: bool) -> None:
        """Pass a row on; `absolute` is how the program counts before it (G90).

        Raises
        ------
        InputError
            With line and column, for a row that the filter would change, or obey.
        """
        if ("(" in raw or ";" in raw) and (found := _MAGIC.search(raw)):
            raise InputError(
                f"QtPlasmaC obeys '{found[0]}' in a comment: not supported here; take it out",
                line=line,
                column=found.start() + 1,
            )
        text = raw.strip()
        if row.code.startswith("N"):
            text = self._without_number(raw, line)
        if not text or text[0] in "(;" or row.code == "%":
            return
        if not text[0].isalpha():
            raise InputError(
                f"a line that begins with {text[0]}, which QtPlasmaC makes a comment of: not supported here; write "
                "its G or M word first",
                line=line,
                column=row.columns[0],
            )
        if row.trailing:
            self._comment(raw, text, row, line)
        self._starts(text, line, absolute)

    def _without_number(self, raw: str, line: int) -> str:
        text = raw.strip()
        found = _NUMBER.match(text)
        if found is None or not found["digits"] or not (found["digits"][0].isdigit() or found["digits"][0] == "."):
            raise InputError(
                "N apart from its number, which QtPlasmaC makes a comment of: not supported here; write such as N10",
                line=line,
                column=raw.index(text[0]) + 1,
            )
        return text[found.end() :].lstrip()

    def _comment(self, raw: str, text: str, row: Row, line: int) -> None:
        """A comment behind words: one at the line's end, with nothing that the filter takes for a word."""
        column = min(raw.index(char) for char in "(;" if char in raw) + 1
        if row.columns[-1] > column:
            why = "words behind a comment"
        elif ("(" in text) != (text.rstrip(". ")[-1:] == ")"):
            why = "a '(' or ')' in a comment behind words"
        elif "(" in text and ";" in text and text.index("(") < text.index(";"):
            why = "two comments behind words"
        elif found := _TAKEN_FOR_WORDS.search(text, text.index(raw[column - 1])):
            why = f"'{found[0]}' in a comment behind words"
        else:
            return
        raise InputError(
            f"{why}, which QtPlasmaC's filter misreads: not supported here; give the comment a line of its own",
            line=line,
            column=column,
        )

    def _starts(self, text: str, line: int, absolute: bool) -> None:
        code = text.lower().replace(" ", "")
        if code[1:2] == "0":
            code = re.sub(r"^([gm])0+(?=[0-9])", r"\1", code)
        if not self.raised and re.search("g0|g1|m3", code):
            self.raised = True
            if not absolute:
                raise InputError(
                    "the first move of a program that counts from place to place (G91): QtPlasmaC raises the torch "
                    "before it by G53, at which the control stops; not supported here; write G90 first, G91 later",
                    line=line,
                )
        if code.startswith(_MOVES):
            self.moved = True
        if "m3" in code and "m30" not in code and not self.moved:
            self.track.fault(
                line, "program-state", "QtPlasmaC starts no tool before a line that begins with G0 or G1 and X or Y"
            )
        if code.startswith("m5") and re.match(r"m5(?![0-9])", code):
            self.moved = False


# Words of QtPlasmaC that choose a material, a tool or a speed: what an old program holds besides what is checked.
#
# The check refuses them, since what they do is on the machine. Where burns are only put into another order they stay
# as they are, in force for the same burns as before.

_HOLE_WORDS = ("HOLES", "H_DIAMETER", "I_DIAMETER", "M_DIAMETER", "H_VELOCITY", "OCLENGTH", "KEEP-Z-MOTION")
_NAMED = re.compile(r"#<(?P<name>[A-Z0-9_-]+)>=(?P<value>[-+]?[0-9.]+)")
_FEED = re.compile(r"F#<_HAL\[PLASMAC\.CUT-FEED-RATE\]>")
_MATERIAL = re.compile(r"M190P-?[0-9]+")
_READY = re.compile(r"M66P3L3Q[0-9.]+")
_TOOL = re.compile(r"T[0-9]+M0?6|M0?6T[0-9]+")
_OFFSET = re.compile(r"G43(?:H[0-9]+)?")
_OUTPUT = re.compile(r"M(?P<code>6[2-5])P(?P<bit>[23])")
_PIERCE = re.compile(r"M159P(?P<what>[0-9]+)(?:Q[-0-9.]+)?")
_SPEED = re.compile(r"M6[78]E3Q(?P<share>[0-9.]+)")
_OLD_MAGIC = re.compile(r"o\s*=\s*(?P<option>[0-9]+)\s*(?:,(?P<rest>.*))?$", re.IGNORECASE)
_NUMBER_WORD = re.compile(r"N[0-9.]+")


@dataclass(slots=True)
class OldWords:
    """Takes such words off the rows of a program and keeps note of what they have set.

    `qtplasmac` says whether the control has the words. `feed_mm_min` is the feed of materials that the program only
    names, `used` are the lines where that was needed, `fed` is the last line with the feed of a material, and
    `kerfs_mm` are the kerfs of the materials that the program describes.
    """

    qtplasmac: bool
    feed_mm_min: float | None
    state: State = field(default_factory=State)
    used: list[int] = field(default_factory=list)
    fed: int = 0
    kerfs_mm: set[float] = field(default_factory=set)
    _of_material: tuple[float, int] | None = None

    def plain(self, row: Row, line: int, moves: ModalState) -> Row:
        """The row without them; a feed that the machine's material has is written as a number.

        Raises
        ------
        InputError
            With line and column, for what nobody can be sure of.
        """
        if not self.qtplasmac:
            return row
        for text in row.comments:
            if found := _OLD_MAGIC.match(text):
                self._described(found, text, line, moves)
                return Row(row.code, row.columns, ())
        if found := _SPEED.search(row.code):
            moves.share = self._share(float(found["share"]), row, found.start(), line)
            self.state["speed"] = (_spelt(found[0]),)
            row = without(row, found)
        if found := _FEED.search(row.code):
            self.fed = line
            self.state["F"] = ("F#<_hal[plasmac.cut-feed-rate]>",)
            row = without(row, found, f"F{self._feed(row, found.start(), line, moves):.9f}")
        alone = _NUMBER_WORD.sub("", row.code, count=1) if row.code.startswith("N") else row.code
        alone = alone.strip(COMMENT)
        for pattern, take in self._taken().items():
            if found := pattern.fullmatch(alone):
                take(found, line, row)
                return Row("", (), row.comments, row.comment_at)
        return row

    def _taken(self) -> Mapping[re.Pattern[str], Callable[[re.Match[str], int, Row], None]]:
        return {
            _NAMED: self._named, _MATERIAL: self._material, _READY: self._ready, _TOOL: self._tool,
            _OFFSET: self._offset, _OUTPUT: self._output, _PIERCE: self._pierce,
        }  # fmt: skip

    def _described(self, found: re.Match[str], text: str, line: int, moves: ModalState) -> None:
        if found["option"] != "0":
            raise InputError(
                f"({text}) changes the machine's material file: not supported here; take it out, or describe a "
                "material for this program alone with o=0",
                line=line,
            )
        given = dict(
            pair.split("=", 1) for pair in (found["rest"] or "").replace(" ", "").lower().split(",") if "=" in pair
        )
        try:
            feed, kerf = (float(given[key]) if key in given else None for key in ("fr", "kw"))
        except ValueError:
            raise InputError(f"({text}): expected numbers for fr and kw; correct it", line=line) from None
        if feed is None or feed <= 0:
            raise InputError(f"({text}): a material without its feed (fr=); add it", line=line)
        self._of_material = (feed, line)
        if kerf:
            self.kerfs_mm.add(round(kerf * moves.unit_mm, 6))
        self.state["material"] = (f"({text})",)

    def _share(self, percent: float, row: Row, at: int, line: int) -> float:
        if percent == 0:
            return 1.0
        if not 10 <= percent <= 100:
            raise InputError(
                f"Q{percent:g}: expected a speed of 10 to 100 %, or 0 for all; correct it",
                line=line,
                column=row.columns[at],
            )
        return percent / 100

    def _feed(self, row: Row, at: int, line: int, moves: ModalState) -> float:
        """In the program's units a minute."""
        if self._of_material is not None:
            return self._of_material[0]
        if self.feed_mm_min is None:
            raise InputError(
                "the feed comes from the material on the machine, which the program does not tell: give it (--feed)",
                line=line,
                column=row.columns[at],
            )
        self.used.append(line)
        return self.feed_mm_min / moves.unit_mm

    def _named(self, found: re.Match[str], line: int, row: Row) -> None:
        name = found["name"]
        if name == "PIERCE-ONLY" and float(found["value"]) == 0:
            return
        if name not in _HOLE_WORDS:
            raise InputError(
                f"#<{name.lower()}> is not known here, nor what it changes; post the program without",
                line=line,
                column=row.columns[0],
            )
        self.state[f"#<{name}>"] = (f"#<{name.lower()}>={found['value']}",)

    def _material(self, found: re.Match[str], line: int, row: Row) -> None:
        self._of_material = None
        self.state["material"] = (_spelt(found[0]),)

    def _ready(self, found: re.Match[str], line: int, row: Row) -> None:
        before = self.state.get("material", ())
        if not before or not before[0].startswith("M190"):
            raise InputError(
                "M66 waits for a material, but none was chosen before it (M190); correct it",
                line=line,
                column=row.columns[0],
            )
        self.state["material"] = (before[0], _spelt(found[0]))

    def _tool(self, found: re.Match[str], line: int, row: Row) -> None:
        self.state["tool"] = (_spelt(found[0]),)

    def _offset(self, found: re.Match[str], line: int, row: Row) -> None:
        self.state["tool"] = (*self.state.get("tool", ())[:1], _spelt(found[0]))

    def _output(self, found: re.Match[str], line: int, row: Row) -> None:
        if found["bit"] == "3" and found["code"] in ("62", "64"):
            raise InputError(
                f"{_spelt(found[0])} puts the torch out while the path goes on: not supported here; end the cut with "
                "M5 there",
                line=line,
                column=row.columns[0],
            )
        self.state[f"output {found['bit']}"] = (_spelt(found[0]),)

    def _pierce(self, found: re.Match[str], line: int, row: Row) -> None:
        if found["what"] == "609":  # back to the machine's own
            for key in [key for key in self.state if key.startswith("pierce ")]:
                del self.state[key]
        else:
            self.state[f"pierce {found['what']}"] = (_spelt(found[0]),)


def _spelt(code: str) -> str:
    """Words of a row with a blank before each."""
    return re.sub(r"(?<=[0-9.])(?=[A-Z])", " ", code)
