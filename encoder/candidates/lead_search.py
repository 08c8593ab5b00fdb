"""The search for entries with room for a lead, over all contours at once, within the machine's travel."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import shapely

from kerfwise.arrays import Bools
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import narrower_than
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.narrow_features import LostFeatureSpan, cut_across, lost_features_sentence, lost_walls
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.slits import LostFeature, blocked_slits, slits_of
from kerfwise.encoder.small_holes import HoleLimits, diameter_under, kept_hole_reason, too_small
from kerfwise.encoder.torch_path import compensate_together, compensated

from .candidate import Candidate, LeadOptions
from .entries import (
    ANYWHERE,
    IN_PROFILE,
    NO_JOINTS,
    TIED_MM,
    Approaches,
    Joints,
    Leads,
    LeadShape,
    Outline,
    choose,
    choose_each,
    joints_at,
    places,
    shaped,
    ways,
)
from .leads import edge_starts, lead_ins, least_clearance_mm, wishes
from .obstacles import Surroundings, paths_off_sheet
from .tab_places import TabPlaces

ROUNDS = 3
"""How often entries without room are replaced by others."""

DENSE = 48
"""Entries to try of a contour that has found none."""


class _Pools:
    """The places of contours that could be entries: those not tried yet are `fresh`, those that are taken have a lead.

    `of` numbers the outline of each joint, ascending.
    """

    def __init__(self, outlines: Mapping[int, Outline], count: int, tabs: TabPlaces) -> None:
        self.outlines, self._count = list(outlines.values()), count
        at_mm, ranks, of = tabs.all_entries(self.outlines, *places(self.outlines, count))
        self._joints, self._fresh = joints_at(self.outlines, at_mm, of)
        self._ranks, self._of = ranks, of
        self._around_mm = np.array([outline.around_mm for outline in self.outlines])
        self._number = np.full(max(outlines, default=0) + 1, -1)
        self._number[list(outlines)] = np.arange(len(outlines))
        self._taken_mm, self._taken_of = np.zeros(0), np.zeros(0, np.int64)

    def draw(self) -> Joints:
        """The best entries that are still fresh, of each contour as many as are wanting."""
        wanting = np.maximum(self._count - np.bincount(self._taken_of, minlength=len(self.outlines)), 0)
        rows = np.flatnonzero(self._fresh)
        taken = self._taken_mm, self._taken_of
        at_mm, ranks, of = self._joints.entry_mm[rows], self._ranks[rows], self._of[rows]
        drawn = rows[choose_each(at_mm, ranks, of, self._around_mm, self._count, wanting, *taken)]
        self._fresh[drawn] = False
        return self._joints.take(drawn)

    def take(self, joints: Joints) -> None:
        """These have a lead."""
        at_mm = np.concatenate([self._taken_mm, joints.entry_mm])
        of = np.concatenate([self._taken_of, self._number[joints.contour]])
        order = np.lexsort((at_mm, of))
        at_mm, of = at_mm[order], of[order]
        new = (np.diff(of, prepend=-1) > 0) | (np.diff(at_mm, prepend=np.nan) != 0)
        self._taken_mm, self._taken_of = at_mm[new], of[new]

    def bare(self) -> list[Outline]:
        """The contours of which nothing is taken."""
        held = set(self._taken_of.tolist())
        return [outline for k, outline in enumerate(self.outlines) if k not in held]


def longest_lead_mm(outline: Outline, options: LeadOptions) -> float:
    """The longest lead-in to a contour; in a small hole not further than about its middle."""
    if outline.contour.kind == "outer":
        return options.lead_in_mm
    middle_mm = 2 * abs(outline.path.signed_area_mm2) / outline.path.length_mm
    return max(options.lead_in_min_mm, min(options.lead_in_mm, middle_mm))


def approaches_to(
    outlines: Mapping[int, Outline], locked: Joints, around: Surroundings, options: LeadOptions
) -> Approaches:
    """For every contour up to `options.entries` entries with room for a lead, and all locked ones that have it."""
    outlines = {k: outline for k, outline in outlines.items() if not _too_narrow(outline, options)}
    locked = locked.take(np.isin(locked.contour, np.array(list(outlines), dtype=np.int64)))
    longest = {k: longest_lead_mm(outline, options) for k, outline in outlines.items()}
    tabs = options.tab_places or TabPlaces()
    pools = _Pools(outlines, options.entries, tabs)
    found: list[Approaches] = []

    def tried(joints: Joints, patient: bool, from_edge: bool) -> Approaches:
        candidates = ways(joints, outlines, options.directions)
        candidates = candidates.take(tabs.lawful(candidates, outlines))
        longest_mm = np.array([longest[k] for k in candidates.joints.contour.tolist()])
        if from_edge and options.edge_start and options.lead != "none":
            outer = np.array(
                [outlines[k].contour.kind == "outer" for k in candidates.joints.contour.tolist()], np.bool_
            )
            found.append(edge_starts(candidates.take(outer), around, options))
        return lead_ins(candidates, longest_mm, around, options, patient)

    def taken(good: Approaches) -> None:
        found.append(good)
        pools.take(good.ways.joints)

    taken(tried(locked, patient=True, from_edge=True))
    for round_ in range(ROUNDS):
        taken(tried(pools.draw(), patient=False, from_edge=round_ == 0))
    last = tried(
        Joints.joined([NO_JOINTS, *(dense(outline) for outline in pools.bare())]), patient=True, from_edge=True
    )
    taken(last.take(_spread(last, outlines, options.entries)))
    return Approaches.joined(found).in_order()


def _too_narrow(outline: Outline, options: LeadOptions) -> bool:
    """Whether no place in a hole keeps a pierce's clearance: the pierce of a lead to a hole lies in it."""
    of_hole = outline.contour.kind == "hole" and options.lead != "none"
    return of_hole and narrower_than(outline.contour.curve, 2 * least_clearance_mm(options) - TIED_MM)


