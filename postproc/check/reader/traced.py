"""What one line of an old program changes."""

from __future__ import annotations

from dataclasses import dataclass

State = dict[str, tuple[str, ...]]
"""What is in force: for each thing that words can set, the blocks that have set it."""


@dataclass(frozen=True, slots=True)
class Traced:
    """One line that holds words: how many burns are over after it, and what it does while nothing burns.

    `state` is what is in force after it: units, feed, material and so on.
    `travels` says that it moves with the torch off, `waits` that it stands so, `halts` that the program stops there.
    """

    line: int
    burns: int
    travels: bool
    waits: bool
    halts: bool
    state: State
    rapid: str = ""
