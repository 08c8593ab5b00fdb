"""The tools that are on, and what a program's halts and its end make of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field

from .controls import Control
from .program import NcProgram
from .track import Track
from .words import Block

ALL = -1
HALTS = frozenset({0.0, 1.0})
ENDS = frozenset({2.0, 30.0})


@dataclass(slots=True)
class ToolsOn(ABC):
    """The tools that are on; the control holds the torch for `held_s` where it starts to cut, and to mark."""

    track: Track
    control: Control
    held_s: tuple[float, float]
    on: list[int] = field(default_factory=list)
    ended: bool = False

    @abstractmethod
    def switch(self, block: Block, motion: float | None, modal: float | None) -> None:
        """Do what comes before a block's wait and motion.

        `motion` is the motion that it makes, None for none, and `modal` the one in force from this block on.
        """

    def halt(self, block: Block) -> None:
        """Do what comes after its motion: halts and the program's end."""
        for word in block.m:
            if word.value in HALTS and self.on:
                self.track.fault(
                    block.line, "torch-off-travel", f"{word.text} halts the program while tool ${self.on[0]} is on"
                )
            self.ended = self.ended or word.value in ENDS

    def start(self, tool: int, line: int) -> None:
        """Start a tool where the torch stands."""
        if self.on:
            self.track.fault(line, "torch-off-travel", f"tool ${tool} is started while ${self.on[0]} is on")
        if tool not in self.on:
            self.on.append(tool)
        if self.track.open is None:
            self.track.begin(tool, line, self.held_s[0] if tool == 0 else self.held_s[1])

    def stop(self, tool: int) -> None:
        """Stop a tool, or all."""
        self.on = [] if tool == ALL else [t for t in self.on if t != tool]
        if self.track.open is not None and self.track.open.tool not in self.on:
            self.track.close()


def what_was_done(
    track: Track, tools: ToolsOn, line: int, comments: Sequence[str], blocks: int, step_mm: float = 0.0
) -> NcProgram:
    """The whole program, once its last line has been run."""
    track.close()
    if tools.on:
        track.fault(line, "torch-off-travel", "the program ends with the torch on")
    if track.torches:
        text = f"the program ends with torch {track.torches[0]} selected: it would burn in the next program, too"
        track.fault(line, "program-state", text)
    if track.wait_s > 0:
        track.fault(line, "pierce-delay", f"the torch stands still for {track.wait_s:g} s after the last cut")
    return NcProgram(
        tuple(track.burns),
        tuple(track.hot_rapids),
        tuple(track.slow_travel),
        tuple(track.faults),
        tuple(comments),
        track.idle_mm,
        tuple(track.travels_mm),
        track.at,
        blocks,
        track.moving_s,
        tuple(track.rapids),
        step_mm=step_mm,
    )
