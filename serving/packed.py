"""Text that is kept by the dozen and looked at one by one: a plan's files, and what the page shows of it."""

from __future__ import annotations

import zlib
from dataclasses import dataclass

_QUICK = 1
"""A level that packs some hundred megabytes a second; what repeats itself in a plan, it finds too."""


@dataclass(frozen=True, slots=True)
class Packed:
    """A text, compressed.

    Examples
    --------
    >>> packed = Packed.of("G1 X10 Y10\\n" * 1000)
    >>> packed.text() == "G1 X10 Y10\\n" * 1000, len(packed.data) < 500
    (True, True)
    """

    data: bytes

    @classmethod
    def of(cls, text: str) -> Packed:
        """The text, compressed; names that are no Unicode keep their bytes."""
        return cls(zlib.compress(text.encode("utf-8", "surrogatepass"), _QUICK))

    def text(self) -> str:
        """The text as it was."""
        return self.bytes().decode("utf-8", "surrogatepass")

    def bytes(self) -> bytes:
        """The text in UTF-8."""
        return zlib.decompress(self.data)
