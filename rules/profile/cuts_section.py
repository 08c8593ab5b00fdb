"""What a profile says of the ways to cut a contour."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.encoder.candidates.candidate import Narrow
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Choice


@dataclass(frozen=True, slots=True)
class Cuts:
    """Ways to cut what the torch cannot follow as it is drawn."""

    narrow: Narrow = field(
        default="refuse",
        metadata=option(
            Choice(("refuse", "slit")),
            "a slot narrower than the kerf: refuse the nest, or open it by one pass along its middle, a kerf wide",
        ),
    )
