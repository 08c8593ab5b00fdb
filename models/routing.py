"""Routing instances of the field: sequential ordering and its generalised form, read, solved, judged."""

from __future__ import annotations

import gzip
import math
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.graphs import strong_components
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.portfolio import run_portfolio
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.problem.compile import MOST_UM, dearest_um
from kerfwise.models.problem.precedence import close
from kerfwise.models.problem.problem import Problem
from kerfwise.models.problem.simplify import simplify

# A routing instance as its file says it, and the same as a `Problem` that every engine takes.


@dataclass(frozen=True, eq=False)
class Instance:
    """A tour visits one vertex of every cluster, clusters in an order that keeps `orders`, and costs the arcs it takes.

    Vertices and clusters are numbered from 0 here and from 1 in files and tours. `cost` is (v, v); `clusters[k]` the
    vertices of cluster k; `orders` (k, 2) pairs of clusters (before, after), sorted. `start` is the vertex that every
    tour begins at. A `closed` tour returns there, an open one ends at the last vertex visited.
    """

    name: str
    cost: Ints
    clusters: tuple[tuple[int, ...], ...]
    orders: Ints
    start: int
    closed: bool

    @cached_property
    def problem(self) -> Problem:
        """The instance with the start as home: cluster k that is not the start's is contour k, or k - 1 after it."""
        home = next(k for k, members in enumerate(self.clusters) if self.start in members)
        rest = [k for k in range(len(self.clusters)) if k != home]
        number = np.zeros(len(self.clusters), dtype=np.int64)
        number[rest] = np.arange(len(rest))
        n = len(rest)
        before = close(n, number[self.orders[self.orders[:, 0] != home]], np.arange(n, dtype=np.int64))
        counts = [len(self.clusters[k]) for k in rest]
        m = sum(counts)
        nowhere = np.zeros((m, 2), dtype=np.int64)
        return Problem(
            n=n,
            first=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
            site_contour=np.repeat(np.arange(n, dtype=np.int64), counts),
            site_candidate=np.arange(m, dtype=np.int64),
            candidate_site=np.arange(m, dtype=np.int64),
            pierce_um=nowhere,
            end_um=nowhere,
            site_cost=np.zeros(m, dtype=np.int64),
            home_um=np.zeros(2, dtype=np.int64),
            travel_weight=1.0,
            before=before,
            block=np.arange(n, dtype=np.int64),
            conditions=(),
            soft_groups=(),
            lags=(),
            general=(),
            ids=tuple(str(k + 1) for k in rest),
            matrix=self._matrix(),
        )

    def tour(self, route: Sequence[int]) -> tuple[int, ...]:
        """The vertices, numbered as in the file, of a route through the sites of `problem`."""
        vertices = self._vertices()
        return tuple(int(vertices[s]) + 1 for s in (len(vertices) - 1, *route))

    def _vertices(self) -> Ints:
        """The vertex of every site, that of home last."""
        rest = [v for members in self.clusters if self.start not in members for v in members]
        return np.array([*rest, self.start], dtype=np.int64)

    def _matrix(self) -> Ints:
        """Costs between sites. What stands where an order forbids the arc (-1, often) is made the dearest arc."""
        vertices = self._vertices()
        matrix = self.cost[np.ix_(vertices, vertices)].copy()
        matrix[matrix < 0] = matrix.max()
        if not self.closed:
            matrix[:, -1] = 0
        return matrix


# Reads routing instances: PCGLNS files and TSPLIB's sequential ordering problems, gzipped or not.

KINDS = (".pcglns", ".sop")
HEADS = ("EDGE_WEIGHT_SECTION", "GTSP_SET_SECTION", "GTSP_SET_ORDERING", "START_GROUP_SECTION", "EOF")


MOST_BYTES = 64_000_000
"""A full matrix of some four thousand vertices; what is larger could not be planned in any case."""
WORDS_AT_ONCE = 1 << 20
"""Characters of a section that are split into words in one go, which takes twenty times their memory."""


LONGEST_ROW = 1_000_000
"""Characters of a line that lists sets or vertices: there are a few thousand of either."""


class _Fault(Exception):
    """What is wrong with the text of an instance."""


def is_instance(path: str | Path) -> bool:
    """Whether the name is that of a routing instance."""
    return _kind(Path(path)) in KINDS


