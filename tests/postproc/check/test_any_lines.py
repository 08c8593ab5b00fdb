"""Any order of a grid's lines, with lines left out, doubled, split and moved: what passes the check, burns well."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.tests.checked import checked
from kerfwise.tests.metal.simulate import by_kind, simulate
from kerfwise.tests.postproc.by_lines import Line, across, grid, program_of, upright
from kerfwise.tests.postproc.check.test_common_cuts import PROFILE
from kerfwise.tests.postproc.plans import KERF_MM
from kerfwise.tests.tools.amount import examples

GRID = grid(2, 2)
LINES = [*(across(2, k) for k in range(3)), *(upright(2, k) for k in range(3))]
BAD = {"left-uncut", "feature-lost", "part-eroded", "loose-part-burnt", "part-not-free", "off-sheet"}
"""What no program may do that passes; pierces are not judged here."""


def changed(line: Line, how: str, share: float) -> list[Line]:
    (x0, y0), (x1, y1) = line
    middle = (x0 + share * (x1 - x0), y0 + share * (y1 - y0))
    by = {"in two": [[line[0], middle], [middle, line[1]]], "left out": [], "cut short": [[line[0], middle]]}
    by |= {"doubled": [line, line], "turned": [line[::-1]], "as it is": [line], "moved": [[(x0 + share, y0), (x1, y1)]]}
    return by[how]  # type: ignore[return-value]


WAYS = ["as it is"] * 6 + ["turned"] * 3 + ["in two"] * 2 + ["left out", "cut short", "doubled", "moved"]


@pytest.mark.slow
@examples(150, derandomize=True)
@given(
    st.permutations(LINES),
    st.lists(st.sampled_from(WAYS), min_size=6, max_size=6),
    st.lists(st.floats(0.1, 0.9), min_size=6, max_size=6),
)
def test_what_passes_burns_well(order: list[Line], how: list[str], share: list[float]) -> None:
    burns = [burn for row in zip(order, how, share, strict=True) for burn in changed(*row)]
    if not burns:
        return
    program = program_of(burns, PROFILE)
    result = checked(GRID, program, PROFILE)
    found = by_kind(simulate(GRID, program, KERF_MM, touching=True))
    if result.ok:
        assert not BAD & found.keys(), (burns, found)
    if not found.keys() & (BAD | {"cut-twice"}) and not {"doubled", "cut short", "left out", "moved"} & {*how}:
        assert result.ok, (burns, str(result))
