"""What rules of each torch ask where several torches cut."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from kerfwise.encoder.cut import CutSequence
from kerfwise.rules.rule import Rule


def asked_of(rule: Rule[Any], contours: Sequence[str], cuts: CutSequence) -> bool:
    """Whether a rule asks anything of these contours: one of each torch does so only of what a single torch cuts."""
    if not rule.of_each_torch or all(cut.torch == 1 for cut in cuts):
        return True
    by = {cut.contour: cut.torch for cut in cuts}
    return len({by[name] for name in contours if name in by}) < 2
