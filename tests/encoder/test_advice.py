"""Every message of the readers and the encoder that names an option is provoked, and what it advises is done.

Each row of `ADVICE` has the words by which the message is found in the source. `test_no_message_is_forgotten` looks for
strings in the source that name an option: each must be in a row, or among `FACTS`, which advise nothing.
"""

from __future__ import annotations

import ast
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

from kerfwise.tests.commands.run_cli import Ended, kerfwise
from kerfwise.tests.encoder.advice import ADVICE, BOW_TIE, GAP, STRAY, A, Advice, Words, Write, drawn, dxf, part, parts
from kerfwise.tests.encoder.changes import CHANGES
from kerfwise.tests.encoder.readers.drawings import lines, square

ENCODER = Path(__file__).parents[2] / "encoder"
OPTION = re.compile(
    r"--[a-z]|drawing\.|drawing: ?\{|cuts\.|small_holes\.|rules\.\w|layers\.|in Python|corners\.|leads\.|machine\.|"
    r"IN_PROFILE|REPAIR|WRONG_UNITS|setting\(|as_part"
)
"""What names an option in a string of the source."""

CHANGE = re.compile(
    r"\b(save|release|move|give|draw|correct|mend|remove|shorten|widen|turn|export|explode|delete) "
    r"(it|them|the|each|a)\b|leave one|in CAD|plain SVG|\b(let|keep|make|end|lead|begin) (it|them|one)\b|as DXF|"
    r"_PROGRAM|did you mean|expected outer|goes from one place"
)
"""What asks for a change of the file."""

FACTS = {
    "the head would turn more than cuts.bevel.most_turn": "what the plant says of its head; nothing is advised",
    "by the profile (drawing.layers.": "why a layer is taken for what it is",
    "left out, as drawing.layers.ignore matches their layers": "what was left out, and why",
    "as given (--": "who has said it",
    "of the size of --sheet (in Python sheet_mm=)": "why it is the sheet",
    "marked, not cut (drawing.open_lines)": "what became of open lines, and why",
    "left out (drawing.open_lines)": "what became of open lines, and why",
    "shorter than drawing.join_tolerance, and therefore left out": "what became of a crumb, and why",
    "if the units are wrong, pass --units": "the words themselves, as other messages have them",
    "more than 10,000 kilometres from the origin": "the advice of units again, tried where a line is too long",
    "it is UTF-16: save it as UTF-8": "no option; followed in tests/encoder/readers/test_json_nest.py",
    "is not a regular expression": "the profile's reader gives it a place",
    "--answer {answer}": "the flag of a choice: each is tried by test_each_flag_of_a_question_gives_what_it_says",
    '--answer "{answer}"': "likewise",
    "--answer ": "cut off where the flag is told as data",
    "Answers are kept in": "tried in tests/commands/test_read.py",
    "--repair (in Python: repair=True)": "the word itself, as other messages have it",
    "drawing: {{layers: {{{purpose}": "the setting itself, as other messages have it",
    "where they touch one cut makes both": "what an accepted loss is",
    "mm at each side (cuts.narrow: slit)": "what a slit costs, and why",
    "(small_holes.under: {limits.under})": "what became of a small hole, and why",
    "less than small_holes.min_hole, ": "why a hole is too small; the remedies are told beside it",
    "under small_holes.min_hole": "why a hole is too small, in the question small-holes",
    "saves a rectangle of a rectangular sheet": "nothing is advised",
    "leaves nothing to save": "nothing is advised",
    "no lead from {IN_PROFILE": "why there is no lead; the remedies are told beside it",
    "without a lead the pierce lies": "why there is no lead; the remedies are told beside it",
    "no room for tabs ({IN_PROFILE": "the head of a list",
    "leads.entries must be at least": "a profile's reader refuses it before, with its place",
    "must be more than 0 mm, not": "a profile's reader refuses it before, with its place",
    "is more than {IN_PROFILE['lead_in_mm']}": "a profile's reader refuses it before, with its place",
    "does not bring the pierce": "a profile's reader refuses it before, with its place",
    "shorten {IN_PROFILE['lead_in_mm']}": "tried in tests/encoder/candidates/test_common_edges.py",
    "say cuts.common.shortest: off": "only after a stop within a group that is cut with common edges",
    "those named with --also": "an option of kerfwise serve, tried in tests/apps/viewer/serve/test_hostile.py",
    "opens {": "half of the sentence of cuts.narrow, tried there",
    "more often than once on one side": "the other half of the sentence about a bridge that misses an outline",
    "to one that can be cut: draw it elsewhere": "no bridge is known that comes so far",
    "often called OVERKILL": "takes thousands of lines",
    "give them one zone": "tried in tests/encoder/facts/test_zones.py",
    "a key is given twice: leave one of them": "with its place it is tried",
    "did you mean": "a word to type instead: tried where it is told",
    "does not meet the outline of": "the same of one that is too short",
    "each but the last would cost a pierce": "tried in tests/commands/test_tabs.py",
    "draw each part by a closed line": "only where lines were closed that nobody asked to",
    "any more: draw it anew": "an edge with a bevel of its own is gone; such bevels are tried in tests/commands",
    "is damaged ({error})": "libraries' own errors on damaged files",
    "close the line in CAD": "the first of several remedies, tried with them",
}
"""Strings that name an option and advise nothing, or whose advice is tried elsewhere, and why."""


