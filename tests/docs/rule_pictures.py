"""The pictures of docs/rules.md: of each rule of the catalogue a case that is wrong and one that is right.

`python -m kerfwise.tests.docs.rule_pictures` writes them anew, each into the folder of its rule.
"""

from __future__ import annotations

from pathlib import Path

import kerfwise
from kerfwise.postproc.output_files import write_files
from kerfwise.postproc.report.rule_pictures import case_picture, rule_panels
from kerfwise.rules.registry import RULES
from kerfwise.rules.run_cases import cases_of

FOLDER = Path(kerfwise.__file__).parent / "rules" / "catalogue"


def pictures(folder: Path = FOLDER) -> dict[Path, str]:
    """All of them, by file."""
    places = {rule: folder / rule.replace("-", "_") / "picture.svg" for rule in RULES}
    return {place: case_picture([*rule_panels(cases_of(rule)).values()]) for rule, place in places.items()}


if __name__ == "__main__":
    write_files(pictures())
