"""The text of a job file that hands change: every name that a contour can have comes back as it was."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from kerfwise.apps.viewer.serve.job_edits import JobText
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.overrides import lines_of

NAMES = st.one_of(
    st.text(st.characters(exclude_categories=("Cc", "Cs")), min_size=1, max_size=12),
    st.text('"\\ ab(:#-?', min_size=1, max_size=8),
).filter(str.strip)


@given(NAMES)
def test_a_lock_on_any_name_is_written_and_taken_back(name: str) -> None:
    before = "quantity: 2  # sheets\n"
    [line] = lines_of(Lock(contour=name, position="first"))
    text = JobText(before).with_lock(line)
    assert [lock.contour for _, lock in text.lines()] == [name]
    assert [said for said, _ in text.lines()] == [line]
    assert text.without_lock(line).text == before
