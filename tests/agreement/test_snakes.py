"""Small nests with snakes, last stretches and bevels: every engine finds what the check passes of all plans."""

from __future__ import annotations

import pytest

from kerfwise.tests.agreement.stretch_nests import Kind, stretch_agreement
from kerfwise.tests.tools.amount import rows

ROWS, OTHERS = (2, 11, 3, 0, 1, 4, 5, 6, 7, 8, 9, 10), ("grid", "pair", "bevel")
NESTS = [*(("row", seed) for seed in ROWS), *((kind, seed) for kind in OTHERS for seed in range(5))]


@pytest.mark.minizinc
@pytest.mark.parametrize(("kind", "seed"), rows(NESTS))
def test_every_engine_finds_what_the_check_passes_of_all_plans(kind: Kind, seed: int) -> None:
    _, proved, differ = stretch_agreement(seed, kind)
    assert differ == ()
    assert {"portfolio", "ideals", "cp-sat-alone", "minizinc"} <= {*proved}
