"""What comes with kerfwise, by name."""

from __future__ import annotations

import re

import kerfwise
from kerfwise.tests.commands.run_cli import kerfwise as command_line


def _profiles() -> list[str]:
    try:
        kerfwise.load_profile("no such profile")
    except kerfwise.InputError as error:
        (names,) = re.findall(r"\(valid: (.*)\)", str(error))
        return list(names.split(", "))
    raise AssertionError("a profile of that name comes with kerfwise")


PROFILES = _profiles()
DIALECTS = [line.split()[0] for line in command_line("dialects").out.splitlines() if line and line[0].isalpha()]
