"""The most that flows: as much as scipy finds, and a least cut that lets no more across."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import maximum_flow

from kerfwise.models.engines.bounds.separation import flow_up_to

NODES, ARCS, PLENTY = 12, 40, 10**9


@pytest.mark.parametrize("seed", range(20))
def test_as_much_flows_as_scipy_says_and_the_sides_are_a_least_cut(seed: int) -> None:
    random = np.random.default_rng(seed)
    leave, reach = random.integers(0, NODES, (2, ARCS))
    apart = leave != reach
    leave, reach = leave[apart], reach[apart]
    room = random.integers(1, 100, len(leave))
    start, end, open_ = np.zeros(NODES, dtype=np.bool_), np.zeros(NODES, dtype=np.bool_), random.random(NODES) < 0.8
    start[:2], end[-2:] = True, True
    open_[[0, NODES - 1]] = True
    ends, numbers = np.concatenate([leave, reach]), np.arange(len(leave))
    first = np.searchsorted(np.sort(ends), np.arange(NODES + 1))
    arcs = np.concatenate([numbers, ~numbers])[np.argsort(ends, kind="stable")]
    side = np.empty(NODES, dtype=np.bool_)
    most = flow_up_to(PLENTY, start, end, open_, leave, reach, room, first, arcs, side)

    here = open_[leave] & open_[reach]
    sources, sinks = np.flatnonzero(start & open_), np.flatnonzero(end & open_)
    rows = np.concatenate([leave[here], np.full(len(sources), NODES), sinks])
    columns = np.concatenate([reach[here], sources, np.full(len(sinks), NODES + 1)])
    rooms = np.concatenate([room[here], np.full(len(sources) + len(sinks), 10**6)])
    table = coo_matrix((rooms.astype(np.int32), (rows, columns)), shape=(NODES + 2, NODES + 2)).tocsr()
    assert most == maximum_flow(table, NODES, NODES + 1).flow_value
    assert most == room[here & side[leave] & ~side[reach]].sum()
    assert flow_up_to(most - 1, start, end, open_, leave, reach, room, first, arcs, side) > most - 1 or most == 0
