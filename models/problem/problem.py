"""The problem: facts and statements as the numbers that every engine works on.

Costs are whole micrometres (of idle travel, or of what a soft rule is worth in it), so that all engines agree to
the last digit. Candidates of a contour that no statement tells apart and that share pierce and end are one *site*.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.ranges import laid_out
from kerfwise.rules.statements import About, AtLeast, Lag

from .conditions import Condition
from .crossings import Crossings
from .followers import Followers
from .links import Links
from .pace import Pace
from .successors import known_followers
from .translated import Translated


@dataclass(frozen=True, slots=True)
class SoftGroup:
    """Contours that should follow each other: every piece beyond the first costs `cost` µm."""

    contours: tuple[int, ...]
    cost: int
    about: About


@dataclass(frozen=True, eq=False, slots=True)
class Problem:
    """n contours, m sites.

    `site_candidate[s]` is the candidate that site s stands for, `candidate_site[c]` the site of candidate c or -1;
    sites of contour i are `first[i]` … `first[i+1] - 1`.
    `pierce_um`, `end_um` are (m, 2) coordinates, µm; `site_cost` (m,) what using a site costs (soft `Forbid`).
    `before[i, j]` says that i must come before j (closure, lifted over contiguous blocks); `block[i]` numbers the
    contiguous block that i belongs to. `conditions` are about sites (`when` is a site here). `general` are statements
    that only an engine with the whole order in hand can judge, as are `lags` but for those of one cut. `crossings`
    are moves that cost more, or are unlawful, once some contour is out. `pace` tells how long cuts and moves take.
    `links` are moves with the torch on, each in place of the idle travel between its two sites.
    `left_out` are soft rules that could not be priced on a problem of this size, and why. `matrix` (m + 1, m + 1), home
    last, replaces idle travel between points where costs are given by a table. `orders` tells hard orders and blocks
    that `before` was made of from others, where it was made of such. `told` is what the statements came to before
    candidates became sites, for a problem of these and more.
    """

    n: int
    first: Ints
    site_contour: Ints
    site_candidate: Ints
    candidate_site: Ints
    pierce_um: Ints
    end_um: Ints
    site_cost: Ints
    home_um: Ints
    travel_weight: float
    before: Bools
    block: Ints
    conditions: tuple[Condition, ...]
    soft_groups: tuple[SoftGroup, ...]
    lags: tuple[Lag, ...]
    general: tuple[AtLeast, ...]
    ids: tuple[str, ...]
    crossings: Crossings = field(default_factory=Crossings)
    pace: Pace = field(default_factory=Pace)
    links: Links = field(default_factory=Links)
    matrix: Ints | None = None
    left_out: tuple[tuple[str, str], ...] = ()
    orders: bytes = b""
    told: Translated = field(default_factory=Translated, repr=False)

    @property
    def m(self) -> int:
        """Number of sites."""
        return len(self.site_contour)

    def sites(self, contour: int) -> range:
        """Site numbers of a contour."""
        return range(int(self.first[contour]), int(self.first[contour + 1]))

    def sites_of(self, contours: Ints | Sequence[int]) -> Ints:
        """Site numbers of several contours, one after the other."""
        chosen = np.asarray(contours, dtype=np.int64)
        return laid_out(self.first[chosen], self.first[chosen + 1] - self.first[chosen])

    @property
    def looks_one_back(self) -> bool:
        """Whether the cost of a step depends on nothing but the set already cut and the last site.

        Lags of more than one cut or of seconds, and general statements, look further back than that.
        """
        return self.further_back is None

    @property
    def further_back(self) -> About | None:
        """The first statement that looks further back than a set and the last site tell; None where none does."""
        lags = (lag.about for lag in self.lags if lag.cuts > 1 or lag.seconds > 0)
        return next(lags, self.general[0].about if self.general else None)

    def successors(self) -> Bools:
        """Matrix (n + 1, n + 1): which contour may directly follow which; n is the machine's home."""
        return self.followers().whole()

    def followers(self) -> Followers:
        """The same, as bits: for large problems."""
        return known_followers(self.before, self.block, self.apart())

    def apart(self) -> list[tuple[int, int]]:
        """Contours that may not follow each other, whichever comes first."""
        return [(lag.first, lag.second) for lag in self.lags if lag.weight is None and lag.cuts > 0]

    def travel(self, leave: Ints | Sequence[int], reach: Ints | Sequence[int]) -> Ints:
        """Cost matrix of the moves from the end of each site in `leave` (k,) to the pierce of each in `reach` (l,).

        Idle travel, or a link where there is one. Home is site m. Whole µm, or whatever unit `matrix` has.
        """
        if self.matrix is not None:
            table = np.asarray(self.matrix[np.ix_(np.asarray(leave), np.asarray(reach))], dtype=np.int64)
        else:
            ends, pierces = self._at(self.end_um, leave), self._at(self.pierce_um, reach)
            over, up = (ends[:, None, axis] - pierces[None, :, axis] for axis in (0, 1))
            table = np.rint(self.travel_weight * np.sqrt(over**2 + up**2)).astype(np.int64)
        if len(self.links):
            self.links.laid_over(table, np.asarray(leave), np.asarray(reach))
        return table

    def legs(self, leave: Ints | Sequence[int], reach: Ints | Sequence[int]) -> Ints:
        """Cost of the move from the end of `leave[k]` to the pierce of `reach[k]`, (k,); home is site m."""
        if self.matrix is not None:
            cost = np.asarray(self.matrix[leave, reach], dtype=np.int64)
        else:
            gap = self._at(self.end_um, leave) - self._at(self.pierce_um, reach)
            cost = np.asarray(np.rint(self.travel_weight * np.sqrt((gap**2).sum(axis=1))), dtype=np.int64)
        if not len(self.links):
            return cost
        row = self.links.rows_of(np.asarray(leave), np.asarray(reach))
        return np.where(row >= 0, self.links.cost[row], cost)

    def _at(self, points_um: Ints, sites: Ints | Sequence[int]) -> Floats:
        """The points of some sites, home included, (k, 2)."""
        chosen = np.asarray(sites, dtype=np.int64)
        at = np.empty((len(chosen), 2))
        home = chosen == self.m
        at[home], at[~home] = self.home_um, points_um[chosen[~home]]
        return at

    def ends(self) -> Ints:
        """Where the torch is after every site and at home, (m + 1, 2), µm."""
        return np.vstack([self.end_um, self.home_um])

    def pierces(self) -> Ints:
        """Where every site is pierced, and home, (m + 1, 2), µm."""
        return np.vstack([self.pierce_um, self.home_um])
