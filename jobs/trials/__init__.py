"""Rules on trial: every plan of small nests, by what a rule states, by what it blames, by its MiniZinc, by engines."""

from .run import try_rule

__all__ = ["try_rule"]
