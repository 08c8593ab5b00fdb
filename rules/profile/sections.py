"""The sections of a plant's profile: every key a profile can have, with its unit, default and one line of help."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

from kerfwise.encoder.bevels.bevel import Bevel
from kerfwise.encoder.candidates.candidate import LeadKind
from kerfwise.encoder.cut import Side
from kerfwise.encoder.narrow_features import Narrow
from kerfwise.encoder.questions import Answers
from kerfwise.encoder.readers.layers import DEFAULT as LAYERS
from kerfwise.encoder.readers.layers import PURPOSES, Purpose
from kerfwise.encoder.readers.options import QUANTITY, UNITS, FrameName, OpenLines, ScrapLines
from kerfwise.encoder.small_holes import HoleLimits, Under
from kerfwise.encoder.torch_path import CornerFeed
from kerfwise.rules.options.kind import AnswerPairs, Choice, Flag, Number, Pairs, Text
from kerfwise.rules.options.option import Members, options_of, setting
from kerfwise.rules.options.quantities import (
    LEAD,
    LENGTH,
    LENGTH_BY_THICKNESS,
    ByThickness,
    OrWord,
    Thicknesses,
    length_at,
    likely,
    positive,
)
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import RuleSetting

from .bevel_section import BevelPairs, BevelSection
from .plant_sections import Heat, Machine, Material, Prices
from .time_section import Time

__all__ = [
    "SECTIONS",
    "Distortion",
    "DrawingSection",
    "LeadsSection",
    "Machine",
    "Material",
    "Objective",
    "RuleSetting",
    "default_settings",
]


# What a profile says of the ways to cut a contour.


@dataclass(frozen=True, slots=True)
class Links:
    """Ways through waste from one contour to the next with the torch on."""

    longest_mm: float = setting(0.0, likely(LENGTH, 0.0, 10_000.0), "longest link; 0 mm: none", named=(30.0,))


GoodSide = Literal["part", "any"]


@dataclass(frozen=True, slots=True)
class Common:
    """Straight edges of two parts, one kerf apart, that are cut once."""

    shortest_mm: float | None = setting(
        None,
        OrWord(likely(positive(LENGTH), 0.1, 1e4), "off"),
        "cut common edges once, where one is as long as this",
        named=(20.0,),
    )
    gap_tolerance_mm: float = setting(
        0.05, likely(LENGTH, 0.0, 20.0), "how much more or less than a kerf may lie between common edges"
    )
    good_side: GoodSide = setting(
        "part",
        Choice(("part", "any")),
        "where directions are fixed: refuse common cuts, or let one part have the bad side",
    )
    accept_loss: bool = setting(False, Flag(), "cut edges that touch once, too: each part loses half a kerf along them")


@dataclass(frozen=True, slots=True)
class Scrap:
    """Lines in the skeleton that are made, not drawn."""

    grid_mm: float | None = setting(
        None,
        OrWord(likely(positive(LENGTH), 20.0, 1e5), "off"),
        "cut the skeleton into pieces no larger than this, either way",
        named=(500.0,),
    )
    remnant: Side | None = setting(
        None,
        Choice(("off", *get_args(Side)), none="off"),
        "save the largest unused rectangle along this side",
        named=(None,),
    )


@dataclass(frozen=True, slots=True)
class Snake:
    """Rows of neighbours that are cut out along one side of each, with the torch on, and back along the other."""

    gap_mm: float | None = setting(
        None,
        OrWord(likely(positive(LENGTH), 0.1, 1e3), "off"),
        "neighbours in a row are no further apart than this",
        named=(20.0,),
    )
    parts: int = setting(2, Number(2, 1000, whole=True), "so many parts make a row, at the least")
    rows: int = setting(1, Number(1, 1000, whole=True), "one way goes through so many rows, at the most")


@dataclass(frozen=True, slots=True)
class Split:
    """Rounds that are cut in two stretches."""

    halves: float | None = setting(
        None, OrWord(Number(1.5, 1000), "off"), "strips are cut in two halves where their sides have this ratio or more"
    )
    last_mm: float | None = setting(
        None,
        OrWord(likely(positive(LENGTH), 1.0, 1e3), "off"),
        "so much of each part is cut last, when all of its zone hang by such a stretch",
    )
    shared_last: bool = setting(
        False,
        Flag(),
        "two parts a kerf apart are cut round together, the edge that they share when all of the zone hang so",
    )


PiercePass = Literal["zone", "sheet"]


@dataclass(frozen=True, slots=True)
class Cuts:
    """Ways to cut what the torch cannot follow as it is drawn."""

    narrow: Narrow = setting(
        "ask",
        Choice(get_args(Narrow)),
        "a slot narrower than the kerf: cut straight across its mouth (leave), open it by one pass along its "
        "middle, a kerf wide (slit), or refuse the nest; ask leaves those up to two kerfs deep, and asks else",
    )
    scrap: Scrap = setting(Scrap(), Members(Scrap), "lines that cut up the skeleton, made")
    links: Links = setting(Links(), Members(Links), "ways through waste from one contour to the next, torch on")
    pierce_pass: PiercePass | None = setting(
        None,
        Choice(("off", *get_args(PiercePass)), none="off"),
        "pierce all holes of each zone, or of the sheet, before the cuts that begin there",
    )
    common: Common = setting(Common(), Members(Common), "straight edges of two parts, a kerf apart, cut once")
    snake: Snake = setting(Snake(), Members(Snake), "rows of neighbours, cut out along one side and back")
    split: Split = setting(Split(), Members(Split), "rounds that are cut in two stretches")
    bevel: BevelSection = setting(BevelSection(), Members(BevelSection), "bevels, cut by a head that tilts")

    @property
    def in_stretches(self) -> str:
        """The group that has contours cut in several stretches; "" where none does."""
        if self.snake.gap_mm is not None:
            return "snake"
        return "split" if self.split != Split() else ""


# What a profile says of corners: feeds there, and how much of them a round kerf may leave.


@dataclass(frozen=True, slots=True)
class Corners:
    """How much slower the torch goes round corners, and how much of an inner corner it may leave."""

    corner_feed: float = setting(1.0, Number(0.05, 1), "share of the cut feed near a corner; 1 for all of it")
    corner_angle: float = setting(45.0, Number(10, 180), "from how many degrees on a turn of the path is a corner")
    corner_reach: ByThickness = setting(
        Thicknesses(0.5), likely(LENGTH_BY_THICKNESS, 0.0, 500.0), "how far before and behind a corner it goes slower"
    )
    leave_mm: float | None = setting(
        None,
        OrWord(likely(LENGTH, 0.0, 100.0), "any"),
        "how much of an inner corner the round kerf may leave; more is refused",
    )

    def law(self, thickness_mm: float) -> CornerFeed | None:
        """The feeds on a sheet of that thickness; None where corners are cut like the rest."""
        reach_mm = length_at(self.corner_reach, thickness_mm)
        if self.corner_feed >= 1 or reach_mm <= 0:
            return None
        return CornerFeed(self.corner_feed, self.corner_angle, reach_mm)


# What a profile says of holes that are small for its process.


@dataclass(frozen=True, slots=True)
class SmallHoles:
    """From which diameter on a hole is cut, what is done with smaller ones, and how fast small ones are cut."""

    min_hole: ByThickness = setting(
        Thicknesses(1.0), likely(LENGTH_BY_THICKNESS, 0.0, 500.0), "least diameter, or width, of a hole that is cut"
    )
    under: Under = setting(
        "ask",
        Choice(("ask", "refuse", "spot", "skip")),
        "a hole under min_hole, or without room for a pierce: ask, refuse the nest, mark its middle, leave it out",
    )
    full_feed_hole: ByThickness = setting(
        Thicknesses(5.0),
        likely(LENGTH_BY_THICKNESS, 0.0, 5000.0),
        "diameter from which on a hole is cut at the full cut feed",
    )
    small_hole_feed: float = setting(
        1.0, Number(0.05, 1), "share of the cut feed at min_hole; it rises in a line to full_feed_hole"
    )
    spot_size_mm: float = setting(
        2.0, likely(positive(LENGTH), 0.05, 500.0), "size of the cross that marks the middle of a hole"
    )

    def limits(self, thickness_mm: float, clearance_mm: float) -> HoleLimits:
        """The limits in mm, on a sheet of that thickness, where a pierce keeps `clearance_mm` from every contour."""
        return HoleLimits(
            least_mm=length_at(self.min_hole, thickness_mm),
            under=self.under,
            room_mm=2 * clearance_mm,
            full_feed_mm=length_at(self.full_feed_hole, thickness_mm) if self.small_hole_feed < 1 else 0.0,
            feed_share=self.small_hole_feed,
            spot_mm=self.spot_size_mm,
        )


# What a profile says of making nests: how far parts lie from each other and from the edge of the sheet.


@dataclass(frozen=True, slots=True)
class Nesting:
    """How `kerfwise nest` lays parts on sheets."""

    web_mm: ByThickness = setting(
        Thicknesses(1.0), likely(LENGTH_BY_THICKNESS, 0.0, 1000.0), "metal left between two parts; a kerf comes to it"
    )
    edge_mm: ByThickness = setting(
        10.0, likely(LENGTH_BY_THICKNESS, 0.0, 5000.0), "least distance of parts from the edge of the sheet"
    )


_LEADS = Choice(("line", "arc", "none"))


@dataclass(frozen=True, slots=True)
class LeadsSection:
    """How the torch joins and leaves a contour."""

    entries: int = setting(8, Number(1, 1000, whole=True), "entries tried on each contour")
    lead: LeadKind = setting("line", _LEADS, "shape of the lead-in")
    lead_in_mm: ByThickness = setting(
        6.0, likely(LENGTH_BY_THICKNESS, 0.0, 500.0), "length of the lead-in where there is room"
    )
    lead_in_min_mm: float = setting(1.0, LEAD, "shortest lead-in where there is not")
    lead_out: LeadKind = setting("none", _LEADS, "shape of the lead-out")
    lead_out_length_mm: float = setting(2.0, LEAD, "length of the lead-out")
    hole_overcut_mm: ByThickness = setting(
        1.0, likely(LENGTH_BY_THICKNESS, 0.0, 50.0), "how far a hole is cut past its entry"
    )
    edge_start: bool = setting(False, Flag(), "whether to come in from the sheet edge, unpierced, where that is near")


_LAYER = Text(pattern=True)
_LOOKS = Pairs(PURPOSES)


@dataclass(frozen=True, slots=True)
class LayerMap:
    """What the layers of a drawing are for: regular expressions, searched without regard to case."""

    cut: str = setting(LAYERS.cut, _LAYER, "layers that are cut; others are asked about, once given")
    mark: str = setting(LAYERS.mark, _LAYER, "layers that are marked, not cut through")
    ignore: str = setting(LAYERS.ignore, _LAYER, "layers that are left out")
    sheet: str = setting(LAYERS.sheet, _LAYER, "layers that hold the sheet")
    scrap: str = setting(LAYERS.scrap, _LAYER, "layers of lines that cut up scrap")
    bridge: str = setting(LAYERS.bridge, _LAYER, "layers of rectangles, each a bridge between two parts")
    tab: str = setting(LAYERS.tab, _LAYER, "layers of short lines, each a tab of a part")
    colour: tuple[tuple[str, Purpose], ...] = setting(
        (), _LOOKS, "what lines of a colour are for, as in {red: cut, '#0000ff': mark}"
    )
    linetype: tuple[tuple[str, Purpose], ...] = setting(
        (), _LOOKS, "what lines of a type are for, as in {dashed: mark, CENTER: ignore}"
    )
    bevel: tuple[tuple[str, Bevel], ...] = setting(
        (),
        BevelPairs(),
        "layers (regular expressions) or colours whose closed lines have a bevel, as in {'^V45$': V 45 top}",
    )


@dataclass(frozen=True, slots=True)
class DrawingSection:
    """How drawings of nests are read."""

    units: str | None = setting(
        None,
        Choice(("auto", *UNITS), none="auto"),
        "units of the drawing (auto: what the file says, else that is asked)",
    )
    layers: LayerMap = setting(LayerMap(), Members(LayerMap), "what layers are for (regular expressions)")
    frame: FrameName | None = setting(
        None,
        Choice(("ask", *get_args(FrameName)), none="ask"),
        "what one rectangle around everything is, where no layer is the sheet's",
    )
    open_lines: OpenLines = setting(
        "mark", Choice(get_args(OpenLines)), "what becomes of open lines on layers that layers.cut names"
    )
    scrap_lines: ScrapLines = setting(
        "ignore", Choice(get_args(ScrapLines)), "what becomes of lines on layers that layers.scrap names"
    )
    answers: Answers = setting((), AnswerPairs(), "answers to questions that drawings raise, as in {frame: sheet}")
    quantity: str = setting(
        QUANTITY,
        Text(pattern=True, grouped=True),
        "how names of blocks, layers and files say how many: the number is a group of it",
    )
    margin_mm: float = setting(
        10.0, likely(LENGTH, 0.0, 10_000.0), "room around the parts where the drawing has no sheet"
    )
    join_tolerance_mm: float = setting(0.1, likely(positive(LENGTH), 1e-5, 50.0), "loose ends this near are joined")
    refit_arcs_mm: float | None = setting(
        None,
        OrWord(likely(positive(LENGTH), 1e-5, 10.0), none="off"),
        "flattened outlines become arcs again that stay this near to them",
    )


@dataclass(frozen=True, slots=True)
class Distortion:
    """How far parts may be off when they are cold, by simulation."""

    predict: bool = setting(False, Flag(), "solve predicts how far the parts will be off, and prints a line")
    tolerance_mm: float | None = setting(
        None,
        OrWord(likely(positive(LENGTH), 1e-3, 500.0), none="off"),
        "most that a part may be off; a part's key `tolerance` in the nest goes before it",
    )
    keep_tolerance: bool = setting(False, Flag(), "solve refuses a plan that leaves a part beyond its tolerance")


@dataclass(frozen=True, slots=True)
class Objective:
    """What a plan's cost is made of, in mm of idle travel."""

    idle: float = setting(1.0, Number(0), "cost of a millimetre of idle travel")
    heat: float = setting(0.0, Number(0), "cost of a point overheated")
    time: float = setting(0.0, Number(0), "cost of a second of idle travel, piercing or leads")
    completion: float = setting(
        0.0,
        Number(0),
        "cost of a second that a part waits, for each class of parts (priority, due) that may wait longer",
    )
    distortion: float = setting(0.0, Number(0), "cost of a mm that parts are off, mean of their worst places")


