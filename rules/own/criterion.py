"""Criteria: what a selector asks of one fact, such as `"< 6"`, `2..6`, `[hole, outer]`, `P1*` or `true`."""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from dataclasses import dataclass
from fnmatch import fnmatchcase

ROUNDING_MM = 1e-6
"""Numbers that differ by less are equal: no choice may hang on the last bit of a coordinate."""


class Criterion(ABC):
    """One question about the value of a fact."""

    @abstractmethod
    def met(self, value: object) -> bool:
        """Whether a value answers it; a value that is not known (None) never does."""

    @abstractmethod
    def plain(self) -> object:
        """The YAML data that reads back as this criterion."""


@dataclass(frozen=True, slots=True)
class NumberSpan(Criterion):
    """A stretch of numbers; `negated` for all but it, `given` is how it was written.

    Examples
    --------
    >>> NumberSpan(high=6.0, without_high=True).met(6.0), NumberSpan(high=6.0).met(6.0)
    (False, True)
    """

    low: float = -math.inf
    high: float = math.inf
    without_low: bool = False
    without_high: bool = False
    negated: bool = False
    given: str = ""

    def met(self, value: object) -> bool:
        number = _number(value)
        return number is not None and self._holds(number)

    def surely_met(self, value: float, slack_mm: float) -> bool:
        """Whether it holds for every number this near to the value."""
        return all(self._holds(v) for v in (value - slack_mm, value, value + slack_mm))

    def perhaps_met(self, value: float, slack_mm: float) -> bool:
        """Whether it holds for some number this near to the value."""
        return any(self._holds(v) for v in (value - slack_mm, value, value + slack_mm))

    def _holds(self, value: float) -> bool:
        low = self.low + ROUNDING_MM if self.without_low else self.low - ROUNDING_MM
        high = self.high - ROUNDING_MM if self.without_high else self.high + ROUNDING_MM
        above = value > low if self.without_low else value >= low
        below = value < high if self.without_high else value <= high
        return (above and below) != self.negated

    def plain(self) -> object:
        if re.fullmatch(r"-?\d+", self.given):
            return int(self.given)
        return self.given


@dataclass(frozen=True, slots=True)
class Pattern(Criterion):
    """A text, with * for any run of characters and ? for one."""

    pattern: str

    def met(self, value: object) -> bool:
        return value is not None and not isinstance(value, bool) and fnmatchcase(str(value), self.pattern)

    def plain(self) -> object:
        return self.pattern


@dataclass(frozen=True, slots=True)
class Truth(Criterion):
    """true or false."""

    wanted: bool

    def met(self, value: object) -> bool:
        return isinstance(value, bool) and value is self.wanted

    def plain(self) -> object:
        return self.wanted


@dataclass(frozen=True, slots=True)
class AnyOf(Criterion):
    """At least one of several."""

    criteria: tuple[Criterion, ...]

    def met(self, value: object) -> bool:
        return any(c.met(value) for c in self.criteria)

    def plain(self) -> object:
        return [c.plain() for c in self.criteria]


def _number(value: object) -> float | None:
    """The number that a value is or spells, None for any other."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        number = float(value)
    except ValueError:
        return None
    return number if math.isfinite(number) else None
