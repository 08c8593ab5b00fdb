"""What rules may know of a profile beside their own options."""

from __future__ import annotations

from dataclasses import dataclass

from .lock import Lock


@dataclass(frozen=True, slots=True)
class Plant:
    """The plant's sheet, its heat, its locks, and what cuts.

    A field of a rule's `Options` that no key of its own sets, and that has the name of one of these, takes its value.
    """

    thickness_mm: float
    kerf_mm: float
    ambient_c: float
    heat_limit_c: float
    absorbed_power_w: float
    locks: tuple[Lock, ...]
    process: str = "plasma"
    common_cuts: bool = False
    longest_link_mm: float = 0.0
