"""Words of old programs besides what is checked: carried along with the burns that they stand before.

QtPlasmaC's words choose a material, a tool or a speed. Others set heights, probe, shift zeros, select tools and powers.
The check refuses them, since what they do is on the machine. Where burns are only put into another order they stay as
they are, in force for the same burns as before.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from kerfwise.encoder.errors import InputError

from .controls import COMMENT, Control, Row, without
from .grammar import ModalState
from .program import State

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
_VALUE = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)"
_VALUES = re.compile(f"[A-Z]{_VALUE}")
_PLACE = re.compile("[XY][-+0-9.]")
_AXIS = re.compile(f"[ZABCUVW]{_VALUE}")
_GO_HOME = re.compile(f"G(?:28|30)(?:\\.1)?(?![0-9.])(?:[XYZ]{_VALUE})*")
_PROBE = re.compile(f"(?:G38\\.[2-5]|G31(?![0-9.]))(?:Z{_VALUE})?")
_MACHINE_PLACE = re.compile(f"G53(?![0-9.])(?:(?:G0*[01])?Z{_VALUE})?")
_SET_ZERO = re.compile(r"G92(?![0-9.])")
_SYSTEM = re.compile(r"G5(?:[5-8]|9(?:\.[1-3])?)(?![0-9.VD])")
_FIRST_SYSTEM = re.compile(r"G54(?![0-9.])")
_PROGRAM_NAME = re.compile(r"[O:][0-9]{1,8}")
_KERF = re.compile(f"G4[12](?:\\.1)?(?![0-9.])(?:[DP]{_VALUE})*")
_KERF_WIDTH = re.compile(f"G43X{_VALUE}")
_ANY_TOOL = re.compile(r"(?:T[0-9]+M0*6|M0*6T[0-9]+|T[0-9]+|M0*6)(?![0-9])")
_ANY_OFFSET = re.compile(r"G43(?:\.[12])?(?:H[0-9]+)?(?![0-9.X])|(?<![A-Z])H[0-9]+")
_STARTS = re.compile(r"M0*[34](?![0-9])")
_SPEED_WORD = re.compile(r"S[0-9.]+")
_M_WORD = re.compile(r"M([0-9]+)")
_G_WORD = re.compile(r"G[0-9]")
_FIRST = re.compile(r"[A-Z][0-9.]+[A-Z][0-9.]+")
_OVERRIDE = re.compile(r"G59V6[0-9]{2}F[0-9.]+")
_NO_OPTIONS = re.compile(r"G99X1(?:\.0*)?Y0(?:\.0*)?I0(?:\.0*)?J0(?:\.0*)?(?![0-9.])")
"""Options of a part under Hypertherm's EIA: a scale of one, no turn, no mirror."""
_NEAR_MM = 1e-3


