"""A plant's profile: its machine, its material, and what it asks of every plan. Frozen; speeds in mm/s, times in s."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import cast

import shapely

from kerfwise.encoder.bevels.block import Block
from kerfwise.encoder.bevels.cut_nest import BevelOptions, bevelled, with_bevels
from kerfwise.encoder.bevels.room import Bevelling, plan_bevels
from kerfwise.encoder.bridges import expect_wider
from kerfwise.encoder.candidates.candidate import LEAST_WASTE_MM, CommonOptions, LeadOptions
from kerfwise.encoder.candidates.snake import SnakeOptions
from kerfwise.encoder.candidates.split_rounds import SplitOptions
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import FactOptions
from kerfwise.encoder.facts.links import LinkOptions
from kerfwise.encoder.geometry.segment import Box, Point
from kerfwise.encoder.narrow_features import Narrow
from kerfwise.encoder.nest import Kind, Nest
from kerfwise.encoder.questions import NARROW, SHARED_EDGES, SMALL_HOLES
from kerfwise.encoder.readers.layers import PURPOSES, Layers
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.scrap import with_scrap
from kerfwise.encoder.slits import with_slits
from kerfwise.encoder.small_holes import HoleLimits, with_small_holes
from kerfwise.encoder.torch_path import CornerFeed, TabOptions, with_corner_times
from kerfwise.encoder.touching_edges import with_touching_edges_cut
from kerfwise.rules.options.quantities import ByThickness, length_at
from kerfwise.rules.own import own_pairs

from .plant_sections import Machine, Origin
from .profile_sections import ProfileSections

_STEP_MM = 1e-3

NARROW_ANSWERS = ("slit", "leave", "refuse")
SMALL_HOLE_ANSWERS = ("skip", "spot", "cut", "refuse")
SHARED_EDGE_ANSWERS = ("once", "pierced", "refuse")
SHORTEST_SHARED_MM = 1.0
"""Edges that parts share are cut once, as answered, where one of them is as long as this."""
"""What may be answered to the questions of `encoder/candidates/cut_questions.py`."""


@dataclass(frozen=True)
class Profile(ProfileSections):
    """Everything a plant fixes beforehand.

    `further_rules` are those beside the catalogue that `rules` has settings of: of installed packages, which are off
    unless a profile says otherwise, and of the files that it names.

    `sha256` is that of the profile's file and of all files that it is made of: those it is based on, its chart, its
    dialect's, and those of its rules; `read_from` are the places of that file and of those it is based on. `chart` says
    what of it is from a material chart, and `said_at` where each key stands, by such as `machine.home` and
    `rules.pierce`. `for_one_nest` says what a job file, or the command line, has in the place of the plant's own. These
    and `file` do not make two profiles differ.

    Examples
    --------
    >>> from kerfwise import load_profile
    >>> profile = load_profile("plasma-carbon-steel")
    >>> profile.material.kerf_mm, profile.rules["level-ahead"].strength
    (1.5, 'hard')
    """

    def at_origin(self, origin: Origin) -> Profile:
        """The profile with the machine's zero where a plan or program says that it has it."""
        return self if origin == self.machine.origin else replace(self, machine=replace(self.machine, origin=origin))

    def at_spacing(self, spacing_mm: float | None) -> Profile:
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

    def lead_options(self, nest: Nest | None = None) -> LeadOptions:
        """How candidates are made: `leads`, the kerf, and what the rules and the locks say.

        Given a nest, they keep to what the machine reaches of it.
        """
        return replace(
            self._asked_of_leads(),
            reach=None if nest is None else self.reach_on(nest),
            entry_points={lock.contour: lock.entry for lock in self.locks if lock.contour and lock.entry},
            holes=self.hole_limits(),
            narrow=self.cuts.narrow,
            corner_mm=self.corners.leave_mm,
            common=self.common_options(),
        )

    def common_options(self) -> CommonOptions | None:
        """Which edges two parts have in common; None where none are to be cut once."""
        common = self.cuts.common
        if common.shortest_mm is None:
            return None
        return CommonOptions(common.shortest_mm, common.gap_tolerance_mm, self.machine.kerf_start, self.corner_feed())

    def without_losses(self, nest: Nest) -> Nest:
        """The nest less what parts that touch lose to the cut between them, where the profile accepts that."""
        edges = self.common_options() if self.cuts.common.accept_loss else None
        return (
            nest
            if edges is None
            else with_touching_edges_cut(nest, self.material.kerf_mm, edges.shortest_mm, edges.gap_mm)
        )

    def snake_options(self) -> SnakeOptions | None:
        """Which rows of neighbours are cut as snakes; None where none are."""
        snake, strict = self.cuts.snake, self.rules_of_direction("outer")
        if snake.gap_mm is None:
            return None
        shared = CommonOptions(0.0, self.cuts.common.gap_tolerance_mm, self.machine.kerf_start)
        one_way = bool(strict) and self.cuts.common.good_side == "part"
        return SnakeOptions(snake.gap_mm, snake.parts, shared, may_share=not one_way)

    def split_options(self) -> SplitOptions:
        """Which rounds are cut in two stretches."""
        return SplitOptions(self.cuts.split.halves, self.cuts.split.last_mm)

    @property
    def kerf_starts(self) -> bool:
        """Whether cuts may begin in the kerf of an older one, without a wait for a pierce."""
        offered = self.common_options() is not None or bool(self.cuts.in_stretches)
        return offered and self.machine.kerf_start

    @property
    def longest_link_mm(self) -> float:
        """The longest way through waste with the torch on: a link, or one in a snake; 0 where there are none."""
        return max(self.cuts.links.longest_mm, self.cuts.snake.gap_mm or 0.0)

    def link_options(self) -> LinkOptions | None:
        """How links are made: no longer than the profile allows, and than pays; None where there are none."""
        machine, leads = self.machine, self.leads
        longest_mm = self.cuts.links.longest_mm
        if longest_mm <= 0 or self.no_links() is not None:
            return None
        slower = 1 / machine.cut_feed_mm_s - 1 / machine.travel_mm_s
        if slower > 0:
            lead_s = self.length_mm(leads.lead_in_mm) * (1 / machine.cut_feed_mm_s + 1 / machine.travel_mm_s)
            longest_mm = min(longest_mm, (max(machine.pierce_time_s, machine.edge_preheat_s) + lead_s) / slower)
        return LinkOptions(longest_mm, self.material.kerf_mm, self._asked_of_leads().splash_mm or 0.0)

    def no_links(self, nest: Nest | None = None) -> str | None:
        """Why there can be no links, whatever length of them is allowed: a clause; None where there can."""
        limit = self.temperature_limit()
        if limit is not None and limit.dwells:
            return f"the rule {limit.rule} lets metal cool while the torch is off (dwells)"
        if self.corner_feed() is not None:
            return "corners are cut more slowly (corner_feed), and the one where a link begins is of two cuts"
        if nest is not None and nest.scrap:
            return "links would cut metal off the skeleton, in which scrap lines are cut afterwards"
        return None

    def _asked_of_leads(self) -> LeadOptions:
        """What the sections and the rules ask of each lead, whatever the nest."""
        leads = self.leads
        lead_options = LeadOptions(
            entries=leads.entries,
            kerf_mm=self.material.kerf_mm,
            lead=leads.lead,
            lead_in_mm=self.length_mm(leads.lead_in_mm),
            lead_in_min_mm=leads.lead_in_min_mm,
            lead_out=leads.lead_out,
            lead_out_mm=leads.lead_out_length_mm,
            pierce_clearance_mm=0.0,
            splash_mm=None,
            hole_overcut_mm=self.length_mm(leads.hole_overcut_mm),
            edge_start=leads.edge_start,
        )
        for rule, options, strength in self._every_rule:
            lead_options = rule.lead_options(lead_options, options, strength)
        return lead_options

    def tabs(self) -> TabOptions | None:
        """Which parts have tabs, and of what kind; None where no rule asks for any."""
        return self._asked_of_leads().tabs

    def rules_of_direction(self, kind: Kind) -> tuple[str, ...]:
        """Ids of the rules that leave one direction only for this kind of contour."""
        free = LeadOptions()
        return tuple(
            rule.id
            for rule, options, strength in self._every_rule
            if len(rule.lead_options(free, options, strength).directions[kind]) == 1
        )

    def hole_limits(self) -> HoleLimits:
        """What is done with small holes, in mm on this sheet: `small_holes`, its thickness, and the pierce's room."""
        # Without a lead the pierce is on the path.
        asked_mm = self._asked_of_leads().pierce_clearance_mm if self.leads.lead != "none" else 0.0
        clearance_mm = max(asked_mm, self.material.kerf_mm / 2 + LEAST_WASTE_MM)
        return self.small_holes.limits(self.material.thickness_mm, clearance_mm)

    def as_cut(self, nest: Nest) -> Nest:
        """The nest as this plant cuts it: small holes are marks or gone, others know their feed, slots have slits.

        So has the skeleton its lines, where the profile has them made. Of parts that touch it is what they keep, where
        the profile accepts the loss.

        Raises
        ------
        InputError
            If a bridge of the nest is narrower than the kerf, a part has no room to lose what it is to lose, or the
            sheet has none for a bevel.
        """
        expect_wider(nest, self.material.kerf_mm)
        cut_nest = self.without_losses(with_small_holes(nest, self.hole_limits()))
        cut_nest = with_slits(cut_nest, self.material.kerf_mm) if self.cuts.narrow == "slit" else cut_nest
        cut_nest = with_scrap(cut_nest, self.material.kerf_mm, self.cuts.scrap.grid_mm, self.cuts.scrap.remnant)
        bevels = self.bevel_options()
        cut_nest = cut_nest if bevels is None else with_bevels(cut_nest, bevels)
        law = self.corner_feed()
        return cut_nest if law is None else with_corner_times(cut_nest, law, self.material.kerf_mm)

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

    def bevelling_of(self, nest: Nest) -> Bevelling | None:
        """Which corners of a nest as it is cut have loops; None where no contour has a bevel.

        Raises
        ------
        InputError
            For bevels that cannot be cut as they are drawn.
        """
        options = self.bevel_options()
        return None if options is None or next(bevelled(nest), None) is None else plan_bevels(nest, options)

    def as_answered(self) -> Profile:
        """The profile with what `drawing.answers` says of slots narrower than the kerf, small holes and shared edges.

        Raises
        ------
        InputError
            For an answer that is none of the choices.
        """
        answers = dict(self.drawing.answers)
        cuts, holes, machine = self.cuts, self.small_holes, self.machine
        all_choices = {
            NARROW: NARROW_ANSWERS, SMALL_HOLES: SMALL_HOLE_ANSWERS, SHARED_EDGES: SHARED_EDGE_ANSWERS
        }  # fmt: skip
        for question, choices in all_choices.items():
            if (answer := answers.get(question, choices[0])) not in choices:
                raise InputError(
                    f"the answer {question}={answer} is none of the choices: expected {', '.join(choices)}"
                )
        if NARROW in answers:
            cuts = replace(cuts, narrow=cast(Narrow, answers[NARROW]))
        match answers.get(SMALL_HOLES):
            case "cut":
                holes = replace(holes, min_hole=self.material.kerf_mm, under="skip")
            case "refuse" | "skip" | "spot" as under:
                holes = replace(holes, under=under)
        if (shared := answers.get(SHARED_EDGES, "refuse")) != "refuse":
            shortest_mm = self.cuts.common.shortest_mm or SHORTEST_SHARED_MM
            common = replace(cuts.common, shortest_mm=shortest_mm, accept_loss=True, good_side="any")
            cuts = replace(cuts, common=common)
            machine = replace(machine, kerf_start=machine.kerf_start and shared != "pierced")
        return replace(self, cuts=cuts, small_holes=holes, machine=machine)

    def corner_feed(self) -> CornerFeed | None:
        """The feeds at corners on this sheet; None where corners are cut like the rest."""
        return self.corners.law(self.material.thickness_mm)

    def fact_options(self, nest: Nest | None = None) -> FactOptions:
        """The thresholds of the facts, as the rules and the locks say.

        Given a nest, zones keep to the orders of the plant's own hard rules too.
        """
        own = own_pairs(self.own_rules, nest, self._thresholds()) if nest is not None else ()
        own += self._pairs_in_files(nest) if nest is not None else ()
        given = FactOptions(
            zone_respects=frozenset({"contains"}),
            zone_pairs=(*((lock.contour, lock.before) for lock in self.locks if lock.contour and lock.before), *own),
            zone_places=self._zone_places(nest),
            zone_fixed=tuple((lock.part, lock.zone) for lock in self.locks if lock.part and lock.zone),
            kerf_mm=self.material.kerf_mm,
            splash_mm=None,
            pierce_pass=self.cuts.pierce_pass,
        )
        for rule, options, strength in self._every_rule:
            given = rule.fact_options(given, options, strength)
        return given

    def _pairs_in_files(self, nest: Nest) -> tuple[tuple[str, str], ...]:
        """Orders that hard rules in model files state of the nest alone, so that no zone contradicts them."""
        on = self.settings()
        hard = [rule for rule in self.model_rules() if on[rule.id].strength == "hard" and not rule.gives_way]
        return tuple(pair for rule in hard for pair in rule.pairs_of_nest(nest, on[rule.id].options))

    def _zone_places(self, nest: Nest | None) -> tuple[tuple[str, int], ...]:
        """Part → the position that a lock gives one of its contours: its zone must reach there."""
        if nest is None:
            return ()
        found: dict[str, int] = {}
        ends = {"first": 1, "last": len(nest.contours)}
        for lock in self.locks:
            if lock.contour in nest.without_scrap.index and lock.position is not None:
                at = lock.position if isinstance(lock.position, int) else ends[lock.position]
                found.setdefault(nest.contour(lock.contour).part, at)
        return tuple(found.items())

    def read_options(self) -> ReadOptions:
        """How nest files are read."""
        drawing = self.drawing
        return ReadOptions(
            units=drawing.units,
            layers=Layers(**{name: getattr(drawing.layers, name) for name in PURPOSES}),
            colours=(*drawing.layers.colour, *((key, "cut") for key, _ in drawing.layers.bevel)),
            linetypes=drawing.layers.linetype,
            answers=drawing.answers,
            quantity=drawing.quantity,
            kerf_mm=self.material.kerf_mm,
            spot_mm=self.small_holes.spot_size_mm,
            frame=drawing.frame,
            open_lines=drawing.open_lines,
            scrap_lines=drawing.scrap_lines,
            margin_mm=drawing.margin_mm,
            join_tolerance_mm=drawing.join_tolerance_mm,
            refit_arcs_mm=drawing.refit_arcs_mm,
            bevels=drawing.layers.bevel,
        )


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


