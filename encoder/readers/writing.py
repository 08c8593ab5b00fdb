"""Writing in a drawing is no line: it is neither cut nor marked, and that is said."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise.encoder.nest import Note

from .layers import Purpose

FIRST = 3
LONGEST = 24


def writing_note(texts: Sequence[str], layer: str, purpose: Purpose | None) -> Note:
    """How many texts are on a layer and what the first ones say.

    Examples
    --------
    >>> writing_note(["A-101", "A-102"], "Gravur", "mark").text
    "2 texts on layer 'Gravur' are not marked ('A-101', 'A-102'): turn writing into lines in CAD to have it marked"
    """
    what = "1 text" if len(texts) == 1 else f"{len(texts)} texts"
    verb = "is" if len(texts) == 1 else "are"
    shown = [_short(t) for t in texts if t.strip()][:FIRST]
    quoted = f" ({', '.join(shown)}{', …' if len(texts) > len(shown) else ''})" if shown else ""
    if purpose == "mark":
        advice = "not marked", ": turn writing into lines in CAD to have it marked"
    else:
        advice = "left out", ""
    return Note("warning", f"{what} on layer '{layer}' {verb} {advice[0]}{quoted}{advice[1]}")


def _short(text: str) -> str:
    line = " ".join(text.split())
    return f"'{line}'" if len(line) <= LONGEST else f"'{line[: LONGEST - 1]}…'"
