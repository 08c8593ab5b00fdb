"""Programs with parameters, expressions, loops and subroutines, unfolded into plain rows as LinuxCNC runs them.

`#1=5`, `#<name>=…`, `[…]`, `o… sub, call, if, while, do, repeat`, and `M98 P… L…` with `M99`. Each row that comes out
says the line that it stands for. What hangs on the machine (its probe, its offsets, its HAL pins) is refused. Rules are
those of LinuxCNC's manual (G code overview; O codes), and are held against its interpreter in the tests.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import NamedTuple

from kerfwise.encoder.errors import InputError

from .controls import COMMENT, row_of
from .words import ExpressionReader

MOST_ROWS = 400_000
"""Rows of a program once it is unfolded, and steps of its loops, at most."""
_MOST_DEPTH = 10
_NEEDED = re.compile(r"#|\[|^(?:N[0-9.]+)?O(?:[0-9]+|<[^>]*>)[A-Z]|M98(?![0-9])", re.MULTILINE)
_PLAIN_NAME = re.compile(r"#<(?:_HAL\[PLASMAC\.CUT-FEED-RATE\])>")
_PLASMAC = frozenset(
    {"holes", "h_diameter", "i_diameter", "m_diameter", "h_velocity", "oclength", "keep-z-motion", "pierce-only"}
)
"""Names that QtPlasmaC reads itself: their rows stay."""
_O_WORD = re.compile(r"O(?P<name>[0-9]+|<[^>]+>)(?P<what>[A-Z]+)?(?P<rest>.*)")
_M98 = re.compile(r"M98(?![0-9])")
_M99 = re.compile(r"M99(?![0-9])")
_END = re.compile(r"M0*(?:2|30)(?![0-9])")
_N = re.compile(r"N[0-9.]+")
_NO_BRACKETS = str.maketrans("()", "[]")
_KEPT_BY_MACHINE = 5000


class UnfoldedRow(NamedTuple):
    """A plain row, and the line of the program that it stands for."""

    text: str
    line: int


class _Source(NamedTuple):
    """A row of the program: its line, its code, its text, and the o word that it has."""

    line: int
    code: str
    text: str
    comments: str
    word: tuple[str, str, str] | None


@contextmanager
def at_lines_of(rows: Sequence[UnfoldedRow] | None) -> Iterator[None]:
    """What is refused meanwhile of unfolded rows is refused with the line of the program that they stand for."""
    try:
        yield
    except InputError as error:
        if rows is None or error.line is None or error.line > len(rows):
            raise
        line = rows[error.line - 1].line
        raise InputError(error.message, file=error.file, line=line, details=error.details) from None


def needs_unfolding(text: str) -> bool:
    """Whether a program has anything that has to be worked out."""
    bare = re.sub(r"\([^()]*\)|;.*", "", text)
    left = _PLAIN_NAME.sub("", bare.upper())
    names = "|".join(map(re.escape, sorted(name.upper() for name in _PLASMAC)))
    left = re.sub(rf"#<(?:{names})>\s*=\s*[-+0-9.]+", "", left.replace(" ", ""))
    return bool(_NEEDED.search(left)) or bool(re.search(r"^N?[0-9.]*O[0-9]+$", left, re.MULTILINE) and "M99" in left)


def unfold(text: str, plasmac: bool = False) -> list[UnfoldedRow]:
    """The plain rows of a program, in the order in which the control runs them.

    With `plasmac` rows stay that set what QtPlasmaC reads itself, and names that the program reads nowhere. Raises
    InputError with the line, for what is malformed, hangs on the machine, stands in another file, or never ends.

    Examples
    --------
    >>> [row.text for row in unfold("#1=5\\no1 repeat [2]\\nG1 X[#1*2] (to)\\n#1=[#1+1]\\no1 endrepeat\\nM2\\n")]
    ['G1 X10 (to)', 'G1 X12 (to)', 'M2']
    """
    kept = set(_PLASMAC) if plasmac else set()
    if plasmac:
        plain = re.sub(r"\([^()]*\)|;.*|\s", lambda found: "\n" if found[0] == "\n" else "", text).lower()
        read = {name for name, rest in re.findall(r"#<([^>]+)>(=?)", plain) if not rest}
        kept |= {name for name in re.findall(r"#<([^>]+)>=", plain) if name not in read}
    return list(_Run(_sources(text), frozenset(kept)).rows())


def _sources(text: str) -> list[_Source]:
    found = []
    for line, raw in enumerate(text.split("\n"), 1):
        bare = raw.removesuffix("\r")
        row = row_of(bare, line)
        code = row.code.replace(COMMENT, "")
        numbered = _N.match(code)
        after = code[numbered.end() :] if numbered else code
        match = _O_WORD.fullmatch(after)
        word = None if match is None else (match["name"], match["what"] or "", match["rest"])
        comments = " ".join(f"({comment.translate(_NO_BRACKETS)})" for comment in row.comments)
        found.append(_Source(line, after, bare, comments, word))
    return found


@dataclass(slots=True)
class _Frame:
    """What a subroutine has for itself: #1 to #30, its named parameters, and where it was called from."""

    numbered: dict[int, float] = field(default_factory=dict)
    named: dict[str, float] = field(default_factory=dict)
    back: int = 0
    left: int = 0
    begins: int = 0


