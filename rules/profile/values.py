"""What stands in a profile, section by section, and what it says by that alone: places, feeds, techniques asked for."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import shapely

from kerfwise.encoder.bevels.cut_nest import BevelOptions, Block
from kerfwise.encoder.candidates.candidate import CommonOptions
from kerfwise.encoder.geometry.segment import Box, Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.nest import Nest, Part
from kerfwise.encoder.torch_path import CornerFeed
from kerfwise.rules.charts.chart import family_of
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.quantities import ByThickness, length_at
from kerfwise.rules.outside import PythonFile
from kerfwise.rules.own import Own
from kerfwise.rules.rule import Plant, Plate, Rule

from .linked_files import ChartUse, ModelSource
from .plant_sections import MATERIALS, Heat, KeptOfThickness, Machine, Material, Origin, Prices
from .sections import (
    Corners,
    Cuts,
    Distortion,
    DrawingSection,
    LeadsSection,
    Nesting,
    Objective,
    RuleSetting,
    SmallHoles,
    default_settings,
)
from .time_section import LawLeft, Time

_STEP_MM = 1e-3


@dataclass(frozen=True)
class ProfileValues:
    """What a plant fixes beforehand, without what its rules make of it: see `Profile`."""

    name: str
    machine: Machine = field(default_factory=Machine)
    material: Material = field(default_factory=Material)
    leads: LeadsSection = field(default_factory=LeadsSection)
    drawing: DrawingSection = field(default_factory=DrawingSection)
    rules: Mapping[str, RuleSetting] = field(default_factory=default_settings)
    objective: Objective = field(default_factory=Objective)
    locks: tuple[Lock, ...] = ()
    own_rules: tuple[Own, ...] = ()
    python: tuple[PythonFile, ...] = ()
    models: tuple[ModelSource, ...] = ()
    further_rules: Mapping[str, Rule[Any]] = field(default_factory=dict)
    time: Time = field(default_factory=Time)
    prices: Prices = field(default_factory=Prices)
    heat: Heat = field(default_factory=Heat)
    distortion: Distortion = field(default_factory=Distortion)
    small_holes: SmallHoles = field(default_factory=SmallHoles)
    corners: Corners = field(default_factory=Corners)
    cuts: Cuts = field(default_factory=Cuts)
    nesting: Nesting = field(default_factory=Nesting)
    chart: ChartUse | None = field(default=None, compare=False)
    law_left: LawLeft | None = field(default=None, compare=False)
    kept: KeptOfThickness | None = field(default=None, compare=False)
    said_at: Mapping[str, str] = field(default_factory=dict, compare=False)
    sha256: str = field(default="", compare=False)
    file: str = field(default="", compare=False)
    read_from: tuple[str, ...] = field(default=(), compare=False)
    for_one_nest: ForOneNest | None = field(default=None, compare=False)

    def at_origin(self, origin: Origin) -> Self:
        """The profile with the machine's zero where a plan or program says that it has it."""
        return self if origin == self.machine.origin else replace(self, machine=replace(self.machine, origin=origin))

    def at_spacing(self, spacing_mm: float | None) -> Self:
        """The profile with torches where a plan or program says that they stand, where they can be moved there."""
        torches = self.machine.torches
        most_mm = torches.up_to_mm
        if (
            spacing_mm is None
            or most_mm is None
            or not torches.spacing_mm - _STEP_MM <= spacing_mm <= most_mm + _STEP_MM
        ):
            return self
        moved = replace(torches, spacing_mm=spacing_mm, up_to_mm=None)
        return replace(self, machine=replace(self.machine, torches=moved))

    def length_mm(self, length: ByThickness) -> float:
        """A length that may go with the thickness, as it is for the profile's material."""
        return length_at(length, self.material.thickness_mm)

    def frame_on(self, nest: Nest) -> Frame:
        """The machine's coordinates on the nest."""
        return frame_of(nest, self.machine)

    @property
    def prices_overheats(self) -> bool:
        """Whether overheats cost something, and a torch heats the sheet: then orders are simulated."""
        return bool(self.objective.heat and self.heat.absorbed_power_w)

    def home_on(self, nest: Nest) -> Point:
        """The machine's home in the coordinates of the nest's drawing."""
        return frame_of(nest, self.machine).on_drawing(self.machine.home)

    def reach_on(self, nest: Nest) -> Box | None:
        """What the torch can go to, in the coordinates of the nest's drawing; None where the profile says nothing."""
        return reach_of(nest, self.machine)

    def common_options(self) -> CommonOptions | None:
        """Which edges two parts have in common; None where none are to be cut once."""
        common = self.cuts.common
        if common.shortest_mm is None:
            return None
        return CommonOptions(common.shortest_mm, common.gap_tolerance_mm, self.machine.kerf_start, self.corner_feed())

    @property
    def kerf_starts(self) -> bool:
        """Whether cuts may begin in the kerf of an older one, without a wait for a pierce."""
        offered = self.common_options() is not None or bool(self.cuts.in_stretches)
        return offered and self.machine.kerf_start

    @property
    def longest_link_mm(self) -> float:
        """The longest way through waste with the torch on: a link, or one in a way; 0 where there are none."""
        over_mm = self.material.kerf_mm + tolerance_mm(self.material.kerf_mm) if self.cuts.split.shared_last else 0.0
        return max(self.cuts.links.longest_mm, self.cuts.snake.gap_mm or 0.0, over_mm)

    def bevel_options(self) -> BevelOptions | None:
        """How bevels are cut; None where the machine has no head that tilts."""
        bevel, material = self.cuts.bevel, self.material
        if bevel.head is None:
            return None
        upright = () if bevel.kerfs and bevel.kerfs[0][0] == 0 else ((0.0, material.kerf_mm),)
        return BevelOptions(
            material.thickness_mm,
            (*upright, *bevel.kerfs),
            bevel.corner,
            bevel.run_mm,
            bevel.most_turn,
            bevel.lies_still,
            self.plant.plate.density_kg_m3,
            Block(bevel.apart_mm, bevel.left) if bevel.head == "block" else None,
        )

    def corner_feed(self) -> CornerFeed | None:
        """The feeds at corners on this sheet; None where corners are cut like the rest."""
        return self.corners.law(self.material.thickness_mm)

    @property
    def plant(self) -> Plant:
        """What rules may know of the profile beside their own options."""
        return plant_of_sections(self.machine, self.material, self.heat, self.locks, self.cuts)

    def chart_notes(self) -> tuple[str, ...]:
        """What a planner would want to know of the material chart: what is interpolated, and what it is not asked."""
        return () if self.chart is None else tuple(self.chart.notes())

    def time_and_price_notes(self) -> tuple[str, ...]:
        """What a planner would want to know of times and prices: what does not hold, or is for another thickness."""
        feed_mm_s = self.machine.cut_feed_mm_s
        notes = [] if self.law_left is None else [self.law_left.told(feed_mm_s)]
        notes += self.time.quicker_than_its_words(feed_mm_s)
        if self.kept is not None:
            notes.append(self.kept.told(self.machine, self.material))
        half_given = list(self.prices.half_given(self.material.gas_flow_m3_h))
        if not (half_given or self.prices.given) and any(key.startswith("prices.") for key in self.said_at):
            half_given = ["prices: no price is given, so that no cost is told"]
        return (*notes, *half_given)


