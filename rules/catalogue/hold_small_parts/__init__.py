"""Rule hold-small-parts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut, CutSequence, Tab
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest, Part
from kerfwise.encoder.torch_path import LONGEST_MM, Axis, TabChoice, TabOptions
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.kind import Choice, Number
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import LENGTH, likely, positive
from kerfwise.rules.rule import Plant, Rule, RuleSetting, Strength, Violation
from kerfwise.rules.statements import Forbid

if TYPE_CHECKING:
    from kerfwise.encoder.candidates.candidate import LeadOptions
    from kerfwise.encoder.facts.facts import Facts

LIT_AGAIN_FREELY = ("laser",)
"""Processes that may go out and be lit again on the way without a pierce."""
WIDTH_MM = 0.05
"""By how much a tab may be wider or narrower than it should be."""
TENTHS_MM = 0.1
"""By how much a tab may be narrower beside a lead in a program of tenths of a millimetre: both are rounded."""
PLACE_MM = 0.5


@dataclass(frozen=True, slots=True)
class HoldSmallPartsOptions:
    """Which parts have tabs, and of what kind; the kerf, the process and the locks are the profile's."""

    tabs: TabChoice = setting(
        "tipping",
        Choice(("tipping", "all", "nest")),
        "which parts have tabs: those that may tip, all, or only those with tabs in the nest's file",
    )
    width_mm: float = setting(
        1.0, likely(positive(LENGTH), 0.01, 100.0), "metal that a tab leaves, between the ends of the kerf"
    )
    count: int = setting(
        2, Number(1, 20, whole=True), "tabs of a part that a laser cuts; all others leave one, at the end"
    )
    corner_mm: float = setting(
        3.0, likely(LENGTH, 0.0, 500.0), "how far from a tab its contour is straight, beyond the kerf's ends"
    )
    slat_pitch_mm: float = setting(60.0, likely(positive(LENGTH), 1.0, 5000.0), "from one slat to the next")
    slats: Axis = setting("y", Choice(("x", "y")), "the axis that the slats run along")
    kerf_mm: float = 1.5
    process: str = "plasma"
    locks: tuple[Lock, ...] = ()

    @property
    def at_end(self) -> bool:
        """Whether a part has one tab only, where its cut ends."""
        return self.process not in LIT_AGAIN_FREELY


class HoldSmallParts(Rule[HoldSmallPartsOptions]):
    """Parts that may tip are held by tabs.

    ## What it does

    The slats of the table lie `slat_pitch` apart and run along the axis `slats`. A part may tip if its centroid is less
    than a pitch from one of its ends, across the slats: then they may lie so that nothing supports its short side. Such
    a part keeps tabs: stretches of its outer contour of `width` that stay uncut, on a straight, at least `corner` from
    its ends. `tabs: all` gives them to every part, `tabs: nest` only to those with tabs in the nest's file. Tabs that
    the nest draws always come first. A lock `{contour: ID, tab: [x, y]}` puts one there, `{contour: ID, tab: off}`
    leaves a part without.

    A laser makes `count` tabs a part, spread round it: the beam goes out and on again while it moves on. Each start of
    any other torch is a pierce, so there the cut of a part stops short of its begin: one tab, at the end.

    No lead-in leans over a tab at the end, where it would burn the metal that holds. A part that has no room for its
    tabs is refused, with what to do. The check allows 0.05 mm of width, and 45° of bend
    where the planner keeps to 40°.

    ## Links, tabs and other cuts

    - **Links**: No link leads to a part with tabs or from one, and links keep off the metal that tabs hang on.
    - **Tabs**: The rule makes them, and the check looks for them in the program.
    - **Common cuts**: A part that tabs hold has none, nor have those that hang together with it by common edges: the
      neighbour's cut along a shared edge could take the tab with it.
    - **Scrap lines**: A part stays on its tabs, and leaves with its piece of the skeleton. Tabs keep off the lines,
      which would take the metal that holds.

    ## Why

    Plant practice: a small part that is cut free drops between the slats, or stands up where the head runs into it.

    ## Wrong

    A disc of 80 mm on slats 60 mm apart, cut all round.

    ## Right

    The same disc with two tabs, knocked out of the sheet by hand.
    """

    id = "hold-small-parts"
    sentence = "Parts that may tip are held by tabs."
    source = "plant practice"
    Options = HoldSmallPartsOptions
    default = "off"
    strengths = ("hard", "off")
    takes_no_file = "tabs are made with the ways to cut a contour, for which files have no words"

    def statements(self, facts: Facts, options: HoldSmallPartsOptions) -> Iterator[Forbid]:
        """A way to cut that leaves no tab, such as one begun before a stop, where the part needs one."""
        for k, name, reason in unheld(facts, options):
            sentence = f"{name} has no tab" if reason is None else f"{name} is held by tabs: {reason}"
            yield Forbid(k, self.about((name,), sentence))

    def lead_options(self, given: LeadOptions, options: HoldSmallPartsOptions, strength: Strength) -> LeadOptions:
        return given if strength == "off" else replace(given, tabs=_tab_options(options))

    def check_with(
        self, options: HoldSmallPartsOptions, plant: Plant, rules: Mapping[str, RuleSetting]
    ) -> Iterator[tuple[str, str]]:
        if options.width_mm + plant.kerf_mm > LONGEST_MM:
            yield "width", f"{options.width_mm:g} mm and the kerf are more than {LONGEST_MM:g} mm: make tabs narrower"

    def violations(self, nest: Nest, cuts: CutSequence, options: HoldSmallPartsOptions) -> list[Violation]:
        parts = {part.outer.id: part for part in nest.parts}
        found = []
        for k, cut in enumerate(cuts, 1):
            if cut.contour in nest.index:
                texts = _wrong(nest.contour(cut.contour), parts.get(cut.contour), cut, options)
                found += [Violation(self.id, (cut.contour,), f"{cut.contour} (cut {k}) {text}", (k,)) for text in texts]
        return found


