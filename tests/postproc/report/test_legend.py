import pytest

from kerfwise.postproc.report.legend import counted


@pytest.mark.parametrize(("number", "said"), [(0, "0 parts"), (1, "1 part"), (2, "2 parts")])
def test_one_of_a_thing_is_no_plural(number: int, said: str) -> None:
    assert counted(number, "part") == said
