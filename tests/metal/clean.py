"""Hold a plan's program to the simulation: `assert_clean(nest, program, kerf_mm)` in tests that plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kerfwise.tests.metal.findings import Finding, Kind
from kerfwise.tests.metal.simulate import simulate

if TYPE_CHECKING:
    from kerfwise.encoder.nest import Nest

NOT_YET: frozenset[Kind] = frozenset({"pierce-over-void", "lead-over-void"})
"""Kinds that the planner does not yet avoid, and that tests of plans therefore pass over. It has to become empty:
whoever mends the planner takes the kind out here. The command `many` passes over nothing."""


def faults(nest: Nest, program: str, kerf_mm: float, **more: object) -> list[Finding]:
    """The findings of a program that the planner answers for already; `more` as `simulate` takes it."""
    found = simulate(nest, program, kerf_mm, **more)  # type: ignore[arg-type]
    return [f for f in found if f.kind not in NOT_YET]


def assert_clean(nest: Nest, program: str, kerf_mm: float, **more: object) -> None:
    """Fail with every finding of a program, one a line."""
    found = faults(nest, program, kerf_mm, **more)
    assert not found, "\n".join(map(str, found))