def plant_of_sections(machine: Machine, material: Material, heat: Heat, locks: tuple[Lock, ...], cuts: Cuts) -> Plant:
    """What rules may know of these sections."""
    return Plant(
        thickness_mm=material.thickness_mm,
        kerf_mm=material.kerf_mm,
        ambient_c=heat.ambient_c,
        heat_limit_c=heat.limit_c,
        absorbed_power_w=heat.absorbed_power_w,
        locks=locks,
        process=machine.process,
        common_cuts=cuts.common.shortest_mm is not None or bool(cuts.in_stretches),
        snakes=cuts.snake.gap_mm is not None,
        longest_link_mm=cuts.links.longest_mm,
        plate=Plate(
            thickness_mm=material.thickness_mm,
            material=material.name,
            process=machine.process,
            density_kg_m3=MATERIALS[heat.material].density,
            cut_mm_s=machine.cut_feed_mm_s,
            mark_mm_s=machine.mark_feed_mm_s,
            pierce_s=machine.pierce_time_s,
            mark_s=machine.mark_time_s,
        ),
    )


@dataclass(frozen=True, slots=True)
class ForOneNest:
    """What a plan was made with beside nest and profile: the job file by name and sha256, and what was said beside it.

    `settings` and `locks` are those of the command line (or of Python), in one line each, with the names of the nest.
    `numbered` says which contour each number stood for that the job file calls one by, such as `#7`. `said` is what
    stands at the top of the program and changes no plan: order, due, date and number.
    """

    file: str = ""
    sha256: str = ""
    settings: tuple[str, ...] = ()
    locks: tuple[str, ...] = ()
    numbered: Mapping[str, str] = field(default_factory=dict)
    said: Mapping[str, str] = field(default_factory=dict)

    def as_json(self) -> dict[str, Any]:
        """What a plan says of it."""
        source = {"file": self.file, "sha256": self.sha256} if self.file else {}
        overrides = {
            "set": list(self.settings), "locks": list(self.locks), "numbered": dict(self.numbered),
            "said": dict(self.said),
        }  # fmt: skip
        return source | {key: value for key, value in overrides.items() if value}

    @staticmethod
    def of_json(data: Mapping[str, Any]) -> ForOneNest:
        """The same, read back."""
        return ForOneNest(
            data.get("file", ""),
            data.get("sha256", ""),
            tuple(data.get("set", ())),
            tuple(data.get("locks", ())),
            dict(data.get("numbered", {})),
            dict(data.get("said", {})),
        )


