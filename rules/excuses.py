"""Which orders a plan may break, because the plant's rules contradict each other there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..encoder.cut import CutSequence
from ..encoder.nest import Nest
from .cycles import excusable
from .registry import RULES
from .rule import Ids

if TYPE_CHECKING:
    from .profile import Profile


def excused_pairs(nest: Nest, cuts: CutSequence, profile: Profile) -> set[Ids]:
    """Pairs of contour ids (before, after) on a cycle of the hard orders, asked for by rules that give way only."""
    hard = {name: setting.options for name, setting in profile.settings().items() if setting.strength == "hard"}
    return excusable(
        {name: RULES[name].pairs(nest, cuts, options) for name, options in hard.items()},
        [run for name, options in hard.items() for run in RULES[name].together(nest, options)],
    )
