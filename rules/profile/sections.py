"""The sections of a plant's profile: every key a profile can have, with its unit, default and one line of help."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import get_args

from kerfwise.encoder.candidates.candidate import LeadKind
from kerfwise.encoder.questions import Answers
from kerfwise.encoder.readers.layers import DEFAULT as LAYERS
from kerfwise.encoder.readers.layers import PURPOSES, Purpose
from kerfwise.encoder.readers.options import FrameName, OpenLines, ScrapLines
from kerfwise.encoder.readers.units import UNITS
from kerfwise.rules.options.by_thickness import LENGTH_BY_THICKNESS, ByThickness
from kerfwise.rules.options.members import Members
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Choice, Flag, Number, Pairs, Text
from kerfwise.rules.options.quantities import LENGTH, OrWord, over_zero
from kerfwise.rules.profile.cuts_section import Cuts
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import RuleSetting

from .corners_section import Corners
from .heat_section import Heat
from .machine_section import Machine
from .material_section import Material
from .nesting_section import Nesting
from .prices_section import Prices
from .small_holes_section import SmallHoles
from .time_section import Time

_LEADS = Choice(("line", "arc", "none"))


@dataclass(frozen=True, slots=True)
class LeadsSection:
    """How the torch joins and leaves a contour."""

    entries: int = field(default=8, metadata=option(Number(1, 1000, whole=True), "entries tried on each contour"))
    lead: LeadKind = field(default="line", metadata=option(_LEADS, "shape of the lead-in"))
    lead_in_mm: ByThickness = field(
        default=6.0, metadata=option(LENGTH_BY_THICKNESS, "length of the lead-in where there is room")
    )
    lead_in_min_mm: float = field(default=1.0, metadata=option(LENGTH, "shortest lead-in where there is not"))
    lead_out: LeadKind = field(default="none", metadata=option(_LEADS, "shape of the lead-out"))
    lead_out_length_mm: float = field(default=2.0, metadata=option(LENGTH, "length of the lead-out"))
    hole_overcut_mm: ByThickness = field(
        default=1.0, metadata=option(LENGTH_BY_THICKNESS, "how far a hole is cut past its entry")
    )
    edge_start: bool = field(
        default=False, metadata=option(Flag(), "whether to come in from the sheet edge, unpierced, where that is near")
    )


_LAYER = Text(pattern=True)
_LOOKS = Pairs(PURPOSES)


@dataclass(frozen=True, slots=True)
class LayerMap:
    """What the layers of a drawing are for: regular expressions, searched without regard to case."""

    cut: str = field(
        default=LAYERS.cut, metadata=option(_LAYER, "layers that are cut; others are asked about, once given")
    )
    mark: str = field(default=LAYERS.mark, metadata=option(_LAYER, "layers that are marked, not cut through"))
    ignore: str = field(default=LAYERS.ignore, metadata=option(_LAYER, "layers that are left out"))
    sheet: str = field(default=LAYERS.sheet, metadata=option(_LAYER, "layers that hold the sheet"))
    scrap: str = field(default=LAYERS.scrap, metadata=option(_LAYER, "layers of lines that cut up scrap"))
    bridge: str = field(
        default=LAYERS.bridge, metadata=option(_LAYER, "layers of rectangles, each a bridge between two parts")
    )
    tab: str = field(default=LAYERS.tab, metadata=option(_LAYER, "layers of short lines, each a tab of a part"))
    colour: tuple[tuple[str, Purpose], ...] = field(
        default=(), metadata=option(_LOOKS, "what lines of a colour are for, as in {red: cut, '#0000ff': mark}")
    )
    linetype: tuple[tuple[str, Purpose], ...] = field(
        default=(), metadata=option(_LOOKS, "what lines of a type are for, as in {dashed: mark, CENTER: ignore}")
    )


@dataclass(frozen=True, slots=True)
class DrawingSection:
    """How drawings of nests are read."""

    units: str | None = field(
        default=None,
        metadata=option(
            Choice(("auto", *UNITS), none="auto"), "units of the drawing (auto: what the file says, else that is asked)"
        ),
    )
    layers: LayerMap = field(
        default=LayerMap(), metadata=option(Members(LayerMap), "what layers are for (regular expressions)")
    )
    frame: FrameName | None = field(
        default=None,
        metadata=option(
            Choice(("ask", *get_args(FrameName)), none="ask"),
            "what one rectangle around everything is, where no layer is the sheet's",
        ),
    )
    open_lines: OpenLines = field(
        default="mark",
        metadata=option(Choice(get_args(OpenLines)), "what becomes of open lines on layers that layers.cut names"),
    )
    scrap_lines: ScrapLines = field(
        default="ignore",
        metadata=option(Choice(get_args(ScrapLines)), "what becomes of lines on layers that layers.scrap names"),
    )
    answers: Answers = field(
        default=(), metadata=option(Pairs(), "answers to questions that drawings raise, as in {frame: sheet}")
    )
    margin_mm: float = field(
        default=10.0, metadata=option(LENGTH, "room around the parts where the drawing has no sheet")
    )
    join_tolerance_mm: float = field(default=0.1, metadata=option(over_zero(LENGTH), "loose ends this near are joined"))
    refit_arcs_mm: float | None = field(
        default=None,
        metadata=option(
            OrWord(over_zero(LENGTH), none="off"), "flattened outlines become arcs again that stay this near to them"
        ),
    )


@dataclass(frozen=True, slots=True)
class Objective:
    """What a plan's cost is made of, in mm of idle travel."""

    idle: float = field(default=1.0, metadata=option(Number(0), "cost of a millimetre of idle travel"))
    heat: float = field(default=0.0, metadata=option(Number(0), "cost of a point overheated"))
    time: float = field(default=0.0, metadata=option(Number(0), "cost of a second of idle travel, piercing or leads"))


def default_settings() -> dict[str, RuleSetting]:
    """Every rule of the catalogue as it is where a profile says nothing of it."""
    return {
        name: RuleSetting(rule.default, rule.default_weight if rule.default == "soft" else None, rule.Options())
        for name, rule in RULES.items()
    }


__all__ = [
    "SECTIONS",
    "DrawingSection",
    "LeadsSection",
    "Machine",
    "Material",
    "Objective",
    "RuleSetting",
    "default_settings",
]

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
}
"""Key in a profile → the dataclass of what stands under it."""
