"""Small damages to what a JSON or YAML file holds: keys, types, values, depth."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator, Sequence
from random import Random
from typing import Any

import yaml

VALUES: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 2, 0.5, -0.0, 1e-9, 1e10, -1e10, 1e15, 1e300, 1e308, -1e308, float("nan"),
    float("inf"),
    float("-inf"), 10**40, 2**31, 2**63, -(2**63) - 1, "", " ", "0", "-1", "1e308", "nan", "inf", "x", "a\nb", "\0",
    "\x1b[2J", "\u202eabc", "\u2028", "é№漢", "x" * 3000, "1" * 5000, [], {}, [[]], [0], [0, 0], [1, 2, 3, 4], ["a"],
    {"a": 1}, {"": 0}, [None], [True, False], "1 mm", "1e300 mm", "-5 mm", "0 mm", "99999999 m", "5 parsec", "1 s",
    "1e9 s", "0 s", "1 mm/min", "0.0001 mm/min", "1e12 m/min", "hard", "soft", "off", "auto", "none", "free", "ask",
    "../x.yaml", "/dev/null", "nowhere.yaml", ".", "*", "P*", "(", "(a+)+$", "[", "A", "A.outer", "B.outer", "cw",
    "2..6", "< 5", ">= nan", "1 × thickness", "1e9 × thickness", [-1e9, 1e9], [1, -1], [[0, 0], [1, 0]],
    {"1 mm": "1 mm"}, {"1 mm": "1 mm", "2 mm": "-1 mm"}, {"0 mm": 5}, [[0, 0, 1e9], [1, 1, -1e9]], [[0, 0]] * 3,
)  # fmt: skip
"""What takes the place of a value: other types, numbers at the ends, texts that mean something somewhere."""
Path = tuple[str | int, ...]
GENTLE = 0.2
"""Share of damages after which a value is still of its kind: they go deeper than what is refused at once."""


def damaged_tree(tree: Any, rnd: Random, words: Sequence[str] = ()) -> Any:
    """The tree with one to three small damages; `words` are keys and values of the format."""
    tree = copy.deepcopy(tree)
    if rnd.random() < GENTLE:
        return _gently(tree, rnd)
    for _ in range(rnd.choice((1, 1, 1, 1, 2, 3))):
        tree = _damaged(tree, rnd, words)
    return tree


def _damaged(tree: Any, rnd: Random, words: Sequence[str]) -> Any:
    paths = list(_paths(tree))
    if not paths:
        return copy.deepcopy(rnd.choice(VALUES))
    path = rnd.choice(paths)
    parent, key = _at(tree, path[:-1]), path[-1]
    match rnd.randrange(10):
        case 0:
            del parent[key]
        case 1 if isinstance(parent, dict):
            parent[rnd.choice([*words, *map(str, parent), "", "x", "\0", 5, None])] = parent.pop(key)
        case 1 | 2:
            parent[key] = copy.deepcopy(_at(tree, rnd.choice(paths)))
        case 3:
            parent[key] = rnd.choice(([parent[key]], {"a": parent[key]}, str(parent[key]), [parent[key]] * 2))
        case 4:
            for _ in range(rnd.choice((1, 5, 30, 200))):
                parent[key] = rnd.choice(([parent[key]], {"a": parent[key]}))
        case 5 if isinstance(parent, list):
            parent[key:key] = [copy.deepcopy(parent[key])] * rnd.choice((1, 2, 30))
        case 5 if words:
            parent[rnd.choice(words)] = copy.deepcopy(rnd.choice(VALUES))
        case 6 if words:
            parent[key] = rnd.choice(words)
        case 7 if isinstance(parent[key], int | float):
            parent[key] = _other_number(parent[key], rnd)
        case _:
            parent[key] = copy.deepcopy(rnd.choice(VALUES))
    return tree


def _gently(tree: Any, rnd: Random) -> Any:
    """A number a little larger or smaller, two values of a type swapped, or an entry of a list once more elsewhere."""
    paths = list(_paths(tree))
    numbers = [path for path in paths if type(_at(tree, path)) in (int, float)]
    lists = [path for path in paths if isinstance(_at(tree, path), list) and _at(tree, path)]
    match rnd.randrange(3):
        case 0 if numbers:
            path = rnd.choice(numbers)
            value = _at(tree, path)
            _at(tree, path[:-1])[path[-1]] = type(value)(value * rnd.choice((0.5, 0.9, 0.999, 1.001, 1.1, 2)))
        case 1 if lists:
            entries = _at(tree, rnd.choice(lists))
            entries.insert(rnd.randrange(len(entries) + 1), copy.deepcopy(rnd.choice(entries)))
        case _ if paths:
            path = rnd.choice(paths)
            like = [p for p in paths if type(_at(tree, p)) is type(_at(tree, path)) and p[: len(path)] != path]
            other = rnd.choice([p for p in like if path[: len(p)] != p] or [path])
            one, two = _at(tree, path), _at(tree, other)
            _at(tree, path[:-1])[path[-1]], _at(tree, other[:-1])[other[-1]] = two, one
    return tree


def _other_number(value: float, rnd: Random) -> Any:
    factor = rnd.choice((-1, 0, 2, 10, 1000, 1e-3, 1e6, 1e12, 1.001))
    try:
        return type(value)(value * factor) if not isinstance(value, bool) else int(value)
    except (OverflowError, ValueError):
        return 0


def _paths(tree: Any, path: Path = ()) -> Iterator[Path]:
    if path:
        yield path
    if len(path) > 60:
        return
    if isinstance(tree, dict):
        for key, value in tree.items():
            yield from _paths(value, (*path, key))
    elif isinstance(tree, list):
        for k, value in enumerate(tree):
            yield from _paths(value, (*path, k))


def _at(tree: Any, path: Path) -> Any:
    for step in path:
        tree = tree[step]
    return tree


def as_json(tree: Any, rnd: Random) -> bytes:
    """The tree as JSON, sometimes with what JSON does not have (NaN), sometimes with a key given twice."""
    text = json.dumps(tree, ensure_ascii=rnd.random() < 0.5, indent=rnd.choice((None, None, 1)), default=str)
    if rnd.random() < 0.03 and "{" in text:
        at = rnd.choice([k for k, c in enumerate(text) if c == "{"]) + 1
        text = text[:at] + rnd.choice(('"id": 1, "id": 2, ', '"a": 1, ', '"format": 3,')) + text[at:]
    return text.encode("utf-8", "surrogatepass")


_DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


def as_yaml(tree: Any, rnd: Random) -> bytes:
    """The tree as YAML."""
    unicode, flow = rnd.random() < 0.5, rnd.choice((None, False, True))
    try:
        text = yaml.dump(
            tree, Dumper=_DUMPER, allow_unicode=unicode, default_flow_style=flow, sort_keys=False, width=120
        )
    except RecursionError:
        text = json.dumps(tree, default=str)
    return text.encode("utf-8", "surrogatepass")


YAML_WORDS = (
    b"&a ", b"*a", b"<<: *a\n", b"!!python/object:os.system ", b"!!binary ", b"!!float ", b"!!set ", b"!!int ",
    b"---\n", b"...\n", b"? ", b": ", b"- ", b"| \n", b"> \n", b"~", b"yes", b"no", b"on", b"off", b"null",
    b"2001-01-01",
    b"%YAML 9.9\n---\n", b"%TAG ! x\n", b"[", b"]", b"{", b"}", b"&a [*a, *a]", b"!x ", b"# \n", b"0o17", b"1:30:00",
    b"\n\n", b"@", b"`", b"'", b'"', b"!<tag:x> ", b"&b {<<: [*b]}", b"=", b"!!timestamp ", b"!!null ",
)  # fmt: skip