def dense(outline: Outline, count: int = DENSE) -> Joints:
    """Entries all around a contour."""
    joints, reached = outline.joints(outline.around_mm * np.arange(count) / count)
    return joints.take(reached)


def _spread(found: Approaches, outlines: Mapping[int, Outline], count: int) -> Bools:
    """Those of `count` entries of each contour, well apart."""
    joints = found.ways.joints
    kept = np.full(len(joints), False)
    for k in np.unique(joints.contour).tolist():
        rows = np.flatnonzero(joints.contour == k)
        at_mm = np.unique(joints.entry_mm[rows])
        around_mm = outlines[k].around_mm
        chosen = choose(at_mm, np.full(len(at_mm), ANYWHERE), around_mm, count, np.zeros(0))
        kept[rows] = np.isin(joints.entry_mm[rows], at_mm[chosen])
    return kept


# One look for ways to cut some contours under some options: what was found, and what stands without.


@dataclass(frozen=True, slots=True)
class NarrowFeatures:
    """The features of a contour that the kerf would lose, those among them whose slits would burn what is beside."""

    contour: Contour
    lost: tuple[LostFeatureSpan, ...]
    burnt: tuple[LostFeature, ...]

    def sentence(self, options: LeadOptions) -> str:
        """What is lost, what to do about it, and why slits do not help."""
        features = [*self.lost, *(one.slot for one in self.burnt)]
        return lost_features_sentence(self.contour.id, features, options.kerf_mm, _slot_advice(self, options))


@dataclass(frozen=True, eq=False, slots=True)
class LeadAttempt:
    """The outlines of the contours that may be cut, the approaches found, and the joints that locks ask for.

    By contour number, `small` says what is wrong with holes that are too small, `uncut` with contours that the kerf
    cannot follow, `beyond` with those whose paths, marks included, leave the sheet or what the machine reaches;
    `narrow` has the features that the kerf would lose of contours. `slits` are the candidates of slits, `shut` says why
    others have none. `bare` are contours without any approach, `unmet` the rows of `locked` without one.
    """

    outlines: Mapping[int, Outline]
    found: Approaches
    locked: Joints
    small: Mapping[int, str]
    uncut: Mapping[int, str]
    narrow: Mapping[int, NarrowFeatures]
    beyond: Mapping[int, str]
    slits: tuple[Candidate, ...]
    shut: Mapping[int, str]
    bare: tuple[int, ...]
    unmet: tuple[int, ...]

    @property
    def faulty(self) -> frozenset[int]:
        """Every contour that cannot be cut as the options ask."""
        unmet = (int(self.locked.contour[i]) for i in self.unmet)
        return frozenset((*self.small, *self.uncut, *self.narrow, *self.beyond, *self.shut, *self.bare, *unmet))


