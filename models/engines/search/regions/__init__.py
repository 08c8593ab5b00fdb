"""Parts of a large route searched alone: some contours and their entries are free, what lies between stays together.

A search of a few dozen contours goes on much faster than one of a thousand, and two that touch different halves of the
route can run at a time (as in POPMUSIC, Taillard and Voss 2002).
"""

from __future__ import annotations

from .contract import Contractor
from .improve import Regions, regional

__all__ = ["Contractor", "Regions", "regional"]
