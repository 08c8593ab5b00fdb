"""Reads routing instances: PCGLNS files and TSPLIB's sequential ordering problems, gzipped or not."""

from __future__ import annotations

import gzip
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...encoder.errors import InputError
from .instance import Instance

Ints = NDArray[np.int64]
KINDS = (".pcglns", ".sop")
HEADS = ("EDGE_WEIGHT_SECTION", "GTSP_SET_SECTION", "GTSP_SET_ORDERING", "START_GROUP_SECTION", "EOF")


def is_instance(path: str | Path) -> bool:
    """Whether the name is that of a routing instance."""
    return _kind(Path(path)) in KINDS


def read_instance(path: str | Path) -> Instance:
    """Read `.pcglns` or `.sop`, also with `.gz` behind it.

    Raises
    ------
    InputError
        If the file cannot be read, or is not what its name says; with the section at fault.
    """
    path = Path(path)
    kind = _kind(path)
    if kind not in KINDS:
        raise InputError(f"{path}: expected a routing instance named *.pcglns or *.sop (with or without .gz)")
    try:
        raw = path.read_bytes()
        text = (gzip.decompress(raw) if path.suffix == ".gz" else raw).decode("utf-8", "replace")
    except (OSError, EOFError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    sections = _sections(text)
    name = path.name.removesuffix(".gz").removesuffix(kind)
    return _generalised(name, path, sections) if kind == ".pcglns" else _sequential(name, path, sections)


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


def _numbers(path: Path, sections: dict[str, list[str]], head: str) -> list[list[int]]:
    if head not in sections:
        raise InputError(f"{path}: section {head} is missing")
    try:
        return [[int(word) for word in line.split()] for line in sections[head]]
    except ValueError as error:
        raise InputError(f"{path}: section {head}: whole numbers were expected: {error}") from error


def _size(path: Path, sections: dict[str, list[str]]) -> int:
    for line in sections[""]:
        key, _, value = line.partition(":")
        if key.strip() == "DIMENSION" and value.strip().isdigit() and int(value) > 0:
            return int(value)
    raise InputError(f"{path}: the header says no DIMENSION")


def _matrix(path: Path, sections: dict[str, list[str]], size: int) -> Ints:
    """The weights; TSPLIB's own ordering problems give their size once more before them."""
    rows = _numbers(path, sections, "EDGE_WEIGHT_SECTION")
    numbers = [number for row in rows for number in row]
    if len(numbers) == size * size + 1 and numbers[0] == size:
        numbers = numbers[1:]
    if len(numbers) != size * size:
        raise InputError(
            f"{path}: section EDGE_WEIGHT_SECTION: {size} × {size} weights were expected, {len(numbers)} are there"
        )
    return np.array(numbers, dtype=np.int64).reshape(size, size)


def _sequential(name: str, path: Path, sections: dict[str, list[str]]) -> Instance:
    size = _size(path, sections)
    cost = _matrix(path, sections, size)
    later, sooner = np.nonzero((cost == -1) & ~np.eye(size, dtype=np.bool_))
    orders = set(zip(sooner.tolist(), later.tolist(), strict=True))
    orders |= {(0, k) for k in range(1, size)} | {(k, size - 1) for k in range(size - 1)}
    _refuse_cycles(path, orders)
    return Instance(name, cost, tuple((v,) for v in range(size)), tuple(sorted(orders)), start=0, closed=False)


def _generalised(name: str, path: Path, sections: dict[str, list[str]]) -> Instance:
    size = _size(path, sections)
    clusters = _clusters(path, sections, size)
    orders: set[tuple[int, int]] = set()
    for row in _numbers(path, sections, "GTSP_SET_ORDERING"):
        named = [k - 1 for k in row if k != -1]
        if not all(0 <= k < len(clusters) for k in named):
            raise InputError(f"{path}: section GTSP_SET_ORDERING: {row} names a set that there is not")
        orders |= {(named[0], later) for later in named[1:]}
    starts = [k - 1 for row in _numbers(path, sections, "START_GROUP_SECTION") for k in row if k != -1]
    if len(starts) != 1 or not 0 <= starts[0] < len(clusters):
        raise InputError(f"{path}: section START_GROUP_SECTION: the number of one set was expected")
    if len(clusters[starts[0]]) != 1:
        raise InputError(f"{path}: the start group has {len(clusters[starts[0]])} vertices; one was expected")
    orders |= {(starts[0], k) for k in range(len(clusters)) if k != starts[0]}
    _refuse_cycles(path, orders)
    cost = _matrix(path, sections, size)
    return Instance(name, cost, clusters, tuple(sorted(orders)), start=clusters[starts[0]][0], closed=True)


def _clusters(path: Path, sections: dict[str, list[str]], size: int) -> tuple[tuple[int, ...], ...]:
    rows = _numbers(path, sections, "GTSP_SET_SECTION")
    members = {row[0]: tuple(v - 1 for v in row[1:] if v != -1) for row in rows}
    if sorted(members) != list(range(1, len(rows) + 1)):
        raise InputError(f"{path}: section GTSP_SET_SECTION: sets numbered 1 to {len(rows)} were expected")
    if sorted(v for vertices in members.values() for v in vertices) != list(range(size)):
        raise InputError(f"{path}: section GTSP_SET_SECTION: every vertex 1 to {size} must be in one set")
    return tuple(members[k] for k in sorted(members))


def _refuse_cycles(path: Path, orders: set[tuple[int, int]]) -> None:
    sorter: TopologicalSorter[int] = TopologicalSorter()
    for a, b in orders:
        sorter.add(b, a)
    try:
        sorter.prepare()
    except CycleError as error:
        cycle = ", ".join(str(k + 1) for k in error.args[1])
        raise InputError(f"{path}: the orders contradict each other: {cycle}") from error
