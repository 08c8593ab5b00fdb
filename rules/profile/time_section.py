"""What a profile says of time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Choice
from kerfwise.rules.options.quantities import ACCELERATION, LENGTH, over_zero

from .feed_law import FeedLaw
from .feed_law_kind import LawKind

TimeModel = Literal["constant", "blocks", "acceleration"]
_MODELS = Choice(("constant", "blocks", "acceleration"))


@dataclass(frozen=True, slots=True)
class Time:
    """How the time of a program is computed: at constant feeds, by its number of blocks, or with acceleration."""

    model: TimeModel = field(
        default="constant", metadata=option(_MODELS, "constant feeds, feed by NC blocks, or limited acceleration")
    )
    feed_by_blocks: FeedLaw | None = field(
        default=None, metadata=option(LawKind(), "feed law of the model blocks: a shipped one's name, or one's own")
    )
    acceleration_mm_s2: float = field(
        default=1000.0, metadata=option(ACCELERATION, "of the axes, for the model acceleration")
    )
    corner_deviation_mm: float = field(
        default=0.05, metadata=option(over_zero(LENGTH), "how far a corner may be rounded to take it faster")
    )
