"""What the pierce and the leads of a candidate would meet of cuts made before it: their kerfs are void.

The torch cannot pierce where there is no metal, and its arc goes out over a kerf that a lead crosses. How far a
contour's own kerf reaches depends on nothing but the contour; a lead's kerf depends on which candidate was used.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Bools, Ints, unique_pairs
from kerfwise.encoder.nest import Nest

from .candidate import Candidate
from .entries import Leads
from .obstacles import EXACT_MM, Lines, Surroundings, nearer


@dataclass(frozen=True, eq=False, slots=True)
class OlderKerfs:
    """What candidates meet, if it has been cut before them.

    `rings` (k, 2) are rows (candidate, contour): the candidate's pierce or a lead of it meets the kerf of that contour.
    `leads` (l, 2) are rows (later, earlier) of candidates: the pierce or a lead of the later meets the kerf of a lead
    of the earlier. Both sorted, each row once, and between two parts: the metal of one part keeps its own cuts apart,
    but for slits, which begin in the waste beside them. A slit is cut before the contour that its slot is of, and never
    meets that one's.
    """

    rings: Ints
    leads: Ints

    @staticmethod
    def none() -> OlderKerfs:
        """Nothing meets anything."""
        return OlderKerfs(np.empty((0, 2), dtype=np.int64), np.empty((0, 2), dtype=np.int64))

    def of_kept(self, kept: Sequence[int], count: int) -> OlderKerfs:
        """The same of some of `count` candidates, which are numbered by their place in `kept` from now on.

        Examples
        --------
        >>> met = OlderKerfs(np.array([[0, 7], [2, 7]]), np.array([[0, 1], [2, 0]]))
        >>> left = met.of_kept([2, 0], 3)
        >>> left.rings.tolist(), left.leads.tolist()
        ([[0, 7], [1, 7]], [[0, 1]])
        """
        number = np.full(count, -1, dtype=np.int64)
        number[list(kept)] = np.arange(len(kept))
        rings = np.column_stack([number[self.rings[:, 0]], self.rings[:, 1]])
        leads = number[self.leads]
        return OlderKerfs(unique_pairs(rings[rings[:, 0] >= 0]), unique_pairs(leads[(leads >= 0).all(axis=1)]))


def older_kerfs(
    nest: Nest,
    candidates: Sequence[Candidate],
    kerf_mm: float,
    splash_mm: float,
    around: Surroundings | None = None,
) -> OlderKerfs:
    """What each candidate would meet of the others; `around` are the surroundings of the nest, where they are at hand.

    The kerf of a cut is the strip of `kerf_mm` around the torch's path. A pierce keeps `kerf_mm / 2 + splash_mm` from
    it, measured from the middle of the pierce; a lead's middle line does not enter it, but for the last
    `kerf_mm / 2` beside the lead's own contour. An edge start pierces nothing. Ways along a stretch of a contour begin
    in an old kerf, and have no leads.

    Examples
    --------
    >>> from kerfwise.encoder.candidates import LeadOptions, build_candidates
    >>> from kerfwise.rules.case import nest, part, rect
    >>> two = nest(400, 100, part("A", rect(10, 10, 80, 80)), part("B", rect(94, 10, 80, 80)))
    >>> ways = build_candidates(two, LeadOptions(entries=4, splash_mm=None))
    >>> older_kerfs(two, ways, 1.5, 0.5).leads[:2].tolist()
    [[2, 8], [2, 9]]
    """
    burning = [k for k, c in enumerate(candidates) if nest.contours[c.contour].shapes_part and c.span is None]
    if not burning:
        return OlderKerfs.none()
    nest = nest.without_scrap  # scrap lines are cut when no contour, and no lead, is left that their kerf could be in
    candidates = [c for c in candidates if c.contour < len(nest.contours)]  # theirs are the last ones
    part = np.array(
        [len(nest.parts) + k if c.kind == "slit" else nest.owners[k] for k, c in enumerate(nest.contours)],
        dtype=np.int64,
    )
    paths = _Paths.of(burning, candidates, part, kerf_mm)
    around = Surroundings.of(nest) if around is None else around
    rings, leads = _ring_rows(nest, around, paths, part, kerf_mm, splash_mm), _lead_rows(paths, kerf_mm, splash_mm)
    of = np.array([c.contour for c in candidates], dtype=np.int64)
    slot = np.array([nest.index.get(c.slot_of, -1) for c in nest.contours], dtype=np.int64)
    return OlderKerfs(rings[slot[of[rings[:, 0]]] != rings[:, 1]], leads[slot[of[leads[:, 0]]] != of[leads[:, 1]]])


@dataclass(frozen=True, eq=False, slots=True)
class _Paths:
    """Pierces, leads, and the leads without what lies beside their own contour; `_of` tells whose each row is.

    `part` numbers the part of each candidate, with a number of its own for each slit.
    """

    part: Ints
    pierces: Lines
    pierce_of: Ints
    leads: Lines
    lead_of: Ints
    free: Lines
    free_of: Ints

    @staticmethod
    def of(burning: Sequence[int], candidates: Sequence[Candidate], part: Ints, kerf_mm: float) -> _Paths:
        """The paths of the candidates with these numbers."""
        numbers = np.array(burning, dtype=np.int64)
        pierced = np.array([not candidates[k].edge_start for k in burning], dtype=np.bool_)
        pierces = shapely.points(np.array([candidates[k].pierce for k in burning]).reshape(-1, 2))
        ends = [end for k in burning for end in _lead_ends(k, candidates[k])]
        of = np.array([k for k, _, _ in ends], dtype=np.int64)
        rows = np.array([row for _, row, _ in ends], dtype=np.float64).reshape(-1, 6)
        joins = np.array([at_contour for _, _, at_contour in ends], dtype=np.bool_)
        leads = Leads(rows[:, 0:2], rows[:, 2:4], rows[:, 4], rows[:, 5])
        long = joins & (leads.length_mm > kerf_mm / 2 + EXACT_MM)
        before = ~joins  # the rest of a lead of several lines and arcs, as old programs have them
        return _Paths(
            part[[c.contour for c in candidates]],
            pierces[pierced],
            numbers[pierced],
            shapely.linestrings(leads.points()),
            of,
            np.concatenate(
                [
                    shapely.linestrings(leads.take(long).points(kerf_mm / 2, most=1.0)),
                    shapely.linestrings(leads.take(before).points()),
                ]
            ),
            np.concatenate([of[long], of[before]]),
        )

    def met(
        self,
        tree: shapely.STRtree,
        name: Ints,
        part: Ints,
        pierce_mm: float,
        lead_mm: float,
        mask: Bools | None = None,
    ) -> Ints:
        """Rows (candidate, name of a line), sorted, where a candidate comes too near to a line of another part.

        `pierce_mm` is what pierces keep, `lead_mm` what leads keep; `part` numbers the part of each line. Only lines
        that are `mask` count, where not all do.
        """
        found = []
        for shapes, of, least_mm in ((self.pierces, self.pierce_of, pierce_mm), (self.free, self.free_of, lead_mm)):
            row, line = nearer(tree, shapes, least_mm)
            others = self.part[of[row]] != part[line]
            if mask is not None:
                others &= mask[line]
            found.append(np.column_stack([of[row[others]], name[line[others]]]))
        return unique_pairs(np.concatenate(found))


def _lead_ends(number: int, candidate: Candidate) -> list[tuple[int, tuple[float, ...], bool]]:
    """The lead-in and the lead-out as rows: outer end, end at the contour, bulge, length. Overcuts are no leads.

    A lead-in of several lines and arcs has a row for each; only the last of them ends at the contour.
    """
    found: list[tuple[int, tuple[float, ...], bool]] = []
    if candidate.lead_in is not None and len(candidate.lead_in.vertices) == 2:  # most
        (x, y, bulge), (to_x, to_y, _) = candidate.lead_in.vertices.tolist()
        if length_mm := candidate.lead_in.length_mm:
            found.append((number, (x, y, to_x, to_y, bulge, length_mm), True))
    elif candidate.lead_in is not None:
        segments = list(candidate.lead_in.made_anew())
        found += [(number, (*s.start, *s.end, s.bulge, s.length_mm), s is segments[-1]) for s in segments]
    if candidate.lead_out is not None and candidate.leaves:
        *_, last = candidate.lead_out.made_anew()
        found.append((number, (*last.end, *last.start, -last.bulge, last.length_mm), True))
    return found


def _ring_rows(nest: Nest, around: Surroundings, paths: _Paths, part: Ints, kerf_mm: float, splash_mm: float) -> Ints:
    """Rows (candidate, contour).

    A kerf's far edge lies one kerf from its contour, on the side that is waste, and half a kerf from a slit.
    """
    rings = np.array([c.encloses for c in nest.contours], dtype=np.bool_)
    found = []
    for whose, far_mm in ((rings, kerf_mm), (around.slit, kerf_mm / 2)):
        if whose.any():
            of, pierce_mm = around.contour, far_mm + kerf_mm / 2 + splash_mm
            found.append(paths.met(around.chords, of, part[of], pierce_mm, far_mm, whose[of]))
    return unique_pairs(np.concatenate([np.empty((0, 2), dtype=np.int64), *found]))


def _lead_rows(paths: _Paths, kerf_mm: float, splash_mm: float) -> Ints:
    """Rows (later, earlier) of candidates."""
    return paths.met(
        shapely.STRtree(paths.leads), paths.lead_of, paths.part[paths.lead_of], kerf_mm + splash_mm, kerf_mm / 2
    )


# Candidates whose leads would meet those of other contours' candidates are thinned out until none do.
#
# Which candidate a neighbour was cut by is more than the engines' states hold. So entries are chosen beforehand that
# keep out of each other's way; where a street is too narrow for that, what is left to meet becomes a condition.


def resolve_lead_conflicts(
    candidates: Sequence[Candidate], met: OlderKerfs, locked: Collection[int] = ()
) -> tuple[int, ...]:
    """The numbers of the candidates without most of those that meet others' leads.

    Contours take turns, whoever has fewest candidates left first; each keeps the one that meets fewest kerfs of
    contours and then fewest other candidates, and those that it meets go. The candidates numbered `locked`, which an
    operator asks for, stay; so does what a contour would have nothing without.
    """
    rivals: dict[int, set[int]] = defaultdict(set)
    for later, earlier in met.leads.tolist():
        rivals[later].add(earlier)
        rivals[earlier].add(later)
    if not rivals:
        return tuple(range(len(candidates)))
    bound: dict[int, int] = defaultdict(int)
    for k, _ in met.rings.tolist():
        bound[k] += 1
    waiting: dict[int, set[int]] = defaultdict(set)
    kept_of: dict[int, int] = defaultdict(int)
    for k, candidate in enumerate(candidates):
        if k in rivals:
            waiting[candidate.contour].add(k)
        elif not bound[k]:
            kept_of[candidate.contour] += 1
    out: set[int] = set()

    def keep(k: int) -> None:
        contour = candidates[k].contour
        waiting[contour].discard(k)
        kept_of[contour] += 1
        for rival in rivals[k]:
            of = candidates[rival].contour
            if rival in waiting[of]:
                waiting[of].discard(rival)
                out.add(rival)

    for k in sorted(locked):
        if k in rivals and k not in out:
            keep(k)
    while turn := min(((kept_of[c], len(w), c) for c, w in waiting.items() if w), default=None):
        left = waiting[turn[2]]
        keep(min(left, key=lambda k: (bound[k], len(rivals[k] - out), k)))
    out -= set(locked)
    bare = {c.contour for c in candidates} - {c.contour for k, c in enumerate(candidates) if k not in out}
    return tuple(k for k, c in enumerate(candidates) if k not in out or c.contour in bare)