@dataclass(slots=True)
class OldWords:
    """Takes such words off the rows of a program and keeps note of what they have set.

    `control` is whose program it is. `lit` says that the torch is on, `begun` that the program has named a place, and
    `carried` is the last line with words of the height, of probing and of the like, `kept_kerf` that of a kerf that the
    control adds, and `height` the last word of the height. `header` are rows before the first place whose words nobody
    here knows. `feed_mm_min` is the feed of materials that the program only names, `used` are the lines where that was
    needed, `fed` is the last line with the feed of a material, and `kerfs_mm` are the kerfs of the materials that the
    program describes.
    """

    control: Control
    feed_mm_min: float | None
    lit: bool = False
    begun: bool = False
    carried: int = 0
    kept_kerf: int = 0
    height: str | None = None
    header: list[tuple[int, str]] = field(default_factory=list)
    state: State = field(default_factory=State)
    used: list[int] = field(default_factory=list)
    fed: int = 0
    kerfs_mm: set[float] = field(default_factory=set)
    _of_material: tuple[float, int] | None = None

    def plain(self, row: Row, line: int, moves: ModalState) -> Row:
        """The row without them; a feed that the machine's material has is written as a number.

        Raises InputError with line and column, for what nobody can be sure of.
        """
        plain_row = self._of_qtplasmac(row, line, moves) if self.control.filtered else row
        if plain_row.code:
            plain_row = self._carried_off(plain_row, line, moves)
            self.begun = self.begun or bool(_PLACE.search(plain_row.code))
        return plain_row

    def _of_qtplasmac(self, row: Row, line: int, moves: ModalState) -> Row:
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

    def _carried_off(self, row: Row, line: int, moves: ModalState) -> Row:
        """The row without heights, probing, offsets, tools, and kerfs that the control adds."""
        places = bool(_PLACE.search(row.code)) and not _NO_OPTIONS.search(row.code)
        if not self.begun and not places and self._only_of_header(row):
            self.header.append((line, row.code))
            return Row("", (), row.comments, row.comment_at)
        for pattern in (_GO_HOME, _PROBE, _MACHINE_PLACE):
            while found := pattern.search(row.code):
                row, self.carried = without(row, found), line
        if (found := _SET_ZERO.search(row.code)) is not None:
            return self._set_zero(row, found, line, moves)
        if not self.begun and _PROGRAM_NAME.fullmatch(row.code):
            return Row("", (), row.comments, row.comment_at)
        if (found := _AXIS.search(row.code)) and not _OVERRIDE.fullmatch(row.code):
            height, self.height = self.height, found[0] if found[0][0] == "Z" else self.height
            stays = height is not None and float(height[1:]) == float(found[0][1:])
            if found[0][0] != "Z" or (places and not self.lit and not stays):
                what = "another axis than X, Y and Z" if found[0][0] != "Z" else "a travel that changes the height"
                raise InputError(
                    f"'{found[0]}': {what} is not supported here; post it with heights in lines of their own",
                    line=line,
                    column=row.columns[found.start()],
                )
            row, self.carried = without(row, found), self.carried if stays and places else line
        return self._settings(row, moves)

    def _only_of_header(self, row: Row) -> bool:
        """Whether a row holds M words that are not known here, and none that are."""
        codes = [float(code) for code in _M_WORD.findall(row.code)]
        others = _G_WORD.search(row.code) or _AXIS.search(row.code)
        control = self.control
        known = {*control.known_m, *control.refused_m, *control.starts, *control.stops, 6.0}
        return bool(codes) and not others and not any(code in known for code in codes)

    def _set_zero(self, row: Row, found: re.Match[str], line: int, moves: ModalState) -> Row:
        """G92: of a height it is carried; of X and Y it must name the place where the torch stands."""
        self.carried = line
        words = {word[0]: float(word[1:]) for word in _VALUES.findall(row.code[found.end() :])}
        at, unit = moves.track.at, moves.unit_mm
        if not self.begun and not moves.track.burns and {"X", "Y"} <= words.keys():
            moves.track.at = words["X"] * unit, words["Y"] * unit
        for axis, letter in enumerate("XY"):
            if letter in words and self.begun and abs(words[letter] * unit - at[axis]) > _NEAR_MM:
                raise InputError(
                    f"G92 {letter}{words[letter]:g} moves the zero, for the torch is at {at[axis] / unit:g} there: "
                    "places before it and behind it count from different zeros; not supported here",
                    line=line,
                    column=row.columns[found.start()],
                )
        return Row("", (), row.comments, row.comment_at)

    def set_process(self, code: str) -> None:
        """Keep note of a word of the control's process, by its first number."""
        self.state[f"process {_FIRST.match(code)[0]}"] = (_spelt(code),)  # type: ignore[index]

    def _settings(self, row: Row, moves: ModalState) -> Row:
        """The row without tools, coordinate systems, S words without a start, and kerfs that the control adds."""
        control = self.control
        patterns = [("kerf", _KERF), ("coordinate system", _SYSTEM), ("kerf width", _KERF_WIDTH)]
        if 54.0 not in control.known_g:
            patterns.append(("coordinate system", _FIRST_SYSTEM))
        if control.selects == 37.0:
            if found := _OVERRIDE.fullmatch(row.code):
                self.set_process(found[0])
                return without(row, found)
            patterns.append(("part options", _NO_OPTIONS))
        if "T" not in (control.torch_letter if control.selects == 37.0 else ""):
            patterns.append(("tool", _ANY_TOOL))
        if control.selects != 37.0:
            patterns.append(("tool offset", _ANY_OFFSET))
        if not control.beam and not _STARTS.search(row.code):
            patterns.append(("S", _SPEED_WORD))
        for key, pattern in patterns:
            found = pattern.search(row.code)
            if found is None:
                continue
            if key == "kerf":
                self.kept_kerf = self.kept_kerf or 1
                moves.modes.forgive(40.0)
            self.state[key] = (_spelt(found[0]),)
            row = without(row, found)
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
        fields = dict(
            pair.split("=", 1) for pair in (found["rest"] or "").replace(" ", "").lower().split(",") if "=" in pair
        )
        try:
            feed, kerf = (float(fields[key]) if key in fields else None for key in ("fr", "kw"))
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

    def charted(self, line: int) -> float:
        """The feed, mm/min, where a program says none, and the cut chart of its control has it; 0 where nobody does."""
        self.used.append(line)
        return self.feed_mm_min or 0.0

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
