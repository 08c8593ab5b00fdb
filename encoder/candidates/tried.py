"""One look for ways to cut some contours under some options: what was found, and what stands without."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from kerfwise.encoder.compensation import compensate_together, compensated
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.narrow import Lost, cut_across, lost_walls, said_of
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.slits import LostFeature, in_the_way, slits_of
from kerfwise.encoder.small_holes import HoleLimits, diameter_under, kept_because, too_small

from .approaches import Approaches
from .candidate import Candidate, LeadOptions
from .joints import Joints, Outline
from .on_sheet import off_the_sheet
from .profile_keys import IN_PROFILE
from .search import approaches_to
from .slits import no_room, slit_candidates
from .surroundings import Surroundings
from .within_reach import out_of_reach, within_reach


@dataclass(frozen=True, slots=True)
class NarrowFeatures:
    """The features of a contour that the kerf would lose, those among them whose slits would burn what is beside."""

    contour: Contour
    lost: tuple[Lost, ...]
    burnt: tuple[LostFeature, ...]

    def sentence(self, options: LeadOptions) -> str:
        """What is lost, what to do about it, and why slits do not help."""
        features = [*self.lost, *(one.slot for one in self.burnt)]
        return said_of(self.contour.id, features, options.kerf_mm, _what_to_do(self, options))


@dataclass(frozen=True, eq=False, slots=True)
class TriedLeads:
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


def try_options(nest: Nest, contours: Iterable[int], around: Surroundings, options: LeadOptions) -> TriedLeads:
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
        if far := out_of_reach(contour, path, options.reach):
            beyond[k] = far
    outlines = Outline.of(paths, options.kerf_mm / 2)
    narrow = _narrow(nest, others, outlines, options)
    rings = {k: outline.path for k, outline in outlines.items() if k not in narrow}
    drawn = {k: nest.contours[k].curve for k in chosen if nest.contours[k].kind in ("mark", "slit")}
    off = off_the_sheet(nest.contours, drawn | rings, around)
    beyond |= off
    for k in (*narrow, *off):
        outlines.pop(k, None)
        uncut.pop(k, None)
    locked = _locked(outlines, nest, options)
    found = approaches_to(outlines, locked, around, options)
    joints = found.ways.joints
    led = set(zip(joints.contour.tolist(), joints.entry_mm.tolist(), strict=True))
    bare = tuple(sorted(set(outlines) - {k for k, _ in led}))
    asked = zip(locked.contour.tolist(), locked.entry_mm.tolist(), strict=True)
    unmet = tuple(i for i, (k, entry_mm) in enumerate(asked) if k not in bare and (k, entry_mm) not in led)
    ways_in = {k: slit_candidates(k, around, options) for k in chosen if nest.contours[k].kind == "slit"}
    slits = tuple(c for of in ways_in.values() for c in within_reach(of, options.reach))
    led_in = {c.contour for c in slits}
    shut = {k: no_room(k, around, options) for k in ways_in if k not in led_in and k not in beyond}
    return TriedLeads(outlines, found, locked, small, uncut, narrow, beyond, slits, shut, bare, unmet)


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
        burnt = in_the_way(nest, contour, options.kerf_mm) if contour.id in slits else []
        features = tuple(
            one for one, _ in lost.get(contour.id, ()) if not cut_across(one, options.narrow, options.kerf_mm)
        )
        if features or burnt:
            found[nest.index[contour.id]] = NarrowFeatures(contour, features, tuple(burnt))
    return found


def _what_to_do(features: NarrowFeatures, options: LeadOptions) -> str:
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
            kept = kept_because(nest, hole, limits) if limits.under != "refuse" else None
            found[k] = too_small(hole.id, diameter_mm, limits) + (f"; {kept}" if kept else "")
    return found


def _locked(outlines: Mapping[int, Outline], nest: Nest, options: LeadOptions) -> Joints:
    """The joints at the entries that an operator asks for."""
    found = []
    for name, point in sorted(options.entry_points.items()):
        outline = outlines.get(nest.index[name])
        if outline is not None:
            at_mm, _ = outline.drawn.project(np.array([point]))
            found.append(outline.joints(at_mm)[0])
    return Joints.joined(found)
