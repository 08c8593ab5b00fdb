"""The sweep: shortest ways through the ideals of one stretch, layer by layer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from math import inf

import numpy as np

from kerfwise.arrays import Floats, Int16s, Int32s, Ints
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals.stretches.stretch_tables import (
    HOME,
    NARROW,
    dearest,
    entrance_of,
    home_from,
    make_moves,
    never,
)
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.engines.tuning import (
    A_SHARE,
    BYTES_A_NEW_ENTRY,
    BYTES_A_NEW_SET,
    BYTES_AN_ENTRY,
    NEW_SETS_PER_SET,
    STEPS_AN_ENTRY,
    WORTH_CLEARING,
)
from kerfwise.models.engines.tuning import LATTICE_LOOKS as LOOKS
from kerfwise.models.engines.tuning import SETS_ADDITIONS_PER_S as ADDITIONS_PER_S
from kerfwise.models.jit import cores, plain, suited
from kerfwise.models.kernel_struct import kernel_argument
from kerfwise.models.problem.bitsets import masks_of
from kerfwise.models.problem.problem import Problem

from .by_arrays import arrange_by_arrays, covers, sweep_by_arrays
from .kernels import (
    Costs,
    LayerFrom,
    LayerTo,
    MoveTable,
    Room,
    Steps,
    arrange,
    leaving,
    promises,
    room_for,
    room_to_arrange,
    sweep,
)
from .sets import Growth, Sets, additions_of, grow, growth
from .stretch import ConditionsByContour, CrossingAlternatives, Local, RestBound, crossing_extra_cost, localise, series

THREADS = cores()


@dataclass(frozen=True, eq=False, slots=True)
class SweptLayer:
    """What is kept of the ideals of one size (see `kernels`): their entries and the value of every state.

    Entries of ideal k are `ideal_entry[k]` … `ideal_entry[k + 1] - 1`, `source` the ideal of the layer before.
    """

    ideal_entry: Ints
    contour: Int16s
    source: Int32s
    values: Costs

    def begin(self, size: Ints) -> Ints:
        """Where the states of every entry begin."""
        return np.append(0, np.cumsum(size[self.contour])).astype(np.int64)


@dataclass(frozen=True, eq=False, slots=True)
class SweptStretch:
    """All that a sweep works on: `limit` is the most that a plan worth finding costs, `never` is more.

    `over` is what moves cost more for what is out. Where `dear` is given, it is what multipliers leave of the cost of
    moves, and `rests` is of that.
    """

    local: Local
    moves: MoveTable
    over: CrossingAlternatives
    rests: Callable[[int], RestBound]
    limit: int
    never: int
    dear: MoveTable | None = None


@dataclass(slots=True)
class Width:
    """How many states of a layer a sweep keeps, the most promising; plans by the others cost `dropped` at least."""

    most: int
    dropped: float = inf

    def narrow(self, promise: Floats, values: Costs, never: int) -> bool:
        """Drop the others, which `promise` (states,) more; whether there were any. Of equals the first stay."""
        there = np.flatnonzero(np.isfinite(promise))
        if len(there) <= self.most:
            return False
        gone = there[np.argsort(promise[there], kind="stable")][self.most :]
        self.dropped = min(self.dropped, float(promise[gone[0]]))
        values[gone] = never
        return True


def sweep_layers(
    stretch: SweptStretch,
    entrance: Costs,
    deadline: Deadline,
    threads: Executor,
    lows: Costs | None = None,
    width: Width | None = None,
    held: float = 0.0,
) -> list[SweptLayer]:
    """All layers of a stretch, the first the empty set with the values at its entrance.

    States that cost more than the limit, less what is still to come, are dropped: they cannot be part of a better plan.
    `lows` are what plans cost at least by their ways in, where the stretch has two costs. With a `width` only so many
    states of a layer are kept. `held` bytes of the deadline's are taken by stretches before it. Raises TooLarge over
    the deadline.
    """
    local, orders = stretch.local, stretch.local.orders
    sets = Sets.empty(orders, len(entrance))
    layers = [SweptLayer(np.array([0, 1]), np.array([-1], np.int16), np.array([-1], np.int32), entrance)]
    begin, alive = np.array([0, len(entrance)]), np.array([0])
    wide, times, free = entrance.itemsize, 1 if lows is None else 2, deadline.most_bytes - held
    lows = entrance[:0] if lows is None else lows
    moves, over = kernel_argument(stretch.moves), kernel_argument(stretch.over)
    terms = kernel_argument(local.terms)
    low_moves = moves if stretch.dear is None else kernel_argument(stretch.dear)
    for depth in range(1, len(local.contours) + 1):
        ahead = growth(orders, sets, alive)
        expect(deadline, ahead, len(sets), sets.masks.shape[1], wide, free, times)
        grown, contour, target, entry_from = grow(orders, sets, alive, ahead.entries)
        sorted_ = room_to_arrange(ahead.entries, len(grown))
        suited(arrange, 3 * ahead.entries, arrange_by_arrays)(contour, target, entry_from, alive, orders.size, sorted_)
        ideal_entry, last, source, place, new_begin = sorted_
        values = np.empty(ahead.states, dtype=entrance.dtype)
        living = np.empty(ahead.entries, dtype=np.bool_)
        back = layers[-1]
        new_lows = np.empty(ahead.states if len(lows) else 0, dtype=entrance.dtype)
        rest = stretch.rests(depth)
        steps = kernel_argument(Steps(moves, low_moves, over, terms, rest, local.first, stretch.limit, stretch.never))
        came = kernel_argument(LayerFrom(sets.masks, back.ideal_entry, back.contour, begin, back.values, lows))
        goes = kernel_argument(LayerTo(alive, entry_from, contour, place, new_begin, values, new_lows, living))
        turns = times * (ahead.additions + ahead.entries * STEPS_AN_ENTRY)
        room = partial(room_for, moves, came, int(np.diff(begin[back.ideal_entry])[alive].max(initial=0)))
        by_arrays = None if len(lows) or not covers(local.terms, rest) else sweep_by_arrays
        sweep_span = partial(_sweep_span, suited(sweep, turns, by_arrays), steps, came, goes, room)
        for spans in _shares(len(alive), ahead.additions):
            list(threads.map(sweep_span, *zip(*spans, strict=True)))
            _check(deadline)
        if width is not None and width.narrow(suited(promises, turns)(steps, came, goes), values, stretch.never):
            living = np.logical_or.reduceat(values < stretch.never, new_begin[:-1])
        if living.sum() <= WORTH_CLEARING * len(living):
            kept = np.append(0, np.cumsum(living))
            stays = np.repeat(living, np.diff(new_begin))
            values, new_lows = values[stays], new_lows[stays] if len(new_lows) else new_lows
            ideal_entry, last, source = kept[ideal_entry], last[living], source[living]
            layers.append(SweptLayer(ideal_entry, last, source, values))
            new_begin, living = layers[-1].begin(orders.size), np.ones(len(last), dtype=np.bool_)
        else:
            layers.append(SweptLayer(ideal_entry, last, source, values))
        if width is not None:
            grown = replace(grown, width=np.diff(new_begin[ideal_entry]))
        lives = np.append(0, np.cumsum(living))
        alive = np.flatnonzero(np.diff(lives[ideal_entry]))
        free -= bytes_of(layers[-2:])
        sets, begin, lows = grown, new_begin, new_lows
    return layers


def _sweep_span(
    kernel: Callable[..., None],
    steps: Steps,
    came: LayerFrom,
    goes: LayerTo,
    room: Callable[[], Room],
    start: int,
    stop: int,
) -> None:
    """See `sweep`; each span has its own room."""
    kernel(steps, came, goes, kernel_argument(room()), start, stop)


def _shares(alive: int, additions: float) -> list[list[tuple[int, int]]]:
    """Spans of ideals: those of one list may be swept at the same time, and between lists it may be stopped."""
    lists = int(min(LOOKS, max(1.0, additions / (THREADS * A_SHARE) / 8)))
    spans = int(min(8 * THREADS, max(1.0, additions / lists / A_SHARE * THREADS)))
    cuts = np.linspace(0, alive, lists * spans + 1).astype(int).tolist()
    return [[(cuts[k], cuts[k + 1]) for k in range(at * spans, (at + 1) * spans)] for at in range(lists)]


def walk_back(stretch: SweptStretch, layers: list[SweptLayer], state: int) -> tuple[list[int], int]:
    """The sites (columns) of a best way to state `state` of the last layer, in order, and the way in it took."""
    local, moves = stretch.local, stretch.moves
    size, ways = local.orders.size, len(layers[0].values)
    out = masks_of([range(len(size))], len(size))[0]
    columns: list[int] = []
    for here, back in zip(reversed(layers[1:]), reversed(layers[:-1]), strict=True):
        begin = here.begin(size)
        entry = int(np.searchsorted(begin, state, side="right")) - 1
        i, ideal = int(here.contour[entry]), int(here.source[entry])
        offset = state - int(begin[entry])
        columns.append(int(local.first[i]) + offset)
        out[i // 64] &= ~(np.uint64(1) << np.uint64(i % 64))
        begin = back.begin(size) if back is not layers[0] else np.array([0, ways])
        best: int | None = None
        state = -1
        for s in range(int(back.ideal_entry[ideal]), int(back.ideal_entry[ideal + 1])):
            j = int(back.contour[s])
            rows = int(moves.row_of[j]) + np.arange(begin[s + 1] - begin[s])
            costs = back.values[begin[s] : begin[s + 1]].astype(np.int64)
            costs += moves.table[moves.base[i] + rows * moves.pad[i] + offset]
            if len(stretch.over.extra):
                costs += [plain(crossing_extra_cost)(stretch.over, out, row, columns[-1]) for row in rows]
            if j >= 0:
                costs += plain(leaving)(local.terms, out, j, i)
            k = int(np.argmin(costs))
            if best is None or costs[k] < best:
                best, state = int(costs[k]), int(begin[s]) + k
    return columns[::-1], state


class TooLarge(Exception):
    """There are more ideals than the budget allows; nothing is proven."""


def sweeping(deadline: Deadline, work: float, held: float = 0.0) -> Deadline:
    """So much work for sweeps, counted in additions, with the bytes that are free beside what is held."""
    return deadline.counting(work, ADDITIONS_PER_S, deadline.most_bytes - held)


def expect(deadline: Deadline, ahead: Growth, sets: int, words: int, width: int, free: float, times: int = 1) -> None:
    """Pay for the layer after one of so many sets before it is made; a state has `times` values of `width` bytes.

    Raises TooLarge if it is more than is left of the work, or of the `free` bytes, or it is time to stop.
    """
    deadline.spend(additions_of(times * ahead.additions, ahead.entries, times * ahead.states))
    new_sets = min(ahead.entries, NEW_SETS_PER_SET * sets)
    taken = ahead.entries * (BYTES_A_NEW_ENTRY + BYTES_AN_ENTRY) + ahead.states * width * times
    taken += new_sets * (BYTES_A_NEW_SET + 16 * (words - 1))
    if deadline.left < 0 or taken > free:
        raise TooLarge
    _check(deadline)


def _check(deadline: Deadline) -> None:
    """`TooLarge` if it is time to stop."""
    if not deadline.go():
        raise TooLarge


def bytes_of(layers: Sequence[SweptLayer]) -> float:
    """What layers take that are kept for the way back."""
    return float(sum(len(layer.contour) * BYTES_AN_ENTRY + layer.values.nbytes for layer in layers[1:]))


# One sweep through all stretches, and the way back.

Rests = Callable[[int, Local, frozenset[int]], Callable[[int], RestBound]]
"""Of a stretch, by its number, what it is and what comes before it: what plans still cost after so many cuts of it."""


def sweep_through(
    problem: Problem,
    known: int | None,
    rests: Rests,
    deadline: Deadline,
    threads: Executor,
    width: Width | None = None,
) -> Incumbent | None:
    """The best route of all that cost no more than `known`, None where there is none; `TooLarge` over the deadline.

    With a `width` it is the best of those by the states that are kept.

    Where nothing is known, routes whose costs fit in narrow numbers are looked for first: most plans need no excuse.
    """
    most = dearest(problem) if known is None else known
    if known is None and most >= NARROW:
        found = _sweep(problem, NARROW - 1, rests, deadline, threads, width)
        if found is not None:
            return found
    return _sweep(problem, most, rests, deadline, threads, width)


def _sweep(
    problem: Problem, limit: int, rests: Rests, deadline: Deadline, threads: Executor, width: Width | None
) -> Incumbent | None:
    swept: list[tuple[SweptStretch, list[SweptLayer]]] = []
    ways, costs, earlier = np.array([HOME]), entrance_of([0], limit), frozenset[int]()
    total, held = None, 0.0
    parts = ConditionsByContour(problem)
    for number, group in enumerate(series(problem)):
        inside = parts.of(group)
        local = localise(inside, group, earlier)
        moves, over = make_moves(inside, local, earlier, ways, limit)
        stretch = SweptStretch(local, moves, over, rests(number, local, earlier), limit, never(limit))
        layers = sweep_layers(stretch, costs, deadline, threads, width=width, held=held)
        held += bytes_of(layers)
        swept.append((stretch, layers))
        earlier |= frozenset(group)
        last, costs = layers[-1].contour, layers[-1].values
        if not (costs < stretch.never).any():
            break
        ways = local.sites_of(last)
    else:
        total = costs + home_from(problem, ways)
    if total is None or total.min() > limit:
        return None
    best = int(np.argmin(total))
    return Incumbent(_route(swept, best), int(total[best]))


def _route(swept: list[tuple[SweptStretch, list[SweptLayer]]], state: int) -> tuple[int, ...]:
    route: list[int] = []
    for stretch, layers in reversed(swept):
        columns, state = walk_back(stretch, layers, state)
        route = [int(stretch.local.sites[c]) for c in columns] + route
    return tuple(route)
