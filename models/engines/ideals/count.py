"""Counts the sets of a problem before anything is made of them: what a sweep without any bound would take."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kerfwise.models.problem.bits import words
from kerfwise.models.problem.problem import Problem

from .local import orders_of
from .series import series
from .sets import Sets, grow, growth

ADDITIONS_PER_S = 1.2e10
ADDITIONS_AN_ENTRY, ADDITIONS_A_STATE = 1200, 100
"""Additions that it takes as long as to find, sort and look at an entry (a set and the contour cut last), and as to
store a state of it (its last site)."""
COUNTED_FASTER = 3
"""How many times faster an entry is counted."""
BYTES_AN_ENTRY, BYTES_A_STATE = 10, 4
"""What is kept of every layer, for the way back."""
SHARE_KEPT = 0.7
"""Of the bytes that a sweep may take, the share for layers that are made; the rest is for that which is being made."""


@dataclass(frozen=True, slots=True)
class Count:
    """Of all stretches together: sets, entries (a set and the last contour in it), states (and the last site in it).

    `whole` is False where counting was given up; the numbers are then those reached.
    """

    stretches: int
    longest: int
    sets: int
    entries: int
    states: int
    additions: float
    whole: bool

    @property
    def seconds(self) -> float:
        """What a sweep takes, in deterministic seconds."""
        return additions_of(self.additions, self.entries, self.states) / ADDITIONS_PER_S

    def fits(self, most_bytes: float) -> bool:
        """Whether all is counted, and can be kept in so many bytes."""
        return self.whole and self.entries * BYTES_AN_ENTRY + self.states * BYTES_A_STATE <= SHARE_KEPT * most_bytes

    @property
    def work(self) -> float:
        """What counting took, in deterministic seconds."""
        return self.entries * ADDITIONS_AN_ENTRY / COUNTED_FASTER / ADDITIONS_PER_S

    def __str__(self) -> str:
        size = f"{'' if self.whole else 'more than '}{self.sets} sets, {self.states} states"
        return f"{size}, {self.stretches} stretches one after the other, of {self.longest} contours at most"


def additions_of(additions: float, entries: int, states: int) -> float:
    """What a layer takes, in additions."""
    return additions + ADDITIONS_AN_ENTRY * entries + ADDITIONS_A_STATE * states


def count_sets(problem: Problem, most_entries: float, going: Callable[[int], bool] = lambda _: True) -> Count:
    """Count until there are more than `most_entries`, fewer where sets are long, or are bound to be.

    Where the sets of the first layers are already more than their share, those of the middle would be far too many.
    `going` is asked before each layer whether to go on, and told how many there are so far.
    """
    stretches = series(problem)
    most_entries *= min(1.0, 2 / words(max(map(len, stretches), default=0)))
    sets = entries = states = done = 0
    additions, ways = 0.0, 1
    for group in stretches:
        orders = orders_of(problem, group)
        layer = Sets.empty(orders, ways)
        for _ in group:
            alive = np.arange(len(layer))
            ahead = growth(orders, layer, alive)
            entries, states = entries + ahead.entries, states + ahead.states
            additions += ahead.additions
            done += 1
            if entries > most_entries * min(1.0, 2 * done / problem.n) or not going(entries):
                return Count(len(stretches), max(map(len, stretches)), sets, entries, states, additions, False)
            layer, *_ = grow(orders, layer, alive, ahead.entries)
            sets += len(layer)
        ways = int(layer.width.sum())
    return Count(len(stretches), max(map(len, stretches), default=0), sets, entries, states, additions, True)
