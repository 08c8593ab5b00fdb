"""Cases in folders: a file `case.json` that says what they are, and beside it their files."""

from __future__ import annotations

import json
from pathlib import Path

from kerfwise.tests.fuzz.inputs.case import Case

from .worker import Report

ABOUT = "case.json"


def keep(report: Report, folder: Path) -> None:
    """Write a case, and what was found, into a folder."""
    case = report.case
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in case.files.items():
        if content is None:
            (folder / name).mkdir(exist_ok=True)
        else:
            (folder / name).write_bytes(content)
    about = {
        "kind": case.kind,
        "words": case.words,
        "damaged": case.damaged,
        "written": case.written,
        "findings": report.findings,
    }
    (folder / ABOUT).write_text(json.dumps(about, indent=1) + "\n", encoding="utf-8")


def kept(folder: Path) -> Case:
    """The case of a folder."""
    about = json.loads((folder / ABOUT).read_text(encoding="utf-8"))
    files = {
        path.name: path.read_bytes() if path.is_file() else None for path in folder.iterdir() if path.name != ABOUT
    }
    return Case(about["kind"], files, tuple(about["words"]), tuple(about["damaged"]), tuple(about.get("written", ())))