def try_leads(nest: Nest, contours: Iterable[int], around: Surroundings, options: LeadOptions) -> LeadAttempt:
    """Look for approaches to the contours of these numbers; marks need none, those of slits are whole candidates."""
    chosen = list(contours)
    small = _small_holes(nest, chosen, options.holes)
    others = [k for k in chosen if k not in small]
    paths: dict[int, tuple[Contour, Curve]] = {}
    uncut: dict[int, str] = {}
    beyond: dict[int, str] = {}
    compensate_together((nest.contours[k] for k in others), options.kerf_mm)
    for k in others:
        contour = nest.contours[k]
        path = contour.curve
        try:
            if contour.encloses:
                path = compensated(contour, options.kerf_mm)
                paths[k] = contour, path
        except InputError as error:
            uncut[k] = error.message
            continue
        if far := reach_message(contour, path, options.reach):
            beyond[k] = far
    outlines = Outline.of(paths, options.kerf_mm / 2)
    narrow = _narrow(nest, others, outlines, options)
    rings = {k: outline.path for k, outline in outlines.items() if k not in narrow}
    drawn = {k: nest.contours[k].curve for k in chosen if nest.contours[k].kind in ("mark", "slit")}
    off = paths_off_sheet(nest.contours, drawn | rings, around)
    beyond |= off
    for k in (*narrow, *off):
        outlines.pop(k, None)
        uncut.pop(k, None)
    locked = _locked(outlines, nest, options)
    found = approaches_to(outlines, locked, around, options)
    joints = found.ways.joints
    led = set(zip(joints.contour.tolist(), joints.entry_mm.tolist(), strict=True))
    bare = tuple(sorted(set(outlines) - {k for k, _ in led}))
    locked_places = zip(locked.contour.tolist(), locked.entry_mm.tolist(), strict=True)
    unmet = tuple(i for i, (k, entry_mm) in enumerate(locked_places) if k not in bare and (k, entry_mm) not in led)
    ways_in = {k: slit_candidates(k, around, options) for k in chosen if nest.contours[k].kind == "slit"}
    slits = tuple(c for of in ways_in.values() for c in reachable_candidates(of, options.reach))
    led_in = {c.contour for c in slits}
    shut = {k: no_slit_room_message(k, around, options) for k in ways_in if k not in led_in and k not in beyond}
    return LeadAttempt(outlines, found, locked, small, uncut, narrow, beyond, slits, shut, bare, unmet)


def _narrow(
    nest: Nest, contours: Iterable[int], outlines: Mapping[int, Outline], options: LeadOptions
) -> dict[int, NarrowFeatures]:
    """Contours of which the kerf would lose more than the options allow, and what: slots, notches, necks, corners."""
    paths = {outline.contour.id: outline.path for outline in outlines.values()}
    slits: dict[str, list[Curve]] = {}
    for slit in (c for c in nest.contours if c.kind == "slit"):
        slits.setdefault(slit.slot_of, []).append(slit.curve)
    lost = lost_walls([nest.contours[k] for k in contours], options.kerf_mm, paths, slits, options.corner_mm)
    found = {}
    for contour in (nest.contours[k] for k in contours):
        burnt = blocked_slits(nest, contour, options.kerf_mm) if contour.id in slits else []
        features = tuple(
            one for one, _ in lost.get(contour.id, ()) if not cut_across(one, options.narrow, options.kerf_mm)
        )
        if features or burnt:
            found[nest.index[contour.id]] = NarrowFeatures(contour, features, tuple(burnt))
    return found


def _slot_advice(features: NarrowFeatures, options: LeadOptions) -> str:
    """What a planner can do about slots that would be lost, and why slits do not help."""
    slots = [one for one in features.lost if one.corner_deg is None]
    if not (slots or features.burnt):
        return f"{IN_PROFILE['corner_mm']} allows {options.corner_mm:g} mm"
    slits, unfit = slits_of(features.contour, options.kerf_mm)
    if options.narrow == "slit":
        whys = dict.fromkeys(one.why for one in (*unfit, *features.burnt))
        return f"no slit opens it: {', '.join(whys) or 'metal of it would be left'}; change the drawing"
    opened = f"one pass along the middle opens {'it' if len(slots) == 1 else 'them'} (cuts.narrow: slit), or "
    return f"{'' if unfit or not slits else opened}change the drawing"


def _small_holes(nest: Nest, contours: Iterable[int], limits: HoleLimits) -> dict[int, str]:
    """Holes under the limit that are still to be cut: refused, or neither to be marked nor left out."""
    found = {}
    for k in contours:
        hole = nest.contours[k]
        diameter_mm = diameter_under(hole, limits.limit_mm) if hole.kind == "hole" else None
        if diameter_mm is not None:
            kept = kept_hole_reason(nest, hole, limits) if limits.treated else None
            found[k] = too_small(hole.id, diameter_mm, limits) + (f"; {kept}" if kept else "")
    return found


def _locked(outlines: Mapping[int, Outline], nest: Nest, options: LeadOptions) -> Joints:
    """The joints at the entries that an operator asks for."""
    found = [NO_JOINTS]
    for name, point in sorted(options.entry_points.items()):
        outline = outlines.get(nest.index[name])
        if outline is not None:
            at_mm, _ = outline.drawn.project(np.array([point]))
            found.append(outline.joints(at_mm)[0])
    return Joints.joined(found)


# Candidates of slits: pierced in the waste before the mouth, led straight in or at an angle, then along the line.

TURNS_DEG = (0, 20, -20, 40, -40, 65, -65)
"""Leads to a slit, by the angle that they make with it."""
_LENGTHS = 8


