"""The pictures of docs/rules.md: of each rule of the catalogue a case that is wrong and one that is right.

`python -m kerfwise.tests.docs.rule_pictures docs/rule-pictures` writes them anew.
"""

from __future__ import annotations

import sys
from pathlib import Path

import kerfwise
from kerfwise.postproc.output_files import write_files
from kerfwise.postproc.report.rule_pictures import case_picture, rule_panels
from kerfwise.rules.registry import RULES
from kerfwise.rules.run_cases import cases_of

FOLDER = Path(kerfwise.__file__).parent / "docs" / "rule-pictures"


def pictures(folder: Path = FOLDER) -> dict[Path, str]:
    """All of them, by file."""
    return {folder / f"{rule}.svg": case_picture([*rule_panels(cases_of(rule)).values()]) for rule in RULES}


if __name__ == "__main__":
    write_files(pictures(Path(sys.argv[1])))
