"""One look for ways to cut some contours under some options: what was found, and what stands without."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.narrow import lost_features, said_of
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.small_holes import HoleLimits, diameter_under, kept_because, too_small

from .approaches import Approaches
from .candidate import LeadOptions
from .joints import Joints, Outline
from .search import approaches_to
from .surroundings import Surroundings
from .within_reach import out_of_reach


@dataclass(frozen=True, eq=False, slots=True)
class Tried:
    """The outlines of the contours that may be cut, the approaches found, and the joints that locks ask for.

    By contour number, `small` says what is wrong with holes that are too small, `uncut` with contours that the kerf
    cannot follow, `narrow` with those of which it would lose a feature, `beyond` with those that the machine does not
    reach, marks included. `bare` are contours without any
    approach, `unmet` the rows of `locked` without one.
    """

    outlines: Mapping[int, Outline]
    found: Approaches
    locked: Joints
    small: Mapping[int, str]
    uncut: Mapping[int, str]
    narrow: Mapping[int, str]
    beyond: Mapping[int, str]
    bare: tuple[int, ...]
    unmet: tuple[int, ...]

    @property
    def faulty(self) -> frozenset[int]:
        """Every contour that cannot be cut as the options ask."""
        unmet = (int(self.locked.contour[i]) for i in self.unmet)
        return frozenset((*self.small, *self.uncut, *self.narrow, *self.beyond, *self.bare, *unmet))


def try_options(nest: Nest, contours: Iterable[int], around: Surroundings, options: LeadOptions) -> Tried:
    """Look for approaches to the contours of these numbers; marks need none."""
    chosen = list(contours)
    small = _small_holes(nest, chosen, options.holes)
    outlines: dict[int, Outline] = {}
    uncut: dict[int, str] = {}
    beyond: dict[int, str] = {}
    for k in (k for k in chosen if k not in small):
        contour = nest.contours[k]
        path = contour.curve
        try:
            if contour.kind != "mark":
                path = compensated(contour, options.kerf_mm)
                outlines[k] = Outline.of(k, contour, path, options.kerf_mm / 2)
        except InputError as error:
            uncut[k] = error.message
            continue
        if far := out_of_reach(contour, path, options.reach):
            beyond[k] = far
    narrow = _narrow(nest, [k for k in chosen if k not in small], outlines, options.kerf_mm)
    for k in narrow:
        outlines.pop(k, None)
        uncut.pop(k, None)
    locked = _locked(outlines, nest, options)
    found = approaches_to(outlines, locked, around, options)
    joints = found.ways.joints
    led = set(zip(joints.contour.tolist(), joints.entry_mm.tolist(), strict=True))
    bare = tuple(sorted(set(outlines) - {k for k, _ in led}))
    asked = zip(locked.contour.tolist(), locked.entry_mm.tolist(), strict=True)
    unmet = tuple(i for i, (k, entry_mm) in enumerate(asked) if k not in bare and (k, entry_mm) not in led)
    return Tried(outlines, found, locked, small, uncut, narrow, beyond, bare, unmet)


def _narrow(nest: Nest, contours: Iterable[int], outlines: Mapping[int, Outline], kerf_mm: float) -> dict[int, str]:
    """Contours of which the kerf would lose a slot, notch, neck or corner, and which."""
    paths = {outline.contour.id: outline.path for outline in outlines.values()}
    lost = lost_features([nest.contours[k] for k in contours], kerf_mm, paths)
    return {nest.index[name]: said_of(name, features, kerf_mm) for name, features in lost.items()}


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
