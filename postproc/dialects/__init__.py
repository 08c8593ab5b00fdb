"""Controls and how they spell a program."""

from .dialect import Dialect, LineNumbers, dialect_names, load_dialect, pierce_dwell_of

__all__ = ["Dialect", "LineNumbers", "dialect_names", "load_dialect", "pierce_dwell_of"]
