"""Everything that rules may know of a nest, computed once. Arrays are indexed like `Nest.contours`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, Literal, get_args

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.already_cut import AlreadyCut
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.candidates.older_kerfs import OlderKerfs
from kerfwise.encoder.cut import Cut, Side
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.identical_parts import Group
from kerfwise.encoder.nest import Kind, Nest

SIDES: tuple[Side, ...] = ("left", "right", "bottom", "top")
Because = Literal["profile", "narrow-side", "long-parts", "offcut", "heat"]
OrderFact = Literal["contains", "level_ahead", "in_hull"]


@dataclass(frozen=True, eq=False, slots=True)
class Column:
    """A fact that one rule alone reads: that rule computes it, and declares how by `FactOptions.columns`.

    `values` (n,) has one for each contour, or, of `pairs`, (k, 2) contour indices; `kind` says which contours have any.
    """

    values: Bools | Ints | Floats
    pairs: bool = False
    kind: Kind | None = None


@dataclass(frozen=True, slots=True)
class FactOptions:
    """Thresholds of the facts, mm unless the name says otherwise (the profile's defaults).

    `start_side` fixes the side ("auto" decides it). `zone_respects` names the order facts that no zone may
    contradict; `zone_pairs` adds pairs of contour ids (before, after), as locks do; `zone_fixed` puts a part
    (by id) in a zone whatever the geometry says; what must go before it is brought forward with it. `zone_places` puts
    a part in the zone that has this position of the order, counted from 1 over all contours. `zone_contours` is
    how many contours a zone has, about, None for as many as a proof bears; `parts_in_one_go` says that the contours of
    a part follow each other. `zone_heat_kj` is how much heat may go into a zone, None for any. `kerf_mm` is what a cut
    burns away; `splash_mm` the metal between a pierced hole and the kerf of an older cut, None where nobody asks what
    meets older kerfs. `pierce_pass` says that the holes of a zone, or of the sheet, are pierced before its cuts.
    `columns` compute the facts that single rules read, by name.
    """

    web_mm: float = 25.0
    edge_band_mm: float = 25.0
    long_ratio: float = 4.0
    offcut_share: float = 0.15
    start_side: Side | Literal["auto"] = "auto"
    zone_contours: int | None = None
    parts_in_one_go: bool = True
    square_ratio: float = 1.25
    zone_heat_kj: float | None = None
    zone_respects: frozenset[OrderFact] = frozenset(get_args(OrderFact))
    zone_pairs: tuple[tuple[str, str], ...] = ()
    zone_fixed: tuple[tuple[str, int], ...] = ()
    zone_places: tuple[tuple[str, int], ...] = ()
    head_share: float = 0.25
    tail_share: float = 0.25
    kerf_mm: float = 1.5
    splash_mm: float | None = 0.5
    pierce_pass: Literal["zone", "sheet"] | None = None
    columns: tuple[Callable[[Nest, FactOptions], Mapping[str, Column]], ...] = ()

    @property
    def zones_decided(self) -> bool:
        """Whether a number, a lock of a zone or a budget of the plant has made the zones, not geometry alone."""
        return self.zone_contours is not None or self.zone_heat_kj is not None or bool(self.zone_fixed)


@dataclass(frozen=True, eq=False, slots=True)
class Facing:
    """What stretches of boundary look at: parallel arrays, one row a (row, neighbour) pair, sorted by both.

    `row` is a contour (in `Facts.neighbours`) or a candidate (in `head`, `tail`); `neighbour` the index of an outer
    contour, for a part in a hole also that of its host; `length_mm` the boundary length that faces it; `gap_mm` the
    smallest gap (nan where not measured). Only outer contours have neighbours.
    """

    row: Ints
    neighbour: Ints
    length_mm: Floats
    gap_mm: Floats


@dataclass(frozen=True, eq=False, slots=True)
class Stretch:
    """What the head or the tail of every candidate's path faces: lengths in mm per candidate, and neighbours."""

    total_mm: Floats
    edge_mm: Floats
    solid_mm: Floats
    neighbours: Facing


@dataclass(frozen=True, slots=True)
class LinkPath:
    """The torch may go on from the end of any of the candidates `leave` to where any of `reach` joins, along `path`."""

    leave: tuple[int, ...]
    reach: tuple[int, ...]
    path: tuple[Point, ...]

    @property
    def length_mm(self) -> float:
        """How much waste it burns."""
        return sum(math.dist(a, b) for a, b in pairwise(self.path))


@dataclass(frozen=True, eq=False, slots=True)
class Past:
    """What came before: the facts of the whole nest, and the cuts that are already made of it.

    `number` (n of the whole,) is the number that each contour has among those left, -1 where it is out, or can no
    longer be cut. Candidates have the same numbers in both: only what is left has any. `loose` are the contours that
    can no longer be cut, each with the contour around it that is out.
    """

    whole: Facts
    already: AlreadyCut
    number: Ints
    loose: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, eq=False, slots=True)
