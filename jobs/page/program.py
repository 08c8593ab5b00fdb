"""A program's text, and which of its lines the torch is at."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.postproc.clock.timed import read_program
from kerfwise.postproc.report.page_data import Data
from kerfwise.rules.profile.profile import Profile

_COMMENT = re.compile(r"\([^)]*\)|;.*")
_MOVES = re.compile(r"[XYxy]\s*[-+.\d]")


def program_data(text: str, nest: Nest, profile: Profile) -> Data | None:
    """The text, and for each burn, from 0 on, its lines: where it begins, then one for each line or arc of its path.

    Where the lines of a burn cannot be told apart, as in a control's own language, it has the first and the last only.
    None for a program that cannot be read.
    """
    try:
        burns = read_program(text, nest, profile).burns
    except InputError:
        return None
    lines = text.splitlines()
    return {"text": text, "lines": [_lines(burn, after, lines) for burn, after in _with_next(burns, len(lines) + 1)]}


def _with_next(burns: Sequence[Burn], end: int) -> list[tuple[Burn, int]]:
    return [(burn, after) for burn, after in zip(burns, [*(b.line for b in burns[1:]), end], strict=True)]


def _lines(burn: Burn, after: int, lines: Sequence[str]) -> list[int]:
    """Line numbers, from 1."""
    moves = [k for k in range(burn.line, after) if _MOVES.search(_COMMENT.sub("", lines[k - 1]))]
    count = len(burn.path.segments)
    if count and len(moves) >= count and all(a < b for a, b in pairwise(moves)):
        return [burn.line, *moves[:count]]
    return [burn.line, max(burn.line, after - 1)]
