"""Rules from outside: written in Python, in a file that a profile names or in a package that is installed."""

from .plugin_sources import PythonFile, installed_rules, is_trusted, refusal, rules_in_file

__all__ = ["PythonFile", "installed_rules", "is_trusted", "refusal", "rules_in_file"]
