"""Candidates whose leads would meet those of other contours' candidates are thinned out until none do.

Which candidate a neighbour was cut by is more than the engines' states hold. So entries are chosen beforehand that
keep out of each other's way; where a street is too narrow for that, what is left to meet becomes a condition.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Sequence

from .candidate import Candidate
from .older_kerfs import OlderKerfs


def keep_apart(candidates: Sequence[Candidate], met: OlderKerfs, locked: Collection[int] = ()) -> tuple[int, ...]:
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
