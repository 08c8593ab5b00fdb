"""What a profile says of the ways to cut a contour."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.encoder.candidates.candidate import Narrow
from kerfwise.rules.options.members import Members
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Choice
from kerfwise.rules.options.quantities import LENGTH


@dataclass(frozen=True, slots=True)
class Links:
    """Ways through waste from one contour to the next with the torch on."""

    longest_mm: float = field(default=0.0, metadata=option(LENGTH, "longest link; 0 mm: none"))


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
    links: Links = field(
        default=Links(), metadata=option(Members(Links), "ways through waste from one contour to the next, torch on")
    )
