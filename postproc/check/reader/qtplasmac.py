"""QtPlasmaC: what its filter makes of a program before it runs, and its words for material, tool and speed."""

from __future__ import annotations

import re
from dataclasses import dataclass

from kerfwise.encoder.errors import InputError

from .controls import Row
from .program import Track

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

        Raises InputError with line and column, for a row that the filter would change, or obey.
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