def placing_notes(nest: Nest, profile: Profile) -> Iterator[str]:
    """A sentence for each thing that a planner would want to know: a far home, a sheet that sticks out, no edge starts.

    Examples
    --------
    >>> from kerfwise.encoder.geometry.curve import Curve
    >>> from kerfwise.encoder.nest import Sheet
    >>> far = Nest(Sheet(Curve.of([(3000, 0), (3080, 0), (3080, 80), (3000, 80)])), ())
    >>> [text.split(":")[0] for text in placing_notes(far, Profile("shop"))]
    ["the sheet is 3000 mm from the machine's home, further than it is long (80 mm)"]
    """
    yield from _far_home(nest, profile)
    yield from _sticks_out(nest, profile)
    yield from _no_edge_starts(nest, profile)


def _far_home(nest: Nest, profile: Profile) -> Iterator[str]:
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


def _sticks_out(nest: Nest, profile: Profile) -> Iterator[str]:
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


def _no_edge_starts(nest: Nest, profile: Profile) -> Iterator[str]:
    if not profile.leads.edge_start:
        return
    reach = profile.reach_on(nest)
    if not nest.sheet.stated:
        stated = "a sheet layer, or --sheet (in Python: sheet_mm=)"
        yield f"no edge starts are offered: nobody has stated where the sheet's edge is: {stated}"
    elif reach is None or not all(map(math.isfinite, reach)):
        yield "no edge starts are offered: give machine.travel_x and machine.travel_y, how far the torch can go"
