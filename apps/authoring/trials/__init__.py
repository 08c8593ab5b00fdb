"""Rules on trial: every plan of small nests, by what a rule states, by what it blames, by its MiniZinc, by engines."""

from .try_rules import rules_to_try, try_rule

__all__ = ["rules_to_try", "try_rule"]
