"""The checks a nest passes before anything is computed from it."""

from .duplicates import coincident
from .validate import validated, wrong

__all__ = ["coincident", "validated", "wrong"]
