"""What a profile says of the ways to cut a contour."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, get_args

from kerfwise.encoder.cut import Side
from kerfwise.encoder.narrow import Narrow
from kerfwise.rules.options.members import Members
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Choice, Flag
from kerfwise.rules.options.quantities import LENGTH, OrWord, over_zero


@dataclass(frozen=True, slots=True)
class Links:
    """Ways through waste from one contour to the next with the torch on."""

    longest_mm: float = field(default=0.0, metadata=option(LENGTH, "longest link; 0 mm: none"))


GoodSide = Literal["part", "any"]


@dataclass(frozen=True, slots=True)
class Common:
    """Straight edges of two parts, one kerf apart, that are cut once."""

    shortest_mm: float | None = field(
        default=None,
        metadata=option(OrWord(over_zero(LENGTH), "off"), "cut common edges once, where one is as long as this"),
    )
    gap_tolerance_mm: float = field(
        default=0.05, metadata=option(LENGTH, "how much more or less than a kerf may lie between common edges")
    )
    good_side: GoodSide = field(
        default="part",
        metadata=option(
            Choice(("part", "any")), "where directions are fixed: refuse common cuts, or let one part have the bad side"
        ),
    )
    accept_loss: bool = field(
        default=False,
        metadata=option(Flag(), "cut edges that touch once, too: each part loses half a kerf along them"),
    )


@dataclass(frozen=True, slots=True)
class Scrap:
    """Lines in the skeleton that are made, not drawn."""

    grid_mm: float | None = field(
        default=None,
        metadata=option(
            OrWord(over_zero(LENGTH), "off"), "cut the skeleton into pieces no larger than this, either way"
        ),
    )
    remnant: Side | None = field(
        default=None,
        metadata=option(
            Choice(("off", *get_args(Side)), none="off"), "save the largest unused rectangle along this side"
        ),
    )


PiercePass = Literal["zone", "sheet"]


@dataclass(frozen=True, slots=True)
class Cuts:
    """Ways to cut what the torch cannot follow as it is drawn."""

    narrow: Narrow = field(
        default="ask",
        metadata=option(
            Choice(get_args(Narrow)),
            "a slot narrower than the kerf: cut straight across its mouth (leave), open it by one pass along its "
            "middle, a kerf wide (slit), or refuse the nest; ask leaves those up to two kerfs deep, and asks else",
        ),
    )
    scrap: Scrap = field(default=Scrap(), metadata=option(Members(Scrap), "lines that cut up the skeleton, made"))
    links: Links = field(
        default=Links(), metadata=option(Members(Links), "ways through waste from one contour to the next, torch on")
    )
    pierce_pass: PiercePass | None = field(
        default=None,
        metadata=option(
            Choice(("off", *get_args(PiercePass)), none="off"),
            "pierce all holes of each zone, or of the sheet, before the cuts that begin there",
        ),
    )
    common: Common = field(
        default=Common(), metadata=option(Members(Common), "straight edges of two parts, a kerf apart, cut once")
    )
