"""Runs the command line in this process and says how it ended."""

from __future__ import annotations

import contextlib
import io
from dataclasses import dataclass

from kerfwise.cli import main


@dataclass(frozen=True)
class Ended:
    """Exit code and what was printed."""

    code: int
    out: str
    err: str


def kerfwise(*argv: object) -> Ended:
    """`kerfwise ARGV…`."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main([str(a) for a in argv])
        except SystemExit as end:
            code = end.code
    assert isinstance(code, int)
    return Ended(code, out.getvalue(), err.getvalue())