def read_instance(path: str | Path) -> Instance:
    """Read `.pcglns` or `.sop`, also with `.gz` behind it.

    Raises InputError if the file cannot be read, or is not what its name says; with the section at fault.
    """
    path = Path(path)
    kind = _kind(path)
    if kind not in KINDS:
        raise InputError("expected a routing instance: *.pcglns or *.sop, with or without .gz", file=path)
    try:
        with gzip.open(path) if path.suffix == ".gz" else path.open("rb") as file:
            raw = file.read(MOST_BYTES + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(f"cannot be read: {error}", file=path) from None
    if len(raw) > MOST_BYTES:
        raise InputError(f"holds over {MOST_BYTES // 1_000_000} MB of text: too large an instance", file=path)
    sections = _sections(raw.decode("utf-8", "replace"))
    name = path.name.removesuffix(".gz").removesuffix(kind)
    try:
        return _generalised(name, sections) if kind == ".pcglns" else _sequential(name, sections)
    except _Fault as fault:
        raise InputError(str(fault), file=path) from None


def _kind(path: Path) -> str:
    return Path(path.name.removesuffix(".gz")).suffix


def _sections(text: str) -> dict[str, list[str]]:
    """The lines of every section, and of the header under ""."""
    sections: dict[str, list[str]] = {"": []}
    at = ""
    for line in text.splitlines():
        words = line.split()
        head = words[0].rstrip(":") if words else ""
        if head in HEADS:
            at = head
            sections[at] = []
        elif words:
            sections[at].append(line)
    return sections


def _rows(sections: dict[str, list[str]], head: str) -> Iterator[list[int]]:
    """The whole numbers of a section, line by line; -1, which ends a line, is left out."""
    if head not in sections:
        raise _Fault(f"section {head} is missing")
    for line in sections[head]:
        if len(line) > LONGEST_ROW:
            raise _Fault(f"section {head}: a line of {len(line)} characters: at most {LONGEST_ROW} are read")
        try:
            yield [int(word) for word in line.split() if word != "-1"]
        except ValueError as error:
            raise _Fault(f"section {head}: whole numbers were expected: {error}") from None


def _matrix(sections: dict[str, list[str]]) -> Ints:
    """The weights (v, v); TSPLIB's own ordering problems give their size once more before them."""
    sizes = [
        value.strip() for key, _, value in (line.partition(":") for line in sections[""]) if key.strip() == "DIMENSION"
    ]
    if len(sizes) != 1 or not sizes[0].isdigit() or int(sizes[0]) < 1:
        raise _Fault("the header must give one DIMENSION, a whole number")
    size = int(sizes[0])
    if "EDGE_WEIGHT_SECTION" not in sections:
        raise _Fault("section EDGE_WEIGHT_SECTION is missing")
    weights, so_many = _numbers(sections["EDGE_WEIGHT_SECTION"], size * size + 1)
    if so_many == size * size + 1 and weights[0] == size:
        weights, so_many = weights[1:], size * size
    if so_many != size * size:
        raise _Fault(f"section EDGE_WEIGHT_SECTION: {size} × {size} weights were expected, {so_many} are there")
    return weights.reshape(size, size)


def _numbers(lines: Sequence[str], most: int) -> tuple[Ints, int]:
    """The whole numbers in lines of text, and how many there are; of more than `most` no more are kept."""
    kept: list[Ints] = []
    so_many = 0
    for words in _words(lines):
        if so_many > most:
            so_many += len(words)
            continue
        try:
            kept.append(np.array(words, dtype=np.int64))
        except (ValueError, OverflowError) as error:
            raise _Fault(f"section EDGE_WEIGHT_SECTION: whole numbers were expected: {error}") from None
        so_many += len(words)
    return np.concatenate([np.zeros(0, np.int64), *kept])[:most], so_many


def _words(lines: Sequence[str]) -> Iterator[list[str]]:
    """The words in lines of text, some at a time."""
    waiting = ""
    for line in lines:
        for begin in range(0, len(line), WORDS_AT_ONCE):
            waiting += line[begin : begin + WORDS_AT_ONCE]
            if len(waiting) >= WORDS_AT_ONCE:
                end = max(waiting.rfind(space) for space in " \t\n") + 1
                yield waiting[:end].split()
                waiting = waiting[end:]
        waiting += "\n"
    yield waiting.split()


def _sequential(name: str, sections: dict[str, list[str]]) -> Instance:
    """TSPLIB's: an open path from the first to the last vertex; -1 in row i, column j says that j comes before i."""
    cost = _matrix(sections)
    size = len(cost)
    before = (cost == -1).T
    before[0, :] = before[:, -1] = True
    np.fill_diagonal(before, False)
    orders = np.argwhere(before)
    return _instance(name, cost, tuple((v,) for v in range(size)), orders, start=0, closed=False)


def _generalised(name: str, sections: dict[str, list[str]]) -> Instance:
    """PCGLNS's: a closed tour through one vertex of every set; an ordering `a b c` puts a before b and c."""
    cost = _matrix(sections)
    clusters = _clusters(sections, len(cost))
    before = np.zeros((len(clusters), len(clusters)), dtype=np.bool_)
    for row in _rows(sections, "GTSP_SET_ORDERING"):
        if not all(1 <= k <= len(clusters) for k in row):
            raise _Fault(f"section GTSP_SET_ORDERING: {row} names a set that there is not")
        if len(row) > 1:
            before[row[0] - 1, np.array(row[1:]) - 1] = True
    starts = [k for row in _rows(sections, "START_GROUP_SECTION") for k in row]
    if len(starts) != 1 or not 1 <= starts[0] <= len(clusters):
        raise _Fault("section START_GROUP_SECTION: the number of one set was expected")
    home = starts[0] - 1
    if len(clusters[home]) != 1:
        raise _Fault(f"the start group has {len(clusters[home])} vertices; only a start at one vertex can be solved")
    before[home, np.arange(len(clusters)) != home] = True
    return _instance(name, cost, clusters, np.argwhere(before), start=clusters[home][0], closed=True)


def _clusters(sections: dict[str, list[str]], size: int) -> tuple[tuple[int, ...], ...]:
    members = {row[0]: tuple(v - 1 for v in row[1:]) for row in _rows(sections, "GTSP_SET_SECTION") if row}
    if not members or sorted(members) != list(range(1, len(members) + 1)) or not all(members.values()):
        raise _Fault("section GTSP_SET_SECTION: sets numbered from 1 on, none of them empty, were expected")
    if sorted(v for vertices in members.values() for v in vertices) != list(range(size)):
        raise _Fault(f"section GTSP_SET_SECTION: every vertex 1 to {size} must be in one set")
    return tuple(members[k] for k in sorted(members))


def _instance(
    name: str,
    cost: Ints,
    clusters: tuple[tuple[int, ...], ...],
    orders: Ints,
    start: int,
    closed: bool,
) -> Instance:
    if circle := _circle(orders, len(clusters)):
        raise _Fault(f"the orders contradict each other: {', '.join(str(k + 1) for k in circle)}")
    return Instance(name, cost, clusters, orders, start, closed)


def _circle(orders: Ints, n: int) -> list[int]:
    """Clusters that each must come before the next, the first again at the end; empty where there are none such.

    Examples
    --------
    >>> _circle(np.array([[0, 1], [1, 2], [2, 1]]), 3), _circle(np.array([[0, 1], [1, 2]]), 3)
    ([1, 2, 1], [])
    """
    before, after = orders.T
    component = strong_components(n, orders)
    among = orders[component[before] == component[after]]
    if not len(among):
        return []
    follows = dict(zip(among[:, 0].tolist(), among[:, 1].tolist(), strict=True))
    walked = [int(among[0, 0])]
    while (then := follows[walked[-1]]) not in walked:
        walked.append(then)
    return [*walked[walked.index(then) :], then]


# Judges a tour by the instance's own numbers alone: nothing of the problem that the engines saw is used.


def judge_tour(instance: Instance, tour: Sequence[int]) -> tuple[int, str]:
    """Cost of a tour (vertices numbered from 1, the start first), and what is wrong with it, "" for nothing."""
    vertices = [v - 1 for v in tour]
    if not all(0 <= v < len(instance.cost) for v in vertices):
        return 0, "there is no such vertex"
    cluster_of = {v: k for k, members in enumerate(instance.clusters) for v in members}
    visited = [cluster_of[v] for v in vertices]
    if vertices[:1] != [instance.start]:
        return 0, f"the tour does not begin at vertex {instance.start + 1}"
    if sorted(visited) != list(range(len(instance.clusters))):
        return 0, "a cluster is not visited once"
    place = np.argsort(visited)
    late = instance.orders[place[instance.orders[:, 0]] > place[instance.orders[:, 1]]]
    steps = [*pairwise(vertices), *([(vertices[-1], instance.start)] if instance.closed else [])]
    cost = sum(int(instance.cost[a, b]) for a, b in steps)
    if len(late):
        a, b = late[0].tolist()
        return cost, f"cluster {a + 1} must come before cluster {b + 1}"
    return cost, ""


# Solves a routing instance by the engines that solve nests.


@dataclass(frozen=True, slots=True)
class Answer:
    """A tour in the file's own vertex numbers, empty if none was found, and what is proven of the best tour's cost.

    `bound` is None where nothing is proven, `infeasible` says that no tour keeps the orders.
    """

    tour: tuple[int, ...]
    cost: int | None
    bound: int | None
    infeasible: bool
    notes: tuple[str, ...]

    @property
    def proven(self) -> bool:
        """Whether no tour is cheaper."""
        return self.infeasible or (self.cost is not None and self.bound is not None and self.bound >= self.cost)


def solve_instance(instance: Instance, options: SolveOptions, progress: Progress | None = None) -> Answer:
    """The best tour found within the limits. Raises InputError if the costs of the instance could overflow."""
    if sum(dearest_um(instance.problem).values()) > MOST_UM:
        raise InputError(
            f"a tour could cost over {MOST_UM:,}, too much to be counted exactly: make the weights smaller"
        )
    problem = simplify(instance.problem)
    known = run_portfolio(problem, options, progress)
    bound = known.bound_um if known.proved_by else None
    if known.incumbent is None:
        return Answer((), None, bound, known.infeasible, tuple(known.notes))
    cost = known.incumbent.cost
    tour = instance.tour([int(problem.site_candidate[s]) for s in known.incumbent.route])
    return Answer(tour, cost, None if bound is None else min(bound, cost), False, tuple(known.notes))


# The shortest way through points, each visited once, from one place to another: a plain problem without orders.

MOST_AT_ONCE = 400
"""Points of one problem: where there are more they are taken in strips, from left to right."""
_UM = 1000


def way_through(points: Sequence[Point], start: Point, end: Point, options: SolveOptions) -> list[int]:
    """The numbers of the points in the order of a short way from `start` through all of them to `end`.

    Examples
    --------
    >>> way_through([(30, 0), (10, 0), (20, 0)], (0, 0), (40, 0), SolveOptions(work=0.1))
    [1, 2, 0]
    """
    by_x = sorted(range(len(points)), key=lambda k: (points[k], k))
    strips = [by_x[k : k + MOST_AT_ONCE] for k in range(0, len(by_x), MOST_AT_ONCE)]
    if len(strips) > 1 and math.dist(start, points[by_x[-1]]) < math.dist(start, points[by_x[0]]):
        strips.reverse()
    way: list[int] = []
    at = start
    for number, strip in enumerate(strips, 1):
        goal = end if number == len(strips) else _middle([points[k] for k in strips[number]])
        way += [strip[k] for k in _solved([points[k] for k in strip], at, goal, options)]
        at = points[way[-1]]
    return way


def _solved(points: Sequence[Point], start: Point, end: Point, options: SolveOptions) -> list[int]:
    if len(points) < 2:
        return list(range(len(points)))
    places = np.array([start, *points])
    cost = np.rint(np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) * _UM).astype(np.int64)
    cost[:, 0] = np.rint(np.hypot(*(places - np.array(end)).T) * _UM).astype(np.int64)
    cost[0, 0] = 0
    clusters = tuple((k,) for k in range(len(places)))
    orders = np.empty((0, 2), dtype=np.int64)
    answer = solve_instance(Instance("way", cost, clusters, orders, 0, closed=True), options)
    return [vertex - 2 for vertex in answer.tour[1:]] or list(range(len(points)))


def _middle(points: Sequence[Point]) -> Point:
    x, y = np.mean(points, axis=0).tolist()
    return x, y
