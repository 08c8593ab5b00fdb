"""The independent check of nests: what was written, against the parts and sheets that were asked for."""

from .asked import AskedCommon, AskedPart, AskedSheet, AskedSpacing
from .judge import nest_faults

__all__ = ["AskedCommon", "AskedPart", "AskedSheet", "AskedSpacing", "nest_faults"]
