"""Controls and how they spell a program."""

from .dialect import ControlName, Dialect, LineNumbers, dialect_names, load_dialect, pierce_dwell_of
from .fit import fitting_dialect

__all__ = [
    "ControlName",
    "Dialect",
    "LineNumbers",
    "dialect_names",
    "fitting_dialect",
    "load_dialect",
    "pierce_dwell_of",
]