class Copies:
    """What further torches cut together with the first: the facts of the whole nest, and what is cut with what.

    `number` (n of the whole,) is the number of each contour, or of that which the first torch cuts with it, among those
    that the first torch cuts; `candidate` the same of candidates, `torch` (n of the whole,) which torch it is. Torches
    are a `step` apart, mm.
    """

    whole: Facts
    groups: tuple[Group, ...]
    number: Ints
    candidate: Ints
    torch: Ints
    step: Point


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Facts:
    """The facts of one nest. n contours, m candidates.

    Pairs are arrays (k, 2) of contour indices. `contains[:, 0]` contains `contains[:, 1]` (closure), `parent` (n,) the
    immediate container or -1. `level_ahead` and `in_hull` rows read (j, i): j lies ahead of, or in the hull of, i.
    `edge_gap_mm`, `edge_length_mm` are (n, 4) in the order of `SIDES`. `zone` counts from 1; a mark has the zone of its
    part, scrap lines the last. `torch_heat_kj` (n,) is the most heat that cutting a contour, however it is entered,
    leaves in the sheet, 0 for a mark, nan where nobody has said. `offcut_mm`, `offcut_large`, `heat_mm`, `heat_parts`
    follow `SIDES`. `first[i]` and `first[i + 1]` bound the candidates of contour i.
    `older_kerfs` says which candidates would meet the kerf of which contours and leads, were those cut before.
    `links` are ways from one contour to another with the torch on, where the profile wants any.
    `columns` are those of single rules, by name.

    Where several torches cut together, all this is of what the first one cuts (`nest` too), and `copies` say the rest.
    Where some of the sheet is already cut, all this is of what is left (`nest` too); `past` is the rest of the story.
    """

    nest: Nest
    options: FactOptions
    parent: Ints
    contains: Ints
    start_side: Side
    start_side_because: Because
    level_ahead: Ints
    in_hull: Ints
    neighbours: Facing
    edge_gap_mm: Floats
    edge_length_mm: Floats
    solid_mm: Floats
    long: Bools
    offcut_mm: Floats
    offcut_large: Bools
    heat_mm: Floats
    heat_parts: Ints
    zone: Ints
    torch_heat_kj: Floats
    candidates: tuple[Candidate, ...]
    first: Ints
    head: Stretch
    tail: Stretch
    older_kerfs: OlderKerfs
    past: Past | None = None
    links: tuple[LinkPath, ...] = ()
    copies: Copies | None = None
    columns: Mapping[str, Column] = field(default_factory=dict)

    def column(self, name: str) -> Any:
        """The values of a fact that a rule has declared."""
        return self.columns[name].values

    @property
    def n(self) -> int:
        """Number of contours."""
        return len(self.nest.contours)

    @property
    def tabbed(self) -> frozenset[int]:
        """The contours that tabs hold: their parts stay where they are when they are cut."""
        return frozenset(candidate.contour for candidate in self.candidates if candidate.tabs)

    @property
    def held_by_tabs(self) -> frozenset[str]:
        """Ids of the same, and of those that were cut before with tabs."""
        contours = self.nest.contours
        return frozenset(
            [*(contours[k].id for k in self.tabbed), *(cut.contour for cut in self.already_cut if cut.tabs)]
        )

    @property
    def whole_nest(self) -> Nest:
        """The nest as it was drawn, with what is already cut, and with what further torches cut."""
        if self.copies is not None:
            return self.copies.whole.nest
        return (self.nest if self.past is None else self.past.whole.nest).without_stretches

    @property
    def nest_with_ways(self) -> Nest:
        """The same with the ways along stretches that are still to be cut, behind all contours."""
        whole = self.whole_nest
        return replace(whole, stretches=self.nest.stretches) if self.nest.stretches else whole

    @property
    def already_cut(self) -> tuple[Cut, ...]:
        """The cuts that are made, in order."""
        return () if self.past is None else self.past.already.cuts

    @property
    def zone_heat_kj(self) -> Floats:
        """The most heat that goes into each zone, kJ, (m,), the first for zone 1."""
        return np.bincount(self.zone - 1, self.torch_heat_kj).astype(np.float64)

    def candidates_of(self, contour: int) -> range:
        """Candidate numbers of a contour."""
        return range(int(self.first[contour]), int(self.first[contour + 1]))