def unheld(facts: Facts, options: HoldSmallPartsOptions) -> Iterator[tuple[int, str, str | None]]:
    """Candidates without the tabs that their part needs, or with tabs that it does not: number, contour id, reason."""
    tab_options = _tab_options(options)
    for part in facts.nest.parts:
        reason = tab_options.reason(part)
        for k in facts.candidates_of(facts.nest.index[part.outer.id]):
            if (reason is not None) != bool(facts.candidates[k].tabs):
                yield k, part.outer.id, reason


def _tab_options(options: HoldSmallPartsOptions) -> TabOptions:
    there: dict[str, tuple[tuple[float, float], ...]] = {}
    for lock in options.locks:
        if lock.contour is not None and isinstance(lock.tab, tuple):
            there[lock.contour] = (*there.get(lock.contour, ()), lock.tab)
    none = frozenset(lock.contour for lock in options.locks if lock.contour is not None and lock.tab == "off")
    return TabOptions(
        options.tabs, options.width_mm, options.count, options.corner_mm, options.slat_pitch_mm, options.slats,
        options.at_end, there, none,
    )  # fmt: skip


def _wrong(contour: Contour, part: Part | None, cut: Cut, options: HoldSmallPartsOptions) -> Iterator[str]:
    """What is wrong with the tabs of a cut."""
    wanted, why = (None, "") if part is None else _asked(part, options)
    if wanted is None:
        if cut.tabs:
            yield f"has {_tabs(len(cut.tabs))} that nothing asks for"
        return
    given, drawn = wanted
    if not cut.tabs:
        yield f"has no tab: {why}"
        return
    beside_mm = _tab_width_at_lead_mm(cut, options)
    if beside_mm is not None and beside_mm < cut.tabs[0].width_mm - (TENTHS_MM if _in_tenths(cut) else WIDTH_MM):
        yield f"burns all but {max(beside_mm, 0.0):.2f} mm of its tab with its lead-in"
    if len(cut.tabs) != given:
        yield f"has {_tabs(len(cut.tabs))}, not {given}: {why}"
    elif all(any(_there(one, tab) for one in drawn) for tab in cut.tabs):  # else that tab is told below
        bare = [one.at for one in drawn if not any(_there(one, tab) for tab in cut.tabs)]
        yield from (f"has no tab at ({x:.1f}, {y:.1f}): {why}" for x, y in bare)
    for tab in cut.tabs:
        place = f"has a tab at ({tab.at[0]:.1f}, {tab.at[1]:.1f})"
        nearest = min(drawn, key=lambda one: math.dist(one.at, tab.at), default=None)
        width_mm = options.width_mm if nearest is None else nearest.width_mm or options.width_mm
        if nearest is not None and not _there(nearest, tab):
            yield f"{place}, {math.dist(nearest.at, tab.at):.1f} mm from where it is asked for"
        if abs(tab.width_mm - width_mm) > WIDTH_MM:
            yield f"{place} that is {tab.width_mm:.2f} mm wide, not {width_mm:g} mm"
        off_mm = contour.curve.project(tab.at)[1]
        if off_mm > PLACE_MM:
            yield f"{place}, {off_mm:.1f} mm off the contour"
        elif bend_deg(contour, tab.at, (tab.width_mm + options.kerf_mm) / 2 + options.corner_mm) > BENT_DEG:
            yield f"{place} that lies in a corner, or less than {options.corner_mm:g} mm from one"


