"""A candidate: one way to cut a contour. And the options that decide which candidates there are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from kerfwise.encoder.cut import Cut, Direction, Span, Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.narrow_features import Narrow
from kerfwise.encoder.nest import CONTOUR_KINDS, Contour, Kind
from kerfwise.encoder.small_holes import HoleLimits
from kerfwise.encoder.torch_path import CornerFeed, TabOptions

from .tab_places import TabPlaces

LeadKind = Literal["line", "arc", "none"]

LEAST_WASTE_MM = 0.01
"""Waste between the kerf of a pierce and every contour, at the least."""


@dataclass(frozen=True, slots=True)
class CommonOptions:
    """Which edges two parts have in common: so long at the least, and so near to one kerf apart, mm.

    With `kerf_start` the torch is lit in the old kerf and moves on at once; else it waits there as at a pierce.
    `corners` are cut slower, where they are. With `mouths_first` parts in the concavity of another are cut before that.
    """

    shortest_mm: float
    gap_mm: float
    kerf_start: bool = True
    corners: CornerFeed | None = None
    mouths_first: bool = False


@dataclass(frozen=True, slots=True)
class LeadOptions:
    """How torch paths join a contour. Lengths in mm, measured along the lead.

    The lead is made as long as `lead_in_mm` where there is room, shorter down to `lead_in_min_mm` where there is
    not; `pierce_clearance_mm` is the least distance from the pierce point to every contour (rule `pierce`), `splash_mm`
    the metal between the pierced hole and older kerfs, None where nobody asks for any. With lead "none" the torch
    pierces on its path, and only other contours have to be that far.

    `reach` is what the torch can go to (least X and Y, most X and Y); None where nobody has said. With `edge_start` the
    torch may come in from the edge of the sheet where that is within `2 * lead_in_mm`; never from an edge that was only
    assumed (`Sheet.stated`), and only where `reach` says that the machine gets there. `entry_points` are entries that
    must be among the candidates, at the point of the contour nearest to the one given. Holes under the limit of
    `holes` are refused. `narrow` says what is done with slots that the kerf does not enter, and `corner_mm` how much a
    round kerf may leave of a corner, None for any.
    `tabs` say which parts have tabs, None where none have; `tab_places` where these are, once that is known. `common`
    says which edges of two parts are cut once, None for none.
    """

    entries: int = 8
    kerf_mm: float = 1.5
    lead: LeadKind = "line"
    lead_in_mm: float = 6.0
    lead_in_min_mm: float = 1.0
    lead_out: LeadKind = "none"
    lead_out_mm: float = 2.0
    pierce_clearance_mm: float = 1.0
    splash_mm: float | None = 0.5
    hole_overcut_mm: float = 1.0
    edge_start: bool = False
    reach: tuple[float, float, float, float] | None = None
    directions: Mapping[Kind, tuple[Direction, ...]] = field(
        default_factory=lambda: dict.fromkeys(CONTOUR_KINDS, ("cw", "ccw"))
    )
    entry_points: Mapping[str, Point] = field(default_factory=dict)
    holes: HoleLimits = field(default_factory=HoleLimits)
    narrow: Narrow = "ask"
    corner_mm: float | None = None
    tabs: TabOptions | None = None
    tab_places: TabPlaces | None = None
    common: CommonOptions | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Candidate:
    """One way to cut a contour.

    `contour` is the index into `Nest.contours`; `entry_mm` the path length of the entry along the contour as drawn;
    `end` the point where the torch is switched off. `edge_start` says that the torch comes in from the sheet edge
    and nothing is pierced. `cut_mm` is the torch-on path length, leads and overcut included.

    `lead_out` begins where `lead_in` ends; for an open mark or a slit it is the far end of the line alone. `leaves`
    says that its last piece is a lead into the waste; else it is overcut, if anything. `tabs` stay uncut; `cut_mm` is
    without them. Before one at the end of the round the torch goes off, and `lead_out` is that place alone.

    One with a `span` follows that stretch of its contour alone, `along_mm` of it as drawn, from one old kerf to
    another: with `kerf_start` nothing is pierced. It may be used once the contours `out` are cut, and while those of
    `still_in` are not (ids of neighbours with common edges). One that goes all round such a contour has neighbours
    that are still in, too. Slower corners take as long as `corner_mm` more of it would; None: as those of the whole
    contour.
    """

    contour: int
    entry_mm: float
    entry: Point
    direction: Direction
    pierce: Point
    lead_in: Curve | None
    lead_out: Curve | None
    end: Point
    cut_mm: float
    edge_start: bool = False
    leaves: bool = False
    tabs: tuple[Tab, ...] = ()
    span: Span | None = None
    along_mm: float | None = None
    kerf_start: bool = False
    out: tuple[str, ...] = ()
    still_in: tuple[str, ...] = ()
    corner_mm: float | None = None

    def at_corners_mm(self, contour: Contour) -> float:
        """How much longer than at the full feed this way round its contour takes, as a length, mm."""
        return contour.corner_mm if self.corner_mm is None else self.corner_mm

    @property
    def join(self) -> Point:
        """Where the torch joins the contour's ring."""
        return self.pierce if self.lead_in is None else self.lead_in.end

    @property
    def unpierced(self) -> bool:
        """Whether the torch begins where there is no metal to pierce: off the sheet's edge, or in an old kerf."""
        return self.edge_start or self.kerf_start

    def as_cut(self, name: str, zone: int = 0) -> Cut:
        """The cut of the contour of that name that it makes."""
        return Cut(
            name,
            self.entry,
            self.direction,
            self.pierce,
            self.lead_in,
            self.lead_out,
            zone,
            span=self.span,
            tabs=self.tabs,
        )
