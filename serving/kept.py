"""The last few things that were worked out, for who asks again."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

MOST_KEPT = 6
"""Nests, and plans of them, that are kept worked out."""

T = TypeVar("T")


@dataclass
class Kept:
    """What was worked out, by what it was asked for."""

    most: int = MOST_KEPT
    made: OrderedDict[Any, Any] = field(default_factory=OrderedDict)

    def get(self, key: Any, make: Callable[[], T], again: bool = False) -> T:
        """What is kept under a key, made if it is not there, or is to be made again."""
        if again or key not in self.made:
            self.made[key] = make()
            while len(self.made) > self.most:
                self.made.popitem(last=False)
        self.made.move_to_end(key)
        found: T = self.made[key]
        return found