def _ran(row: Advice, folder: Path, file: Write | None, words: Words) -> Ended:
    nest = (file or row.file)(folder)
    out = ["-o", str(folder / "facts.json")] if row.verb == "facts" else []
    out = ["-o", str(folder / "out.nc"), "--work", "0.05"] if row.verb == "solve" else out
    profile = [] if "-p" in words else ["-p", "plasma-carbon-steel"]
    return kerfwise(row.verb, nest, "--no-job", *profile, *words, *out)


FULL = [pytest.param(row, marks=pytest.mark.full) if row.verb == "facts" else row for row in CHANGES]


@pytest.mark.parametrize("row", [*ADVICE, *FULL], ids=lambda row: row.source[:40])
def test_what_is_advised_helps(row: Advice, tmp_path: Path) -> None:
    before = _ran(row, tmp_path, None, row.words)
    said = before.out + before.err
    assert re.search(row.said, said), said
    for do in row.does:
        assert do.advised in said, said
        after = _ran(row, tmp_path, do.file, do.words)
        told = after.out + after.err
        assert not re.search(row.said, told), told
        assert do.shows in told
        assert after.code == do.code, told


def _strings() -> Iterator[tuple[str, str]]:
    """Every string in the source that names an option, docstrings left out: where it stands, and its text."""
    for file in sorted(ENCODER.rglob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        texts = {id(n.value) for n in ast.walk(tree) if isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant)}
        for node in ast.walk(tree):
            if isinstance(node, ast.JoinedStr):
                texts |= {id(inner) for inner in ast.walk(node) if inner is not node}
        for node in ast.walk(tree):
            if id(node) in texts or not isinstance(node, ast.JoinedStr | ast.Constant):
                continue
            if isinstance(node, ast.Constant) and not isinstance(node.value, str):
                continue
            text = ast.unparse(node)
            if (OPTION.search(text) or CHANGE.search(text)) and " " in text:
                yield f"{file.name}:{node.lineno}", text


def test_no_message_is_forgotten() -> None:
    known = [row.source for row in (*ADVICE, *CHANGES)] + list(FACTS)
    found = list(_strings())
    forgotten = [f"{where}: {text}" for where, text in found if not any(words in text for words in known)]
    assert forgotten == []
    gone = [words for words in known if not any(words in text for _, text in found)]
    assert gone == []


ASKING = [
    drawn(STRAY),
    drawn(GAP),
    dxf(lambda space: [lines(space, square(0, 0, 200)), lines(space, square(10, 10, 50))]),
    drawn(([(60, 20), (100, 20), (100, 50), (60, 50)], "0", False)),
    drawn(([(10, 30), (60, 30)], "a layer of lines", False)),
    parts(A, part("B", BOW_TIE)),
]


@pytest.mark.parametrize("k", range(len(ASKING)))
def test_each_flag_of_a_question_gives_what_it_says(k: int, tmp_path: Path) -> None:
    nest = ASKING[k](tmp_path)
    asked = kerfwise("read", nest, "--no-job")
    assert asked.code == 3, asked.err
    rows = re.findall(r"^ +(--answer .+?)   +(.+)$", asked.err, re.MULTILINE)
    assert rows
    first = {flag.partition("=")[0]: flag for flag, _ in reversed(rows)}
    for flag, told in rows:
        words = [word for other in (flag, *(f for q, f in first.items() if q != flag.partition("=")[0]))
                 for word in shlex.split(other)]  # fmt: skip
        ended = kerfwise("read", nest, "--no-job", *words)
        assert ended.code in ((2,) if "it could not be cut" in told else (0, 3)), (flag, ended.err)
        assert flag not in ended.err  # where others are asked then, this one is answered
