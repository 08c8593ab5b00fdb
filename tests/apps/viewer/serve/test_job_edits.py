"""Changes to a job file leave all else as it is written."""

from __future__ import annotations

import pytest

from kerfwise import InputError
from kerfwise.apps.viewer.serve.job_edits import JobText

BEFORE = """\
profile: laser-wood  # ours
locks:
  # hot
  - {contour: P1.outer, position: last, direction: cw}
  - P2.outer first  # by hand
tabs:
  P3.outer: [[1, 2], [3, 4]]  # two
  P4.outer: off
set: {leads.lead_in: 4 mm}
"""
WITHOUT = {
    "P2.outer first": ("  - P2.outer first  # by hand\n", ""),
    "P1.outer cw": (
        "  - {contour: P1.outer, position: last, direction: cw}\n  - P2.outer first  # by hand\n",
        "  - P2.outer first  # by hand\n  - P1.outer last\n",
    ),
    "P3.outer tab (1, 2)": ("[[1, 2], [3, 4]]", "[[3.0, 4.0]]"),
    "no tab P4.outer": ("  P4.outer: off\n", ""),
}


@pytest.mark.parametrize("line", WITHOUT)
def test_a_lock_is_taken_out(line: str) -> None:
    assert JobText(BEFORE).without_lock(line).text == BEFORE.replace(*WITHOUT[line])


def test_what_is_added_stands_behind_what_is_there() -> None:
    locked = JobText(BEFORE).with_lock("P5.outer first").text
    assert locked == BEFORE.replace("# by hand\n", "# by hand\n  - P5.outer first\n")
    assert JobText(BEFORE).with_lock("P1.outer last").text == BEFORE
    assert JobText(BEFORE).with_profile("plant: b.yaml").text == BEFORE.replace("laser-wood", "'plant: b.yaml'")


def test_values_stay_as_they_are_typed() -> None:
    homed = JobText(BEFORE).with_setting("machine.home", "[0, 0]")
    assert homed.text == BEFORE.replace("{leads", "{machine.home: [0, 0], leads")
    assert homed.without_setting("machine.home").without_setting("leads.lead_in").text == BEFORE.replace(
        "set: {leads.lead_in: 4 mm}\n", ""
    )


@pytest.mark.parametrize("value", ["a: b", "[1,", "# no", "4 mm\n5 mm"])
def test_what_is_no_value_is_refused(value: str) -> None:
    with pytest.raises(InputError, match="is not a value as a job file holds it"):
        JobText(BEFORE).with_setting("leads.lead_in", value)


def test_marks_and_ends_of_lines_of_windows_are_read() -> None:
    text = "\ufeff" + BEFORE.replace("\n", "\r\n")
    assert JobText(text).with_lock("P5.outer first").text == JobText(BEFORE).with_lock("P5.outer first").text