@dataclass(slots=True)
class _Run:
    """One run through the program; rows that set a name of `kept` stay. `at` is the row that comes next."""

    sources: list[_Source]
    kept: frozenset[str]
    at: int = 0
    steps: int = 0
    numbered: dict[int, float] = field(default_factory=dict)
    common: dict[str, float] = field(default_factory=dict)
    frames: list[_Frame] = field(default_factory=lambda: [_Frame()])
    repeats: dict[int, int] = field(default_factory=dict)
    """The loops that are going on: by the number of the row that begins them, the turns that are left."""

    def rows(self) -> Iterator[UnfoldedRow]:
        """See `unfold`."""
        while self.at < len(self.sources):
            self.steps += 1
            source = self.sources[self.at]
            if self.steps > MOST_ROWS:
                raise _wrong(source, f"the program has not ended after {MOST_ROWS} steps: not supported here")
            self.at += 1
            if source.word is not None and source.word[1]:
                self._control_flow(source, *source.word)
            elif source.word is not None:
                if source.word[2]:
                    raise _wrong(source, f"cannot read '{source.code}': expected an o word such as sub, call or repeat")
                if self._is_subprogram(self.at - 1):
                    return  # the main program has run into the subprograms behind it
                yield UnfoldedRow(source.text, source.line)
            elif _M98.search(source.code):
                self._m98(source)
            elif _M99.search(source.code):
                if len(self.frames) == 1:
                    return
                self._m99()
            else:
                yield from self._plain(source)
                if _END.search(source.code) or (source.code == "%" and self.at > 1):
                    if source.code != "%" and self.sources[0].code == "%":
                        yield UnfoldedRow("%", source.line)  # subprograms behind the end are left out, its frame is not
                    return

    # plain rows

    def _plain(self, source: _Source) -> Iterator[UnfoldedRow]:
        code = source.code
        if "#" not in code and "[" not in code:
            yield UnfoldedRow(source.text, source.line)
            return
        words, sets, kept = [], list[tuple[str, float]](), False
        reader = ExpressionReader(code, source.line, self)
        while reader.at < len(code):
            if reader.code[reader.at] == "#":
                name = reader.name()
                if not reader.take("="):
                    raise _wrong(source, f"cannot read '{code}': expected = behind #{name}")
                value = reader.value()
                sets.append((name, value))
                kept = kept or name.strip("<>").lower() in self.kept
                continue
            letter = reader.letter()
            if letter == "F" and (found := _PLAIN_NAME.match(code, reader.at)):
                reader.at = found.end()
                words.append("F#<_hal[plasmac.cut-feed-rate]>")
            else:
                words.append(f"{letter}{_spelt(reader.value())}")
        for name, value in sets:
            self._set(name, value, source)
        if kept and not words:
            yield UnfoldedRow(" ".join(f"#{name.lower()}={_spelt(value)}" for name, value in sets), source.line)
        elif words or source.comments:
            yield UnfoldedRow(" ".join([*words, *filter(None, [source.comments])]), source.line)

    # parameters

    def get(self, name: str, line: int) -> float:
        """The value of a parameter: by its number, or its name in < >."""
        if name.startswith("<"):
            key = name[1:-1].lower()
            held = self.common if key.startswith("_") else self.frames[-1].named
            if key not in held:
                where = "it hangs on the machine" if key.startswith("_") else "nothing has set it"
                raise _wrong(line, f"#{name.lower()} is not known here, {where}: give the program with its value")
            return held[key]
        number = int(name)
        if number > _KEPT_BY_MACHINE:
            raise _wrong(line, f"#{number} is kept by the machine (offsets, probe): give the program its value")
        held_here = self.frames[-1].numbered if number <= 30 and len(self.frames) > 1 else self.numbered
        return held_here.get(number, 0.0)

    def knows(self, name: str) -> bool:
        """Whether a named parameter exists."""
        key = name[1:-1].lower()
        return key in (self.common if key.startswith("_") else self.frames[-1].named)

    def _set(self, name: str, value: float, source: _Source) -> None:
        if name.startswith("<"):
            key = name[1:-1].lower()
            (self.common if key.startswith("_") else self.frames[-1].named)[key] = value
            return
        number = int(name)
        if number > _KEPT_BY_MACHINE:
            raise _wrong(source, f"#{number} is kept by the machine: a program that changes it is not supported here")
        held = self.frames[-1].numbered if number <= 30 and len(self.frames) > 1 else self.numbered
        held[number] = value

    # loops, branches and subroutines

    def _control_flow(self, source: _Source, name: str, what: str, rest: str) -> None:
        here = self.at - 1
        match what:
            case "SUB":
                self.at = self._partner(here, name, ("ENDSUB",)) + 1
            case "CALL":
                self._call(source, name, rest)
            case "RETURN" | "ENDSUB":
                if len(self.frames) == 1:
                    raise _wrong(source, f"o{name.lower()} {what.lower()} outside its subroutine")
                value = self._values(source, rest)
                self.common |= {"_value": value[0] if value else 0.0, "_value_returned": float(bool(value))}
                self.at = self.frames.pop().back
            case "IF":
                if not self._true(source, rest):
                    self.at = self._else(here, name)
            case "ELSEIF" | "ELSE":  # the branch before it was taken
                self.at = self._partner(here, name, ("ENDIF",)) + 1
            case "ENDIF" | "DO":
                pass
            case "WHILE":
                self._while(source, here, name, rest)
            case "ENDWHILE":
                self.at = self._before(here, name, ("WHILE",))
            case "REPEAT":
                turns = round(self._values(source, rest)[0]) if rest else 0
                self.repeats[here] = turns
                if turns <= 0:
                    self.at = self._partner(here, name, ("ENDREPEAT",)) + 1
            case "ENDREPEAT":
                begins = self._before(here, name, ("REPEAT",))
                self.repeats[begins] = self.repeats.get(begins, 1) - 1
                if self.repeats[begins] > 0:
                    self.at = begins + 1
            case "BREAK" | "CONTINUE":
                self._leave(source, here, name, what)
            case _:
                raise _wrong(source, f"'{source.code}': o{name.lower()} {what.lower()} is not known here")

    def _else(self, here: int, name: str) -> int:
        """Where a branch that is not taken goes on: at the next elseif, behind else, or behind its end."""
        at = self._partner(here, name, ("ELSEIF", "ELSE", "ENDIF"))
        word = self.sources[at].word
        assert word is not None
        if word[1] != "ELSEIF":
            return at + 1
        return at + 1 if self._true(self.sources[at], word[2]) else self._else(at, name)

    def _while(self, source: _Source, here: int, name: str, rest: str) -> None:
        """`while` begins its loop, or ends that of a `do` before it."""
        begins = self._do(here, name)
        if begins is not None:
            if self._true(source, rest):
                self.at = begins + 1
        elif not self._true(source, rest):
            self.at = self._partner(here, name, ("ENDWHILE",)) + 1

    def _do(self, here: int, name: str) -> int | None:
        for at in range(here - 1, -1, -1):
            word = self.sources[at].word
            if word is not None and word[0] == name:
                return at if word[1] == "DO" else None if word[1] in ("WHILE", "ENDWHILE") else self._do(at, name)
        return None

    def _leave(self, source: _Source, here: int, name: str, what: str) -> None:
        loops = ("WHILE", "DO", "REPEAT")
        words = ((at, self.sources[at].word) for at in range(here - 1, -1, -1))
        begins = next((at for at, w in words if w is not None and w[0] == name and w[1] in loops), None)
        if begins is None:
            raise _wrong(source, f"o{name.lower()} {what.lower()} outside its loop")
        word = self.sources[begins].word
        assert word is not None
        ends = {"WHILE": "ENDWHILE", "DO": "WHILE", "REPEAT": "ENDREPEAT"}[word[1]]
        end = self._partner(here, name, (ends,))
        self.at = end + 1 if what == "BREAK" else end

    def _partner(self, here: int, name: str, what: tuple[str, ...]) -> int:
        for at in range(here + 1, len(self.sources)):
            word = self.sources[at].word
            if word is not None and word[0] == name and word[1] in what:
                return at
        raise _wrong(self.sources[here], f"o{name.lower()}: there is no {' or '.join(what).lower()} for it")

    def _before(self, here: int, name: str, what: tuple[str, ...]) -> int:
        for at in range(here - 1, -1, -1):
            word = self.sources[at].word
            if word is not None and word[0] == name and word[1] in what:
                return at
        raise _wrong(self.sources[here], f"o{name.lower()}: there is no {' or '.join(what).lower()} before it")

    def _call(self, source: _Source, name: str, rest: str) -> None:
        begins = next((k for k, s in enumerate(self.sources) if s.word and s.word[:2] == (name, "SUB")), None)
        if begins is None:
            raise _wrong(
                source,
                f"o{name.lower()} is no subroutine of this program: it stands in a file of its own on the machine; "
                "give the program with it",
            )
        values = self._values(source, rest)
        self._enter(source, _Frame(dict(enumerate([*values, *[0.0] * (30 - len(values))], 1)), {}, self.at), begins + 1)

    def _enter(self, source: _Source, frame: _Frame, at: int) -> None:
        if len(self.frames) > _MOST_DEPTH:
            raise _wrong(source, f"subroutines call each other more than {_MOST_DEPTH} deep: not supported here")
        self.frames.append(frame)
        self.at = at

    def _is_subprogram(self, at: int) -> bool:
        """Whether a bare O number names a subprogram that ends in M99, behind the end of the main one."""
        return at > 0 and any(_END.search(s.code) for s in self.sources[:at]) and len(self.frames) == 1

    def _m98(self, source: _Source) -> None:
        found = re.search(r"P([0-9]+)", source.code)
        if found is None:
            raise _wrong(source, "M98 without P: expected the number of the subprogram")
        times = int(turns[1]) if (turns := re.search(r"L([0-9]+)", source.code)) else 1
        begins = self._subprogram(found[1])
        if begins is None and len(found[1]) > 4 and (begins := self._subprogram(found[1][-4:])) is not None:
            times = int(found[1][:-4])  # P51000: five times O1000
        if begins is None:
            raise _wrong(source, f"O{found[1]} is no subprogram of this program: give the program with it")
        if times > 0:
            frame = _Frame(dict(self.frames[-1].numbered), dict(self.frames[-1].named), self.at, times - 1, begins + 1)
            self._enter(source, frame, begins + 1)

    def _subprogram(self, number: str) -> int | None:
        of = (k for k, s in enumerate(self.sources) if s.word and s.word[1] == "" and _same_number(s.word[0], number))
        return next(of, None)

    def _m99(self) -> None:
        frame = self.frames[-1]
        if frame.left > 0:
            frame.left -= 1
            self.at = frame.begins
        else:
            self.frames.pop()
            self.at = frame.back

    def _true(self, source: _Source, rest: str) -> bool:
        values = self._values(source, rest)
        if len(values) != 1:
            raise _wrong(source, f"cannot read '{source.code}': expected one condition in [ ]")
        return values[0] != 0.0

    def _values(self, source: _Source, rest: str) -> list[float]:
        reader, values = ExpressionReader(rest, source.line, self), []
        while reader.at < len(rest):
            values.append(reader.value())
        return values


def _same_number(name: str, number: str) -> bool:
    return name.isdigit() and int(name) == int(number)


def _spelt(value: float) -> str:
    text = f"{value:.7f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def _wrong(at: _Source | int, message: str) -> InputError:
    return InputError(message, line=at if isinstance(at, int) else at.line)
