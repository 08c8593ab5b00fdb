"""A rule's model file flattened against facts: what it states of one nest."""

from __future__ import annotations

import json
import re
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from kerfwise.encoder.errors import InputError

from .compiler import JUDGED, JUDGED_ORDERS, WORDS, Compiled, printing, solve_all
from .flatzinc import read_flatzinc
from .kept_compiled import compiled
from .meaning import SUMS, Meaning, NotUnderstood, Words
from .model_file import ModelFile, files_read, whole_text
from .nodes import Node
from .numbers import TooMuch

MOST_KEPT = 64
"""Flat forms that are kept while kerfwise runs: a plan asks for each rule's several times."""
KEPT = "flat_kept_"
"""What begins the names of constraints that say nothing, and have MiniZinc list an array."""
_ARRAYS = {
    "flat_before": ("before",),
    "flat_next": ("directly_before",),
    "flat_picked": ("picked",),
    "position": ("position",),
    "pick": ("pick",),
    "flat_between": ("cuts_between",),
    "flat_pause": ("pause_ms",),
}
"""Array of `words.mzn` → the words of rules that need it."""


@dataclass(frozen=True, slots=True)
class Flattened:
    """What a file says of a nest: a node for each element of its array, its sentences, and further conditions."""

    elements: tuple[Node, ...]
    says: tuple[str, ...]
    further: tuple[Node, ...]
    others: tuple[tuple[Node, ...], ...] = ()


_kept: OrderedDict[str, Flattened] = OrderedDict()


def flatten(file: ModelFile, data: str, n: int, contour_of: Sequence[int], others: tuple[str, ...] = ()) -> Flattened:
    """Compile the file with data (facts, and the rule's own) of n contours and read what is left.

    `contour_of` maps each candidate to its contour, from 0; `others` are further arrays of the file that are wanted.

    Raises
    ------
    InputError
        If MiniZinc is missing, or the file has a mistake or says something that has no meaning for a rule.
    """
    text = _model(file, data, others)
    key = sha256("\0".join([text, *files_read(file).values()]).encode()).hexdigest()
    if key in _kept:
        _kept.move_to_end(key)
        return _kept[key]
    told = compiled(file, text)
    try:
        flat = read_flatzinc(told.flat)
        kept = [c for c in flat.constraints if c.name.startswith(KEPT)]
        flat.arrays.clear()
        flat.arrays.update({c.name.removeprefix(KEPT): c.args[0] for c in kept if isinstance(c.args[0], list)})
        flat.constraints[:] = [c for c in flat.constraints if not c.name.startswith(KEPT)]
        meaning = Meaning(flat, Words(n, contour_of))
        elements = tuple(meaning.elements(file.array))
        further = tuple(meaning.further())
        beside = tuple(tuple(meaning.elements(name)) for name in others)
    except (NotUnderstood, TooMuch) as error:
        raise InputError(f"rule {file.name}: {error}", file=file.path, line=file.line) from None
    except RecursionError:
        raise InputError(f"rule {file.name}: its conditions stand too deep in one another", file=file.path) from None
    says = _says(told)
    if says and len(says) != len(elements):
        raise InputError(
            f"rule {file.name}: {file.stem}_says has {len(says)} sentences, {file.array} {len(elements)} elements",
            file=file.path,
            line=file.line,
        )
    made = Flattened(elements, tuple(says), further, beside)
    _kept[key] = made
    if len(_kept) > MOST_KEPT:
        _kept.popitem(last=False)
    return made


@dataclass(frozen=True, slots=True)
class JudgedOrder:
    """Which elements of a file's array hold of cuts that are made, its sentences, and whether its constraints do."""

    holds: Sequence[bool]
    says: Sequence[str]
    possible: bool


def judge_order(file: ModelFile, data: str) -> JudgedOrder:
    """The file evaluated by MiniZinc on an order.

    `data` are the facts that the check has measured, and when each contour is cut.
    """
    told = compiled(file, _model(file, data, (), judged=True))
    flat = read_flatzinc(told.flat)
    holds: list[bool] = []
    possible = True
    for constraint in flat.constraints:
        if not constraint.name.startswith(KEPT):
            possible = False
        elif constraint.name == f"{KEPT}{file.array}" and isinstance(constraint.args[0], list):
            holds = [value is True for value in constraint.args[0]]
    return JudgedOrder(holds, _says(told), possible)


def judge_orders(file: ModelFile, data: str, count: int) -> list[JudgedOrder]:
    """The file evaluated by MiniZinc on many orders of the same cuts, in one run of its solver.

    `data` are the facts that the check has measured, and when each contour is cut in each of `count` orders. Sentences
    are left out.
    """
    array = f"array1d({file.array})" if file.array else "[true]"
    lines = [include(JUDGED_ORDERS), include(file.path.resolve()), "solve satisfy;"]
    output = f'output ["\\(order) \\(fix({array}))\\n"];'
    judged = [JudgedOrder((), (), possible=False)] * count
    for line in solve_all("\n".join([*lines, output, data]), file.path).splitlines():
        order, _, holds = line.partition(" ")
        if order.isdecimal():
            judged[int(order) - 1] = JudgedOrder(json.loads(holds), (), possible=True)
    return judged


def _says(told: Compiled) -> list[str]:
    """The file's sentences; none where it has none."""
    return next((json.loads(value) for name, value in told.printed if name == "says"), [])


def _model(file: ModelFile, data: str, others: tuple[str, ...], judged: bool = False) -> str:
    """The model: the words, the file, its data, and what is to be left of it."""
    named = set(re.findall(r"[A-Za-z_]\w*", whole_text(file)))
    kept = [name for name, words in _ARRAYS.items() if not judged and not named.isdisjoint(words)]
    lines = [include(JUDGED if judged else WORDS), include(file.path.resolve())]
    for name in (*kept, *([file.array] if file.array else []), *others):
        kind = "int" if name in SUMS else "bool"
        lines.append(f"predicate {KEPT}{name}(array[int] of var {kind}: kept);")
        lines.append(f"constraint {KEPT}{name}(array1d({name}));")
    if file.says:
        lines.append(printing("says", f"array1d({file.stem}_says)"))
    return "\n".join([*lines, "solve satisfy;", "output [];", data])


def include(path: Path) -> str:
    """The line that includes a file."""
    return f"include {json.dumps(path.as_posix(), ensure_ascii=False)};"
