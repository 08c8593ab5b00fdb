"""A rule's model file flattened against facts, kept between runs by content: the same rule on the same nest once."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import sys
import zlib
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import DamagedFile, read_sealed, write_sealed
from kerfwise.encoder.minizinc_data import include
from kerfwise.rules.expression.node import Node
from kerfwise.rules.expression.numbers import TooMuch
from kerfwise.rules.minizinc.installation import version_of

from .compiler import (
    HERE,
    JUDGED,
    JUDGED_ORDERS,
    WORDS,
    Compiled,
    FractionModel,
    compile_model,
    minizinc_program,
    printing,
    read_flatzinc,
    solve_all,
)
from .flatzinc_to_expr import SUMS, Meaning, UnsupportedModel, Words
from .model_file import ModelFile, element_contours, files_read, whole_text

MOST_KEPT = 64
"""Flat forms that are kept while kerfwise runs: a plan asks for each rule's several times."""
KEPT = "flat_kept_"
"""What begins the names of constraints that say nothing, and have MiniZinc list an array."""
ABOUT = "about"
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
    """What a file says of a nest: a node for each element of its array, its sentences, and further conditions.

    `about` has for each element the contours, from 0, that its comprehension runs over there; empty where it is none.
    """

    elements: tuple[Node, ...]
    says: tuple[str, ...]
    further: tuple[Node, ...]
    others: tuple[tuple[Node, ...], ...] = ()
    about: tuple[tuple[int, ...], ...] = ()

    def about_of(self, k: int) -> tuple[int, ...]:
        """The contours that element k is about, each once."""
        return tuple(dict.fromkeys(self.about[k])) if k < len(self.about) else ()


_kept: OrderedDict[str, Flattened] = OrderedDict()


def flatten(file: ModelFile, data: str, n: int, contour_of: Sequence[int], others: tuple[str, ...] = ()) -> Flattened:
    """Compile the file with data (facts, and the rule's own) of n contours and read what is left.

    `contour_of` maps each candidate to its contour, from 0; `others` are further arrays of the file that are wanted.
    Raises InputError if MiniZinc is missing, or the file has a mistake or says something that has no meaning for a
    rule.
    """
    text = _model(file, data, others)
    key = sha256("\0".join([text, *files_read(file).values()]).encode()).hexdigest()
    if key in _kept:
        _kept.move_to_end(key)
        return _kept[key]
    flatzinc = compiled(file, text)
    try:
        flat = read_flatzinc(flatzinc.flat, file.path)
        kept = [c for c in flat.constraints if c.name.startswith(KEPT)]
        flat.arrays.clear()
        flat.arrays.update({c.name.removeprefix(KEPT): c.args[0] for c in kept if isinstance(c.args[0], list)})
        flat.constraints[:] = [c for c in flat.constraints if not c.name.startswith(KEPT)]
        meaning = Meaning(flat, Words(n, contour_of), file.path)
        elements = tuple(meaning.elements(file.array))
        further = tuple(meaning.further())
        beside = tuple(tuple(meaning.elements(name)) for name in others)
    except (UnsupportedModel, TooMuch, FractionModel) as error:
        raise InputError(f"rule {file.name}: {error}", file=file.path, line=file.line) from None
    except RecursionError:
        raise InputError(f"rule {file.name}: its conditions stand too deep in one another", file=file.path) from None
    says = _says(flatzinc)
    if says and len(says) != len(elements):
        raise InputError(
            f"rule {file.name}: {file.stem}_says has {len(says)} sentences, {file.array} {len(elements)} elements",
            file=file.path,
            line=file.line,
        )
    flattened = Flattened(elements, tuple(says), further, beside, _about(flatzinc, len(elements)))
    _kept[key] = flattened
    if len(_kept) > MOST_KEPT:
        _kept.popitem(last=False)
    return flattened


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
    flatzinc = compiled(file, _model(file, data, (), judged=True))
    flat = read_flatzinc(flatzinc.flat, file.path)
    holds: list[bool] = []
    possible = True
    for constraint in flat.constraints:
        if not constraint.name.startswith(KEPT):
            possible = False
        elif constraint.name == f"{KEPT}{file.array}" and isinstance(constraint.args[0], list):
            holds = [value is True for value in constraint.args[0]]
    return JudgedOrder(holds, _says(flatzinc), possible)


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


