"""All words of an old program that nobody here knows, each with its line, its count, and what would settle it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from kerfwise.encoder.errors import InputError

from .controls import COMMENT, Control, Row, row_of, rows_of
from .grammar import refused_g
from .old_words import OldWords
from .rs274 import Machine, comment_of_form
from .words import BOUNDS, NOT_READ

_TOKEN = re.compile(r"(?P<letter>[A-Z$#@^=])(?P<number>[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))?")
_MOST_NAMED = 6


@dataclass(slots=True)
class UnknownWord:
    """A word, the line where it stands first, how often it stands, and what to do about it."""

    word: str
    line: int
    settles: str
    count: int = 1

    def __str__(self) -> str:
        times = "once" if self.count == 1 else f"{self.count} times"
        return f"line {self.line}: {self.word} ({times}): {self.settles}"


def unknown_words(text: str, control: Control) -> list[UnknownWord]:
    """The words of a program that are not known for a control, in the order in which they come first."""
    found: dict[str, UnknownWord] = {}
    machine, further = Machine(1.0, control, (0.0, 0.0), (0.0, 0.0)), OldWords(control, 1000.0)
    for line, raw in rows_of(text, control.longest, control.obeyed):
        for word, settles in _of_row(raw, line, control, machine, further):
            if word in found:
                found[word].count += 1
            else:
                found[word] = UnknownWord(word, line, settles)
    return list(found.values())


def _of_row(raw: str, line: int, control: Control, machine: Machine, further: OldWords) -> Sequence[tuple[str, str]]:
    try:
        row = comment_of_form(raw, control) or row_of(raw, line, control.opens)
        row = machine.without_own(row, line) if control.has_own_words else row
    except InputError:
        return []
    before = row
    try:
        row = further.plain(row, line, machine.moves)
    except InputError:
        row = before
    return [] if row.code == "%" else _words(row, control)


def _words(row: Row, control: Control) -> list[tuple[str, str]]:
    """The unknown words of a row, and what settles each."""
    pairs = []
    code = re.sub(r"^N[0-9.]+", "", row.code.replace(COMMENT, ""))
    for found in _TOKEN.finditer(code):
        letter, number = found["letter"], found["number"]
        if letter in "GM":
            value = float(number or -1)
            known = control.known_g if letter == "G" else control.known_m
            if value in known:
                continue
            why = refused_g(value) if letter == "G" else control.refused_m.get(value)
            pairs.append((found[0], why or _advice(found[0])))
        elif letter not in BOUNDS and letter != "N":
            pairs.append((f"{letter}…", NOT_READ.get(letter) or _advice(f"{letter}{{n}}")))
    return pairs


def _advice(word: str) -> str:
    return (
        f"if it touches neither the path nor the torch, name it in the dialect, also: ['{word}']; if it is the "
        f"control's own word for one that is known, reads: {{means: {{{word}: …}}}}; else post the program without"
    )


def told_together(error: InputError, text: str, control: Control, lines: Sequence[int]) -> InputError:
    """The error that a program is refused with; one of an unknown word tells all that are.

    `lines` are those of the program that the rows of `text` stand for, none where they are the same.
    """
    try:
        words = unknown_words(text, control)
    except InputError:
        return error
    if error.line not in [word.line for word in words]:
        return error
    for word in words:
        word.line = lines[word.line - 1] if lines else word.line
    names = ", ".join(word.word for word in words[:_MOST_NAMED]) + (", …" if len(words) > _MOST_NAMED else "")
    times = sum(word.count for word in words)
    what = "1 word is" if len(words) == 1 else f"{len(words)} words are"
    message = (
        f"{what} not known in a program for {control.title}, the control of the profile's dialect, and not supported "
        f"here ({names}; {times} in all): {error.message}"
    )
    details = tuple(map(str, words)) if len(words) > 1 else ()
    return InputError(message, file=error.file, line=error.line, column=error.column, details=details)