def changed_since(then: ForOneNest | None, now: ForOneNest | None) -> Iterator[str]:
    """A sentence for each thing that a plan was made with, and is not given now, or the other way round.

    Examples
    --------
    >>> list(changed_since(ForOneNest("plate.job.yaml", "1a2b"), None))
    ['the plan was made with the job file plate.job.yaml, which is not given here']
    >>> list(changed_since(None, ForOneNest(settings=("leads.lead_in=4 mm",))))
    ['the plan was made without --set leads.lead_in=4 mm, which is given here']
    """
    then, now = then or ForOneNest(), now or ForOneNest()
    if then.sha256 and now.sha256 and then.sha256 != now.sha256:
        yield "the job file is not the one the plan was made with (its sha256 differs)"
    elif then.sha256 and not now.sha256:
        yield f"the plan was made with the job file {then.file}, which is not given here"
    elif now.sha256 and not then.sha256:
        yield f"the plan was made without the job file {now.file}, which is given here"
    for option, before, given in (("--set", then.settings, now.settings), ("--lock", then.locks, now.locks)):
        yield from (f"the plan was made with {option} {said}, which is not given here" for said in _only(before, given))
        yield from (f"the plan was made without {option} {said}, which is given here" for said in _only(given, before))


def _only(these: tuple[str, ...], those: tuple[str, ...]) -> Iterator[str]:
    return (one for one in these if one not in those)


# Where a sheet lies on its machine: from the drawing's coordinates, which plans keep to, to the machine's and back.
#
# The machine's coordinates are those of the drawing less the `corner`: (0, 0) where the machine's zero is the
# drawing's, the lower left corner of the sheet's bounding box where that corner is put at the machine's zero.

_DIGITS = 4


@dataclass(frozen=True, slots=True)
class Frame:
    """A machine's coordinates: `corner` is the point of the drawing that is its zero.

    Examples
    --------
    >>> frame = Frame((3000.0, 20.0))
    >>> frame.on_machine((3100.0, 50.0)), frame.on_drawing((0.0, 0.0))
    ((100.0, 30.0), (3000.0, 20.0))
    """

    corner: Point = (0.0, 0.0)

    def on_machine(self, point: Point) -> Point:
        """A point of the drawing, as the machine counts."""
        return point[0] - self.corner[0], point[1] - self.corner[1]

    def on_drawing(self, point: Point) -> Point:
        """A point of the machine, as the drawing counts."""
        return point[0] + self.corner[0], point[1] + self.corner[1]


def frame_of(nest: Nest, machine: Machine) -> Frame:
    """The machine's coordinates on this nest."""
    if machine.origin == "drawing":
        return Frame()
    x0, y0, _, _ = nest.sheet.bounds
    return Frame((round(x0, _DIGITS), round(y0, _DIGITS)))


def reach_of(nest: Nest, machine: Machine) -> Box | None:
    """What the torch can go to, in the drawing's coordinates: infinite the way that the profile does not say.

    None where it says nothing.
    """
    if machine.travel_x_mm is None and machine.travel_y_mm is None:
        return None
    (x0, x1), (y0, y1) = (span or (-math.inf, math.inf) for span in (machine.travel_x_mm, machine.travel_y_mm))
    frame = frame_of(nest, machine)
    return *frame.on_drawing((x0, y0)), *frame.on_drawing((x1, y1))


