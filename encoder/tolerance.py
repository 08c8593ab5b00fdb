"""How far a torch's path may be from where it belongs, and how deep a kerf may reach into the metal of a part."""

from __future__ import annotations

TOLERANCE_MM = 0.05
"""How far a torch path may be from where it belongs; less where the kerf is so thin that sides would be confused."""


def tolerance_mm(kerf_mm: float) -> float:
    """The tolerance at this kerf: 0.05 mm, a quarter of a kerf under 0.2 mm, but never less than 0.02 mm.

    Examples
    --------
    >>> tolerance_mm(1.5), tolerance_mm(0.1), tolerance_mm(0.0)
    (0.05, 0.025, 0.05)
    """
    return min(TOLERANCE_MM, max(kerf_mm / 4, 0.02)) if kerf_mm > 0 else TOLERANCE_MM
