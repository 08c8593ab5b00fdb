"""Hold a program to the simulation: `assert_clean(nest, program, kerf_mm)` in tests that plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kerfwise.tests.metal.simulate import simulate

if TYPE_CHECKING:
    from kerfwise import Nest


def assert_clean(nest: Nest, program: str, kerf_mm: float, **more: object) -> None:
    """Fail with every finding of a program, one a line."""
    found = simulate(nest, program, kerf_mm, **more)  # type: ignore[arg-type]
    assert not found, "\n".join(map(str, found))
