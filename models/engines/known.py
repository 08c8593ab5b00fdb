"""What is known of a problem while engines work on it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from .solution import Incumbent

if TYPE_CHECKING:
    from .ideals.priced_stretches import Found


@dataclass(slots=True)
class Known:
    """What is known of a problem so far, who found it, and what was chosen why.

    `priced` is what a proof has found out of every stretch of the order, where it was begun.
    `unable` says why the one member that was asked for cannot find a plan; empty where it can, or all may run.
    """

    incumbent: Incumbent | None = None
    found_by: str = ""
    bound_um: int = 0
    proved_by: str = ""
    infeasible: bool = False
    work: float = 0.0
    notes: list[str] = field(default_factory=list)
    unable: str = ""
    priced: tuple[Found, ...] = ()

    @property
    def proven(self) -> bool:
        """Whether nothing is left to find out."""
        return self.infeasible or (self.incumbent is not None and self.bound_um >= self.incumbent.cost)

    def offer(self, incumbent: Incumbent | None, engine: str) -> None:
        """Take an incumbent if it is better."""
        if incumbent is not None and (self.incumbent is None or incumbent.cost < self.incumbent.cost):
            self.incumbent, self.found_by = incumbent, engine

    def raise_bound(self, bound_um: int, engine: str) -> None:
        """Take a bound if it is better."""
        if bound_um > self.bound_um or (bound_um == self.bound_um == 0 and not self.proved_by):
            self.bound_um, self.proved_by = bound_um, engine
