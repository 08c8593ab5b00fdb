"""What rules of each torch ask where several torches cut."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kerfwise.encoder.cut import CutSequence
from kerfwise.rules.rule import Rule


def torch_of_each(cuts: CutSequence) -> dict[str, int]:
    """Contour id → the torch that cuts it; empty where one torch cuts all."""
    torches = {cut.contour: cut.torch for cut in cuts}
    return torches if len(set(torches.values())) > 1 else {}


def asked_of(rule: Rule[Any], contours: Sequence[str], torches: Mapping[str, int]) -> bool:
    """Whether a rule asks anything of these contours: one of each torch does so only of what a single torch cuts."""
    return not torches or not rule.of_each_torch or len({torches[name] for name in contours if name in torches}) < 2
