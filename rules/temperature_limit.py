"""A limit on how hot metal may become, whichever rule sets it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TemperatureLimit:
    """No metal becomes hotter than `most_c`; the torch may wait for it to cool where `dwells`, `longest_dwell_s` each.

    `rule` is the id of the rule that says so. Its options for waits are `dwells` and `longest_dwell`: messages tell
    planners to set them.

    Examples
    --------
    >>> TemperatureLimit("cool", 90.0, dwells=False, longest_dwell_s=60.0).allowed_dwell_s
    0.0
    """

    rule: str
    most_c: float
    dwells: bool
    longest_dwell_s: float

    @property
    def allowed_dwell_s(self) -> float:
        """The longest wait allowed, s."""
        return self.longest_dwell_s if self.dwells else 0.0
