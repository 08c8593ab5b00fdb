"""Rules from outside: written in Python, in a file that a profile names or in a package that is installed."""

from .installed import installed_rules
from .python_file import PythonFile, rules_in_file
from .trust import is_trusted, refusal

__all__ = ["PythonFile", "installed_rules", "is_trusted", "refusal", "rules_in_file"]
