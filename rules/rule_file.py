"""The file that a rule of a plant stands in, as plans, programs and lists of rules name it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class RuleFile:
    """A file of a rule, the digest of its content, and whether the rule takes the place of a shipped one."""

    path: Path
    sha256: str
    in_place_of_shipped: bool = False