# What is said aloud about where a sheet lies on its machine, before anything is planned.

_SLACK_MM = 1e-6


def placing_notes(nest: Nest, profile: ProfileValues) -> Iterator[str]:
    """A sentence for each thing that a planner would want to know: a far home, a sheet that sticks out, no edge starts,
    parts of another thickness or metal.

    Examples
    --------
    >>> from kerfwise.encoder.geometry.curve import Curve
    >>> from kerfwise.encoder.nest import Sheet
    >>> far = Nest(Sheet(Curve.of([(3000, 0), (3080, 0), (3080, 80), (3000, 80)])), ())
    >>> [text.split(":")[0] for text in placing_notes(far, ProfileValues("shop"))]
    ["the sheet is 3000 mm from the machine's home, further than it is long (80 mm)"]
    """
    yield from _far_home(nest, profile)
    yield from _sticks_out(nest, profile)
    yield from _no_edge_starts(nest, profile)
    yield from _other_metal((nest.drawn or nest).parts, profile.material)


def _other_metal(parts: Sequence[Part], cut: Material) -> Iterator[str]:
    """Parts that say they are of another thickness, or of another metal, than the profile cuts."""
    kind, said = family_of(cut.name), [(part.id, part.attributes) for part in parts]
    others = {
        "thickness": [
            (name, f"{mm:g} mm")
            for name, of in said
            if isinstance(mm := of.get("thickness"), int | float) and abs(mm - cut.thickness_mm) > _STEP_MM
        ],
        "material": [
            (name, grade)
            for name, of in said
            if isinstance(grade := of.get("material"), str) and kind and family_of(grade) not in ("", kind)
        ],
    }
    for key, rows in others.items():
        for name, value in rows[:1]:
            more = f" and {len(rows) - 1} more" if len(rows) > 1 else ""
            yield (
                f"{name}{more} should be of {value} ({key} in the nest), the profile cuts {cut.name} of "
                f"{cut.thickness_mm:g} mm: its kerf, feeds and pierces are for that"
            )


def _far_home(nest: Nest, profile: ProfileValues) -> Iterator[str]:
    x0, y0, x1, y1 = nest.sheet.bounds
    longest_mm = max(x1 - x0, y1 - y0)
    away_mm = float(shapely.distance(shapely.box(x0, y0, x1, y1), shapely.Point(profile.home_on(nest))))
    if away_mm > longest_mm:
        way_out = "correct machine.home"
        if profile.machine.origin == "drawing":
            way_out = "machine.origin: sheet-corner (or --origin sheet-corner) puts its corner at the machine's zero"
        yield (
            f"the sheet is {away_mm:.0f} mm from the machine's home, further than it is long ({longest_mm:.0f} mm): "
            f"the torch travels there and back; {way_out}"
        )


def _sticks_out(nest: Nest, profile: ProfileValues) -> Iterator[str]:
    reach = profile.reach_on(nest)
    if reach is None:
        return
    frame, (x0, y0, x1, y1) = profile.frame_on(nest), nest.sheet.bounds
    if x0 < reach[0] - _SLACK_MM or y0 < reach[1] - _SLACK_MM or x1 > reach[2] + _SLACK_MM or y1 > reach[3] + _SLACK_MM:
        (ax, ay), (bx, by) = frame.on_machine((x0, y0)), frame.on_machine((x1, y1))
        yield (
            f"the sheet lies from ({ax:g}, {ay:g}) to ({bx:g}, {by:g}) of the machine, beyond its travel "
            "(machine.travel_x, machine.travel_y): what is cut has to lie within"
        )


def _no_edge_starts(nest: Nest, profile: ProfileValues) -> Iterator[str]:
    if not profile.leads.edge_start:
        return
    reach = profile.reach_on(nest)
    if not nest.sheet.stated:
        stated = "a sheet layer, or --sheet (in Python: sheet_mm=)"
        yield f"no edge starts are offered: nobody has stated where the sheet's edge is: {stated}"
    elif reach is None or not all(map(math.isfinite, reach)):
        yield "no edge starts are offered: give machine.travel_x and machine.travel_y, how far the torch can go"
