"""Values drawn at random from what an option declares: kind, bounds and default. A new option is drawn by itself."""

from __future__ import annotations

from typing import Any

import numpy as np

from .kind import OptionKind, Unfit
from .option import Option
from .plain_values import Choice, Flag, Number
from .quantities import OrWord, Quantity
from .yaml_positions import compose

USUAL = {"mm": 25.0, "s": 8.0, "kJ": 30.0, "°C": 115.0}
"""A value of each unit, for options whose default is nothing."""
FACTORS = (0.2, 0.5, 1.0, 1.7, 3.0)
TRIES = 100


class Undrawn(Exception):
    """Nobody has said how a value of this kind is drawn, or nothing valid was drawn."""


def drawn_value(option: Option, rng: np.random.Generator) -> Any:
    """A valid value of an option, the same for the same state of `rng`.

    Raises
    ------
    Undrawn
        If its kind is none of kerfwise's own, or nothing valid was drawn.
    """
    for _ in range(TRIES):
        value = _of_kind(option.kind, option.default, rng)
        try:
            return _read(option.kind, value)
        except Unfit:
            continue
    raise Undrawn(f"nothing valid was drawn for {option.name}: {option.kind.expected()}")


def _read(kind: OptionKind, value: Any) -> Any:
    node = compose(kind.write(value), "drawn")
    assert node is not None
    return kind.read(node)


def _of_kind(kind: OptionKind, default: Any, rng: np.random.Generator) -> Any:
    match kind:
        case Flag():
            return bool(rng.random() < 0.5)
        case Choice(words=words, none=none):
            word = str(rng.choice(words))
            return None if word == none else word
        case OrWord(quantity=quantity):
            return None if rng.random() < 0.3 else _of_kind(quantity, default, rng)
        case Quantity():
            usual = default if isinstance(default, float) and default else USUAL[kind.bare]
            return 0.0 if rng.random() < 0.1 else round(usual * float(rng.choice(FACTORS)), 3)
        case Number(at_least=low, at_most=high, whole=whole):
            low = 0.0 if low is None else low
            if whole and high is None:  # small counts tell most, on small nests
                return int(low) + int(rng.choice([0, 1, 2, 3, 7]))
            high = low + 4 * max(1.0, abs(float(default or 1))) if high is None else high
            return int(rng.integers(int(low), int(high) + 1)) if whole else round(float(rng.uniform(low, high)), 2)
        case _:
            raise Undrawn(f"say in rules/options/drawn.py how an option of kind {type(kind).__name__} is drawn")