def _about(flat: Compiled, count: int) -> tuple[tuple[int, ...], ...]:
    """The contours of each element, from 0, where the file's array is a comprehension over contours."""
    columns = [json.loads(value) for name, value in flat.printed if name == ABOUT]
    if not columns or any(len(column) != count for column in columns):
        return ()
    return tuple(tuple(number - 1 for number in row) for row in zip(*columns, strict=True))


def _says(flat: Compiled) -> list[str]:
    """The file's sentences; none where it has none."""
    return next((json.loads(value) for name, value in flat.printed if name == "says"), [])


def _model(file: ModelFile, data: str, others: tuple[str, ...], judged: bool = False) -> str:
    """The model: the words, the file, its data, and what is to be left of it."""
    named = set(re.findall(r"[A-Za-z_]\w*", whole_text(file)))
    kept = [name for name, words in _ARRAYS.items() if not judged and not named.isdisjoint(words)]
    lines = [include(JUDGED if judged else WORDS), include(file.path.resolve())]
    for name in (*kept, *([file.array] if file.array else []), *others):
        kind = "int" if name in SUMS else "bool"
        lines.append(f"predicate {KEPT}{name}(array[int] of var {kind}: kept);")
        lines.append(f"constraint {KEPT}{name}(array1d({name}));")
    for values in () if judged else element_contours(file).values():
        lines.append(printing(ABOUT, f"array1d({values})"))
    if file.says:
        lines.append(printing("says", f"array1d({file.stem}_says)"))
    return "\n".join([*lines, "solve satisfy;", "output [];", data])


# What MiniZinc has compiled, kept between runs by content: the same rule on the same nest is compiled once.
#
# It is kept in the folder `kerfwise/rules` of the user's cache. What cannot be read or written there is done without.

MOST_FILES = 2000
MOST_BYTES = 200_000_000
"""What is kept at the most; the oldest goes first."""


def compiled(file: ModelFile, text: str) -> Compiled:
    """MiniZinc text that includes the rule file, compiled, or what was kept of it.

    Raises InputError as `compile_model`; mistakes are not kept.
    """
    maker, folder = _maker(minizinc_program()), cache_folder()
    if folder is None:
        return compile_model(text, file.path)
    key = _key(file, text)
    path = folder / f"{key}.flat"
    if (known := _read(path, maker)) is not None:
        return known
    result = compile_model(text, file.path)
    if _key(file, text) != key:  # somebody has just changed a file
        return result
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        write_sealed(path, maker, zlib.compress(json.dumps([result.flat, result.printed]).encode(), 3))
        _leave_room(folder)
    return result


def cache_folder() -> Path | None:
    """Where compiled rules are kept: below `$XDG_CACHE_HOME`, else `~/.cache`; on Windows below `%LOCALAPPDATA%`.

    None where there is no such place.
    """
    home = os.environ.get("LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME")
    try:
        return (Path(home) if home else Path.home() / ".cache") / "kerfwise" / "rules"
    except RuntimeError:
        return None


def _key(file: ModelFile, text: str) -> str:
    """The digest of a model and of the files that it reads, wherever these lie."""
    for place in (file.path.resolve(), HERE):
        text = text.replace(place.as_posix(), "")
    content = "\0".join([text, *files_read(file).values()])
    return hashlib.sha256(content.encode("utf-8", "surrogatepass")).hexdigest()


@cache
def _maker(program: str) -> bytes:
    """The digest of what compiles: MiniZinc's version, and kerfwise's own model files."""
    own = [path.read_text(encoding="utf-8") for path in sorted([*HERE.rglob("*.mzn"), HERE.parent / _FACTS])]
    return hashlib.sha256("\0".join([version_of(program), *own]).encode()).digest()


_FACTS = Path("minizinc", "facts.mzn")


def _read(path: Path, maker: bytes) -> Compiled | None:
    with contextlib.suppress(DamagedFile, ValueError, zlib.error, OSError):
        content = read_sealed(path, maker)
        if content is not None:
            flat, printed = json.loads(zlib.decompress(content))
            os.utime(path)
            return Compiled(flat, tuple((name, value) for name, value in printed))
    return None


def _leave_room(folder: Path) -> None:
    """Remove what was not used for longest, where there is too much."""
    found = []
    for path in folder.glob("*.flat"):
        with contextlib.suppress(OSError):
            found.append((path.stat().st_mtime, path.stat().st_size, path))
    size, count = sum(size for _, size, _ in found), len(found)
    for _, own, path in sorted(found):
        if count <= MOST_FILES and size <= MOST_BYTES:
            return
        with contextlib.suppress(OSError):
            path.unlink()
        size, count = size - own, count - 1