def _there(asked: Tab, tab: Tab) -> bool:
    """Whether a tab is where one is asked for."""
    return math.dist(asked.at, tab.at) <= PLACE_MM + WIDTH_MM


def _tab_width_at_lead_mm(cut: Cut, options: HoldSmallPartsOptions) -> float | None:
    """The metal between the end of a cut, where its tab is, and its lead-in, mm; None where tabs lie elsewhere."""
    if not options.at_end or len(cut.tabs) != 1 or cut.lead_in is None or cut.lead_out is None:
        return None
    return float(shapely.distance(shapely.Point(cut.end), cut.lead_in.line())) - options.kerf_mm


def _in_tenths(cut: Cut) -> bool:
    """Whether a cut goes by whole tenths of a millimetre from its pierce to its end, as some controls count."""
    steps = [10 * (end - begin) for begin, end in zip(cut.pierce, cut.end, strict=True)]
    return all(abs(step - round(step)) < SLACK_MM for step in steps)


def _asked(part: Part, options: HoldSmallPartsOptions) -> tuple[tuple[int, tuple[Tab, ...]] | None, str]:
    """How many tabs a part should have, those whose places are given, and why; None for none."""
    own = [lock for lock in options.locks if lock.contour == part.outer.id and lock.tab is not None]
    if any(lock.tab == "off" for lock in own):
        return None, ""
    locked = tuple(Tab(lock.tab, options.width_mm) for lock in own if isinstance(lock.tab, tuple))
    if locked or part.tabs:
        drawn = locked or part.tabs
        return (len(drawn), drawn), "it is locked" if locked else "the nest draws it"
    if options.tabs == "nest":
        return None, ""
    count = 1 if options.at_end else options.count
    if options.tabs == "all":
        return (count, ()), "every part is to have one"
    near_mm = may_tip(part, options.slat_pitch_mm, 0 if options.slats == "y" else 1)
    if near_mm is None:
        return None, ""
    why = f"its centroid is {near_mm:.1f} mm from one end, and slats lie {options.slat_pitch_mm:g} mm apart"
    return (count, ()), why


def _tabs(count: int) -> str:
    return "1 tab" if count == 1 else f"{count} tabs"


# Which parts may tip, and whether tabs lie where they hold: the judging half of rule hold-small-parts.

BENT_DEG = 45.0
"""A contour that turns by more beside a tab has a corner there. The planner keeps to 40: chords turn in steps."""
SLACK_MM = 1e-6


def may_tip(part: Part, pitch_mm: float, across: int) -> float | None:
    """How near the centroid of a part lies to one end of it along an axis (0: x, 1: y), mm; None if a pitch or more."""
    points = shapely.get_coordinates(part.polygon.exterior)[:, across]
    middle = shapely.get_coordinates(part.polygon.centroid)[0, across]
    near_mm = float(min(middle - points.min(), points.max() - middle))
    return near_mm if near_mm < pitch_mm - SLACK_MM else None


def bend_deg(contour: Contour, at: Point, reach_mm: float) -> float:
    """By how much a contour turns within a reach of a point of it, either way, all turns added up."""
    points = shapely.get_coordinates(contour.line)[:-1]
    steps = np.roll(points, -1, axis=0) - points
    steps_mm = np.hypot(*steps.T)
    heading = np.arctan2(steps[:, 1], steps[:, 0])
    turn = np.abs((heading - np.roll(heading, 1) + math.pi) % (2 * math.pi) - math.pi)  # at the start of each step
    starts_mm = np.concatenate([[0.0], np.cumsum(steps_mm)[:-1]])
    around_mm = float(steps_mm.sum())
    at_mm = float(shapely.line_locate_point(contour.line, shapely.Point(at)))
    away_mm = np.abs((starts_mm - at_mm + around_mm / 2) % around_mm - around_mm / 2)
    return math.degrees(float(turn[away_mm < reach_mm - SLACK_MM].sum()))
