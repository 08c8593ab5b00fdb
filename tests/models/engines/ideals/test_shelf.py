"""Tables on a shelf are what they were, whatever is put beside them."""

import numpy as np
import pytest

from kerfwise.models.engines.ideals.stretches import stretch_bounds
from kerfwise.models.engines.ideals.stretches.stretch_bounds import Arena


def test_tables_stay_as_they_were(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stretch_bounds, "PIECE", 50)
    rng = np.random.default_rng(1)
    tables = [rng.random((k % 4 + 1, 2, k % 5 + 1)) for k in range(30)] + [rng.random((9, 9))]
    kept = Arena()
    put = [kept.put(table) for table in tables]
    for table, copy in zip(tables, put, strict=True):
        assert copy.tolist() == table.tolist()
        assert copy.flags.c_contiguous
    assert len({id(copy.base) for copy in put}) < len(tables) / 2
