"""The smallest case that still shows what a case shows."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

from kerfwise.tests.fuzz.inputs.case import Case
from kerfwise.tests.fuzz.shrink import fewest

from .worker import Report

MOST_S = 90.0
"""No longer is looked for a smaller one."""


def what(report: Report) -> frozenset[str]:
    """The findings without what differs from case to case: their kind, and their place in the code."""
    return frozenset(
        text if text.startswith("at: ") else text.split(":")[0] for text in report.findings if "apart" not in text
    ) or frozenset(["apart"])


def smaller(report: Report, ask: Callable[[Case], Report], most_s: float = MOST_S) -> Report:
    """The report of the smallest case found by leaving out lines, then bytes, of what was damaged; else words."""
    until_s, sought, best = time.monotonic() + most_s, what(report), report

    def shows(case: Case) -> bool:
        nonlocal best
        if time.monotonic() > until_s:
            return False
        found = ask(case)
        if sought <= what(found):
            best = found
            return True
        return False

    for name in report.case.damaged:
        content = report.case.files[name]
        assert content is not None
        for split in (_lines, _bytes):
            pieces = split(best.case.files[name] or b"")
            if len(pieces) > (400 if split is _bytes else 20_000):
                continue
            fewest(pieces, lambda left, name=name: shows(_with(best.case, name, b"".join(left))))  # type: ignore[misc]
    words = list(report.case.words)
    first = 2 if not report.case.damaged else len(words)
    fewest(words[first:], lambda left: shows(replace(best.case, words=(*words[:first], *left))))
    for name in tuple(best.case.files):
        if name not in report.case.damaged and name not in best.case.words:
            shows(replace(best.case, files={n: c for n, c in best.case.files.items() if n != name}))
    return best


def _with(case: Case, name: str, content: bytes) -> Case:
    return replace(case, files={**case.files, name: content})


def _lines(data: bytes) -> list[bytes]:
    return data.splitlines(keepends=True)


def _bytes(data: bytes) -> list[bytes]:
    return [bytes([byte]) for byte in data]
