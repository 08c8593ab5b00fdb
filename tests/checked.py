"""The check of a program that a test has as text."""

from __future__ import annotations

import tempfile
from pathlib import Path

import kerfwise
from kerfwise import CheckResult, Nest, Plan, Profile


def checked(
    nest: Nest, program: str, profile: Profile | str | Path | None = None, plan: Plan | None = None
) -> CheckResult:
    """What `kerfwise.check` says of the program, and of the plan that it has to follow."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "program.nc")
        path.write_text(program, encoding="utf-8")
        return kerfwise.check(nest, path, profile, plan)
