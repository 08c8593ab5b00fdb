"""Reads routing instances: PCGLNS files and TSPLIB's sequential ordering problems, gzipped or not."""

from __future__ import annotations

import gzip
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.components import strong_components
from kerfwise.encoder.errors import InputError

from .instance import Instance

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

    Raises
    ------
    InputError
        If the file cannot be read, or is not what its name says; with the section at fault.
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