def slit_candidates(index: int, around: Surroundings, options: LeadOptions) -> list[Candidate]:
    """The ways to cut a slit, by the angle of the lead, each lead as long as there is room for; none without room.

    As with other contours, leads that keep off the kerfs of other parts are better than longer ones.
    """
    contour = around.contours[index]
    curve = contour.curve
    start, end, ahead = curve.start, curve.end, np.array([curve.tangent_at(0.0)])
    at, aside = np.array([start]), np.column_stack([-ahead[:, 1], ahead[:, 0]])
    joint = Joints(np.array([index]), np.zeros(1), at, np.zeros(1), at, -ahead)
    off = Curve(np.array([[*end, 0.0]]), closed=False)
    found = []
    if options.lead == "none":
        on_path = Leads(at, at, np.zeros(1), np.zeros(1))
        if _clear(on_path, index, around, options)[0]:
            found.append(Candidate(index, 0.0, start, "ccw", start, None, off, end, curve.length_mm))
        return found
    for turn in TURNS_DEG:
        for asks, shortened in product(wishes(around, options), np.linspace(0, 1, _LENGTHS).tolist()):
            shape = LeadShape("line", shortened, math.radians(turn))
            leads = shaped(shape, joint, aside, np.array([options.lead_in_mm]), options.lead_in_min_mm)
            if _clear(leads, index, around, options)[0] and asks(leads, joint.contour)[0]:
                px, py = leads.pierce[0].tolist()
                lead = Curve.of([(px, py), start], closed=False)
                cut_mm = lead.length_mm + curve.length_mm
                found.append(Candidate(index, 0.0, start, "ccw", (px, py), lead, off, end, cut_mm))
                break
    return found


def no_slit_room_message(index: int, around: Surroundings, options: LeadOptions) -> str:
    """Why a slit has no candidate, as a sentence."""
    contour = around.contours[index]
    x, y = contour.curve.start
    clearance_mm = least_clearance_mm(options)
    return (
        f"{contour.slot_of}: the slot with its mouth at ({x:z.1f}, {y:z.1f}) cannot be opened by a slit: the waste "
        f"before it has no room for a pierce {clearance_mm:g} mm from every contour"
    )


def _clear(leads: Leads, index: int, around: Surroundings, options: LeadOptions) -> Bools:
    """Leads that are lawful by themselves."""
    own = np.array([index])
    not_own = np.array([[index, around.around[index]]]) if options.lead == "none" else own
    clear = around.clear_pierces(leads.pierce, least_clearance_mm(options), not_own) & around.in_waste(leads.pierce)
    clear &= around.inside_edges(leads)
    if options.splash_mm is not None:
        clear &= around.off_slits(leads.pierce, options.kerf_mm + options.splash_mm, own)
    if options.lead != "none":
        clear &= around.clear_leads(leads, own, options.kerf_mm / 2)
    return clear


# Candidates that the machine can make: those whose torch stays within its travel.

_SLACK_MM = 1e-6


def reachable_candidates(candidates: Iterable[Candidate], reach: Box | None) -> list[Candidate]:
    """The candidates whose leads and ends the torch can go to; edge starts only where anybody has said how far it goes.

    The rings between them are judged once for each contour (`reach_message`).
    """
    if reach is None:
        return [c for c in candidates if not c.edge_start]
    return [c for c in candidates if all(inside(xy, reach) for xy in _points(c))]


def reach_message(contour: Contour, path: Curve, reach: Box | None) -> str | None:
    """Where the torch's path round a contour leaves what it can go to, as a sentence; None if it does not."""
    if reach is None:
        return None
    points = shapely.get_coordinates(path.line())
    far = max(points.tolist(), key=lambda xy: beyond_reach_mm((xy[0], xy[1]), reach))
    if (off_mm := beyond_reach_mm((far[0], far[1]), reach)) <= _SLACK_MM:
        return None
    return (
        f"{contour.id} at ({far[0]:.1f}, {far[1]:.1f}) is {off_mm:.1f} mm out of the machine's travel: "
        "move the part, or correct machine.travel_x and machine.travel_y"
    )


def inside(point: Sequence[float], reach: Box) -> bool:
    """Whether the torch can go to a point."""
    return beyond_reach_mm(point, reach) <= _SLACK_MM


def beyond_reach_mm(point: Sequence[float], reach: Box) -> float:
    """How far a point is beyond what the torch can go to, along the worse axis; 0 or less within it."""
    x0, y0, x1, y1 = reach
    return max(x0 - point[0], point[0] - x1, y0 - point[1], point[1] - y1)


def _points(candidate: Candidate) -> Iterable[Sequence[float]]:
    yield from (candidate.pierce, candidate.end)
    for lead in (candidate.lead_in, candidate.lead_out):
        if lead is not None:
            yield from lead.flatten().tolist()
