"""Plans, profiles and job files, each changed as a hand may change it: one value, row or key a mutant."""

from __future__ import annotations

import copy
import random
from collections.abc import Iterator
from typing import Any

Path = tuple[str | int, ...]


def _leaves(data: Any, path: Path = ()) -> Iterator[Path]:
    """Where each value, list and mapping of a tree stands, the tree itself aside."""
    members = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, member in members:
        yield (*path, key)
        yield from _leaves(member, (*path, key))


def _at(data: Any, path: Path) -> Any:
    for step in path:
        data = data[step]
    return data


def _others(value: Any, elsewhere: list[Any], rnd: random.Random) -> Iterator[tuple[str, Any]]:
    """What may stand in the place of a value; `elsewhere` are those under the same key in other rows."""
    if isinstance(value, bool):
        yield "flipped", not value
    elif isinstance(value, int | float):
        yield "more", value + 5
        yield "twice", 2 * value
        yield "negative", -value
        yield "a half", value // 2 if isinstance(value, int) else value / 2
    elif isinstance(value, str):
        yield "another text", f"{value}x"
    if elsewhere:
        yield "of another row", copy.deepcopy(rnd.choice(elsewhere))
    if isinstance(value, list) and value:
        at = rnd.randrange(len(value))
        yield "member dropped", value[:at] + value[at + 1 :]
        yield "member doubled", value[: at + 1] + value[at:]
        yield "members turned round", value[::-1]


def tree_mutants(data: Any, count: int, seed: str) -> Iterator[tuple[str, Any]]:
    """Copies of a tree with one change each: what was done, with its place, and the copy."""
    rnd, paths, made = random.Random(seed), list(_leaves(data)), 0
    while made < count:
        path = rnd.choice(paths)
        value = _at(data, path)
        elsewhere = [other for p in paths if p[-1] == path[-1] and (other := _at(data, p)) != value]
        ways = list(_others(value, elsewhere, rnd))
        if isinstance(path[-1], str):
            ways.append(("key dropped", None))
        if not ways:
            continue
        what, other = rnd.choice(ways)
        tree = copy.deepcopy(data)
        holder = _at(tree, path[:-1])
        if what == "key dropped":
            del holder[path[-1]]
        else:
            holder[path[-1]] = other
        if tree != data:
            made += 1
            yield f"{'.'.join('*' if isinstance(step, int) else step for step in path)}: {what}", tree
