"""What a proof may spend: additions, and bytes that are kept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from kerfwise.models.engines.budget import Budget
from kerfwise.models.engines.solution import MEMORY_GB, table_bytes

from .count import ADDITIONS_PER_S, BYTES_AN_ENTRY, additions_of
from .sets import Growth

BYTES_A_NEW_ENTRY, BYTES_A_NEW_SET = 38, 44
"""What an entry, and a set, take on top while their layer is being made; sets of one word, 16 more for each other."""
NEW_SETS_PER_SET = 4
"""How many new sets a set leads to at the most, where there are many."""


TABLE_BYTES = table_bytes(MEMORY_GB)


class TooLarge(Exception):
    """There are more ideals than the budget allows; nothing is proven."""


@dataclass(slots=True)
class SweepBudget:
    """What sweeps may spend: `work` in additions, and of the memory the `bytes` that are free."""

    work: Budget
    bytes: float
    go: Callable[[], bool]

    @staticmethod
    def of(work: float, go: Callable[[], bool], most_bytes: float = TABLE_BYTES) -> SweepBudget:
        """So many deterministic seconds, and bytes, as long as `go` says so."""
        return SweepBudget(Budget(work, per_s=ADDITIONS_PER_S), most_bytes, go)

    def expect(self, ahead: Growth, sets: int, words: int, width: int, times: int = 1) -> None:
        """Pay for the layer after one of so many sets before it is made; a state has `times` values of `width` bytes.

        Raises
        ------
        TooLarge
            If it is more than is left of either, or it is time to stop.
        """
        self.work.spend(additions_of(times * ahead.additions, ahead.entries, times * ahead.states))
        new_sets = min(ahead.entries, NEW_SETS_PER_SET * sets)
        taken = ahead.entries * (BYTES_A_NEW_ENTRY + BYTES_AN_ENTRY) + ahead.states * width * times
        taken += new_sets * (BYTES_A_NEW_SET + 16 * (words - 1))
        if self.work.left < 0 or taken > self.bytes or not self.go():
            raise TooLarge

    def keep(self, entries: int, states: int, width: int) -> None:
        """A layer is made, and kept."""
        self.bytes -= entries * BYTES_AN_ENTRY + states * width

    def check(self) -> None:
        """`TooLarge` if it is time to stop."""
        if not self.go():
            raise TooLarge
