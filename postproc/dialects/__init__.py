"""Controls and how they spell a program."""

from .dialect import ControlName, Dialect, LineNumbers
from .load import dialect_names, dialect_text, expect_words, fitting_dialect, load_dialect, pierce_dwell_of, powers_of

__all__ = [
    "ControlName",
    "Dialect",
    "LineNumbers",
    "dialect_names",
    "dialect_text",
    "expect_words",
    "fitting_dialect",
    "load_dialect",
    "pierce_dwell_of",
    "powers_of",
]
