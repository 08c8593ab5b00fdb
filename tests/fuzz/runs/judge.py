"""What is wrong with how a case ended."""

from __future__ import annotations

import io
import json
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import PurePath
from unicodedata import category

from kerfwise.encoder.escape import OBEYED, escape_text
from kerfwise.tests.fuzz.inputs.case import Case

from .run import Ended

OWN_FAULT, WRONG_INPUT, OPEN_QUESTION = 70, 2, 3
CODES = (0, 1, WRONG_INPUT, OPEN_QUESTION)
DRAWN = "what is read so far"
"""A picture of this is the one thing that is written where a question is open."""
_WARNING = re.compile(r"\.py:\d+: \w*Warning|Exception ignored")


def findings(case: Case, ended: Ended) -> list[str]:
    """Each in a line; what it is stands before the colon.

    A case may end with 0, 1 or 2. It changes no file that it was not told to write, leaves nothing half written, and
    prints nothing that a terminal obeys. A refusal (2) is one line, with the file or the word of the command at fault.
    """
    return [*_end(case, ended), *_printed(ended), *_files(case, ended)]


def _end(case: Case, ended: Ended) -> Iterator[str]:
    text = ended.out + ended.err
    if ended.code == OWN_FAULT:
        yield f"own fault: {_line(ended.err)}"
    elif ended.code not in CODES:
        yield f"exit code: {ended.code}, {_line(ended.err)}"
    if "Traceback" in text and ended.code != OWN_FAULT:
        yield f"traceback: {_line(ended.err)}"
    if found := _WARNING.search(text):
        yield f"warning: {_around(text, found.start())}"
    if ended.code == OPEN_QUESTION and "--answer " not in ended.err:
        yield "question: it does not say how to answer"
    if ended.code == 1 and not text.strip():
        yield "silent: exit code 1 without a word"
    if ended.code == WRONG_INPUT:
        yield from _refusal(case, ended)


def _refusal(case: Case, ended: Ended) -> Iterator[str]:
    if ended.err.startswith("Usage: ") and not case.damaged and "Error: " not in ended.err:
        return  # help, where a verb of it is missing
    lines = [line for line in ended.err.splitlines() if line.startswith(("kerfwise: ", "Error: "))]
    if len(lines) != 1:
        yield f"refusal: {len(lines)} lines of it: {_line(ended.err)}"
        return
    if lines[0].startswith("Error: "):
        if case.damaged:
            yield f"refusal: as wrong usage: {lines[0]}"
        return
    words = {
        *case.files,
        *case.words,
        *(PurePath(word).stem for word in case.words),
    }  # outputs are named after the nest
    names = {name for word in words for name in (escape_text(word), repr(word)[1:-1])}
    if not any(name in lines[0] if name.strip() else f"'{name}'" in lines[0] for name in names):
        yield f"refusal: no place: {lines[0]}"


def _printed(ended: Ended) -> Iterator[str]:
    for text in (ended.out, ended.err):
        for character in text:
            if character not in "\n\t" and not " " <= character <= "~" and category(character) in OBEYED:
                yield f"obeyed: {character!r} in what is printed"
                break


def _files(case: Case, ended: Ended) -> Iterator[str]:
    given = {name: content for name, content in case.files.items() if content is not None}
    for name, content in given.items():
        if name not in case.written and ended.files.get(name) != content:
            yield f"lost: {name} is not as it was"
    new = {n: c for n, c in ended.files.items() if given.get(n) != c and not n.startswith("kerfwise-fault-")}
    drawn = {name for name in new if f"note: written: {name}: {DRAWN}" in ended.err and ended.code == OPEN_QUESTION}
    if ended.code in (WRONG_INPUT, OPEN_QUESTION) and (written := sorted(set(new) - drawn)):
        yield f"refused and written: {written}"
    for name, content in new.items():
        kinds = (name,) if case.damaged else (name, "a.nc", "a.json", "a.svg")  # -o out.svg writes a program there
        if all(unfinished(kind, content) for kind in kinds):
            yield f"half written: {name}: {unfinished(name, content)}"


def unfinished(name: str, content: bytes) -> str:
    """Why a file is not a whole one of its kind; "" if it is.

    Examples
    --------
    >>> unfinished("a.json", b'{"a": ')
    'not whole: Expecting value'
    >>> unfinished("a.svg", b"<svg></svg>")
    ''
    """
    if ".kerfwise-" in name:
        return "is of the way of writing"
    suffix = name.lower().rpartition(".")[2]
    try:
        if suffix == "png":
            return "" if content.startswith(b"\x89PNG") and content[-8:-4] == b"IEND" else "not whole"
        if suffix == "pdf":
            return "" if content.startswith(b"%PDF-") and content.rstrip().endswith(b"%%EOF") else "not whole"
        text = content.decode("utf-8")
        if suffix == "json":
            json.loads(text)
        elif suffix == "svg":
            ElementTree.parse(io.BytesIO(content))
        elif (suffix == "html" and not text.rstrip().endswith("</html>")) or (
            suffix in ("nc", "ngc", "dzn") and not text.endswith("\n")
        ):
            return "not whole"
    except (ValueError, ElementTree.ParseError) as error:
        return f"not whole: {str(error).partition(':')[0]}"
    obeyed = [c for c in set(text) if c not in "\n\t" and category(c) in OBEYED]
    return f"holds {obeyed[0]!r}, which is obeyed" if obeyed else ""


TOLD_BY_A_CLOCK = ("bench", "--time-limit")
"""Words with which outputs have seconds in them."""


def differences(case: Case, one: Ended, other: Ended) -> list[str]:
    """What is not the same of a case that ran twice; the same bytes are promised where no clock decides or is told."""
    if OWN_FAULT in (one.code, other.code) or any(word in TOLD_BY_A_CLOCK for word in case.words):
        return []
    found = []
    if one.code != other.code:
        found.append(f"not the same twice: exit code {one.code} and {other.code}")
    for what, a, b in (("standard output", one.out, other.out), ("standard error", one.err, other.err)):
        if a != b:
            found.append(f"not the same twice: {what}: {_first_difference(a, b)}")
    for name in sorted({*one.files, *other.files}):
        if one.files.get(name) != other.files.get(name):
            found.append(f"not the same twice: {name}")
    return found


def _first_difference(a: str, b: str) -> str:
    for one, other in zip(a.splitlines(), b.splitlines(), strict=False):
        if one != other:
            return f"{one[:150]!r} and {other[:150]!r}"
    return f"{len(a.splitlines())} and {len(b.splitlines())} lines"


def _line(text: str) -> str:
    return (text.strip().splitlines() or [""])[-1][:300]


def _around(text: str, at: int) -> str:
    begin = text.rfind("\n", 0, at) + 1
    return text[begin : at + 200].splitlines()[0]
