"""What lists controls and dialects is complete: a name that one place forgets is told, with the place."""

from __future__ import annotations

from typing import get_args

from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.dialects import ControlName, dialect_names
from kerfwise.rules.options.option import options_of
from kerfwise.rules.profile.plant_sections import DialectName, Machine


def test_dialects_may_name_each_control_that_the_check_reads() -> None:
    missing, unread = set(CONTROLS) - set(get_args(ControlName)), set(get_args(ControlName)) - set(CONTROLS)
    assert not missing, f"postproc/dialects/dialect.py, ControlName: {missing}"
    assert not unread, f"postproc/check/reader/controls.py, CONTROLS: {unread}"


def test_profiles_may_name_each_dialect() -> None:
    (kind,) = (option.kind for option in options_of(Machine) if option.name == "dialect")
    assert isinstance(kind, DialectName)
    missing, gone = set(dialect_names()) - set(kind.words), set(kind.words) - set(dialect_names())
    assert not missing, f"rules/profile/plant_sections.py, Machine.dialect: {missing}"
    assert not gone, f"rules/profile/plant_sections.py names what postproc/dialects has not: {gone}"