def named_in_group(group: Any, names: Collection[str]) -> Any:
    """A group of options that a profile has: on, where neither it nor a profile that it is based on says by what.

    `names` are the keys that stand in it.

    Examples
    --------
    >>> named_in_group(Links(), ()), named_in_group(Links(), ("longest",)), named_in_group(Scrap(remnant="right"), ())
    (Links(longest_mm=30.0), Links(longest_mm=0.0), Scrap(grid_mm=None, remnant='right'))
    """
    switches = [o for o in options_of(group) if o.named]
    if any(o.key in names or getattr(group, o.name) != o.default for o in switches):
        return group
    return replace(group, **{o.name: o.named[0] for o in switches})


def default_settings() -> dict[str, RuleSetting]:
    """Every rule of the catalogue as it is where a profile says nothing of it."""
    return {
        name: RuleSetting(rule.default, rule.default_weight if rule.default == "soft" else None, rule.Options())
        for name, rule in RULES.items()
    }


SECTIONS: Mapping[str, type] = {
    "machine": Machine,
    "material": Material,
    "leads": LeadsSection,
    "small_holes": SmallHoles,
    "corners": Corners,
    "cuts": Cuts,
    "nesting": Nesting,
    "drawing": DrawingSection,
    "objective": Objective,
    "time": Time,
    "prices": Prices,
    "heat": Heat,
    "distortion": Distortion,
}
"""Key in a profile → the dataclass of what stands under it."""
