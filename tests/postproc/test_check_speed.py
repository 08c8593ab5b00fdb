"""The benchmark of the check prints a table, also beside another version."""

import pytest

from kerfwise.tests.postproc.check_speed import HERE, main


@pytest.mark.full
def test_a_small_plate(capsys: pytest.CaptureFixture[str]) -> None:
    main(["--contours", "12", "--beside", HERE])
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 5
    assert lines[2].startswith("| 12 contours | ")
    assert "the version beside" in lines[4]
