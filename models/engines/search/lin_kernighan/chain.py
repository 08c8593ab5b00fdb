"""A chain of steps that makes the line cheaper, found by trying the best few at each place and going back."""

from __future__ import annotations

import numpy as np

from kerfwise.models.engines.search.compiled import compiled
from kerfwise.models.engines.search.state import COST, WORK

from .state import BREADTH, DEPTH, FRONT, QUEUED, ChainState
from .steps import arc, arrival, find_steps, take_back, take_step
from .tables import ChainTables

PER_CONTOUR = 10
"""Operations for taking a contour out of the queue."""


@compiled
def enqueue(state: ChainState, contour: int) -> None:
    """Ask for the arc after a contour to be looked at."""
    if not state.waits[contour]:
        state.waits[contour] = True
        size = len(state.waits)
        state.queue[(state.number[FRONT] + state.number[QUEUED]) % size] = contour
        state.number[QUEUED] += 1


@compiled
def improve_all(tables: ChainTables, state: ChainState) -> None:
    """Improve the trial until no chain from a contour in the queue makes it cheaper."""
    size = len(state.waits)
    while state.number[QUEUED] > 0:
        contour = state.queue[state.number[FRONT]]
        state.number[FRONT] = (state.number[FRONT] + 1) % size
        state.number[QUEUED] -= 1
        state.waits[contour] = False
        state.number[WORK] += PER_CONTOUR
        while improve(tables, state, contour):
            pass


@compiled
def improve(tables: ChainTables, state: ChainState, contour: int) -> bool:
    """Make the trial cheaper by a chain that begins with the arc after a contour; False if none was found."""
    p = int(np.int64(state.place[contour]))
    follows = int(np.int64(state.line[p + 1]))
    saved = arc(tables, contour, follows)
    if saved <= 0:
        return False
    at, count = state.trying, state.known
    depth = 0
    at[0], count[0] = -1, find_steps(tables, state, 0, BREADTH[0], p, saved)
    while depth >= 0:
        if at[depth] >= 0:
            take_back(state, depth, at[depth])
        at[depth] += 1
        if at[depth] == count[depth]:
            depth -= 1
            continue
        take_step(state, depth, at[depth])
        freed, closing = state.freed[depth, at[depth]], state.closing[depth, at[depth]]
        if freed > closing:
            state.number[COST] -= freed - closing
            for taken in range(depth + 1):
                for part in range(3):
                    enqueue(state, state.tail[taken, part])
            return True
        if depth + 1 < DEPTH:
            depth += 1
            p = arrival(tables, state, follows) - 1
            at[depth], count[depth] = -1, find_steps(tables, state, depth, BREADTH[depth], p, freed)
    return False
