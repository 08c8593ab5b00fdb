"""The trial sequence: taking contours out, the window where one may stand, and putting it in."""

from __future__ import annotations

from .compiled import compiled
from .orders import OrderLists
from .state import LENGTH, STAMP, START, State


@compiled
def close_gaps(state: State) -> None:
    """Drop the contours whose position was set to -1 from the order; those beside a gap become stale."""
    kept, gap = 0, False
    for p in range(state.number[LENGTH]):
        c = state.order[p]
        if state.position[c] < 0:
            if not gap and kept > 0:
                state.stale[state.order[kept - 1]] = True
            gap = True
            continue
        if gap:
            state.stale[c] = True
            gap = False
        state.order[kept] = c
        state.position[c] = kept
        kept += 1
    state.number[LENGTH] = kept


@compiled
def window(orders: OrderLists, state: State, contour: int) -> tuple[int, int]:
    """First and last position that a contour which is out may be put in before, by orders and blocks."""
    lo = _earliest(orders, state, contour)
    hi = _latest(orders, state, contour)
    b = orders.block[contour]
    start, stop = orders.block_first[b], orders.block_first[b + 1]
    if stop - start > 1:
        low, high = state.number[LENGTH], -1
        for e in range(start, stop):
            where = state.position[orders.in_block[e]]
            if where >= 0:
                low, high = min(low, where), max(high, where + 1)
        if high >= 0:
            lo, hi = max(lo, low), min(hi, high)
    return lo, hi


@compiled
def _earliest(orders: OrderLists, state: State, contour: int) -> int:
    """The position after the last contour that must come before this one, seen through those that are out."""
    state.number[STAMP] += 1
    limit, height = START, 1
    state.stack[0] = contour
    while height > 0:
        height -= 1
        x = state.stack[height]
        for e in range(orders.covers_first[x], orders.covers_first[x + 1]):
            y = orders.covers[e]
            if state.position[y] >= 0:
                limit = max(limit, state.position[y] + 1)
            elif state.mark[y] != state.number[STAMP]:
                state.mark[y] = state.number[STAMP]
                state.stack[height] = y
                height += 1
    return limit


@compiled
def _latest(orders: OrderLists, state: State, contour: int) -> int:
    """The position of the first contour that must come after this one, seen through those that are out."""
    state.number[STAMP] += 1
    limit, height = state.number[LENGTH], 1
    state.stack[0] = contour
    while height > 0:
        height -= 1
        x = state.stack[height]
        for e in range(orders.covered_first[x], orders.covered_first[x + 1]):
            y = orders.covered[e]
            if state.position[y] >= 0:
                limit = min(limit, state.position[y])
            elif state.mark[y] != state.number[STAMP]:
                state.mark[y] = state.number[STAMP]
                state.stack[height] = y
                height += 1
    return int(limit)


@compiled
def inside_block(orders: OrderLists, state: State, at: int, block: int) -> bool:
    """Whether position `at` would part the contours of a block other than `block`."""
    if at == 0 or at == state.number[LENGTH]:
        return False
    b = orders.block[state.order[at]]
    return bool(b != block and b == orders.block[state.order[at - 1]])


@compiled
def put_in(state: State, start: int, stop: int, at: int) -> None:
    """Put the contours `out[start:stop]` in before position `at`; they and those beside them become stale."""
    size = stop - start
    length = state.number[LENGTH]
    for p in range(length - 1, at - 1, -1):
        c = state.order[p]
        state.order[p + size] = c
        state.position[c] = p + size
    for k in range(size):
        c = state.out[start + k]
        state.order[at + k] = c
        state.position[c] = at + k
        state.stale[c] = True
    if at > 0:
        state.stale[state.order[at - 1]] = True
    if at + size < length + size:
        state.stale[state.order[at + size]] = True
    state.number[LENGTH] = length + size
