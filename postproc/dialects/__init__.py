"""Controls and how they spell a program."""

from .blocks import LineNumbers
from .dialect import ControlName, Dialect
from .load import (
    dialect_misfits,
    dialect_names,
    dialect_text,
    expect_words,
    fitting_dialect,
    load_dialect,
    own_wait_s,
    pierce_dwell_of,
    plant_words,
    powers_of,
)

__all__ = [
    "ControlName",
    "Dialect",
    "LineNumbers",
    "dialect_misfits",
    "dialect_names",
    "dialect_text",
    "expect_words",
    "fitting_dialect",
    "load_dialect",
    "own_wait_s",
    "pierce_dwell_of",
    "plant_words",
    "powers_of",
]
