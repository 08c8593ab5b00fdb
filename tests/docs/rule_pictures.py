"""The pictures of docs/rules.md: of each rule of the catalogue a case that is wrong and one that is right.

`python -m kerfwise.tests.docs.rule_pictures` writes them anew.
"""

from __future__ import annotations

from pathlib import Path

import kerfwise
from kerfwise.postproc.files import write_files
from kerfwise.postproc.report.case_picture import case_picture, rule_panels
from kerfwise.rules.registry import RULES
from kerfwise.rules.run_cases import cases_of

FOLDER = Path(kerfwise.__file__).parent / "docs" / "rules"


def pictures() -> dict[Path, str]:
    """All of them, by file."""
    return {FOLDER / f"{rule}.svg": case_picture([*rule_panels(cases_of(rule)).values()]) for rule in RULES}


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    write_files(pictures())
