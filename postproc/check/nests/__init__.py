"""The independent check of nests: what was written, against the parts and sheets that were asked for."""

from .asked import AskedPart, AskedSheet, AskedSpacing
from .judge import nest_faults

__all__ = ["AskedPart", "AskedSheet", "AskedSpacing", "nest_faults"]
