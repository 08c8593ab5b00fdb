"""MiniZinc's compiler at work: a model with its data becomes FlatZinc, read as variables, arrays and constraints."""

from __future__ import annotations

import json
import re
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from typing import TypeAlias

from kerfwise.encoder.errors import InputError, ToolFault
from kerfwise.encoder.escape import escape_text
from kerfwise.rules.minizinc.installation import (
    HOW_TO_INSTALL,
    MOST_GB,
    Ran,
    expect_solving,
    expect_usable,
    found_program,
    run,
    unusable,
)

HERE = Path(__file__).parent
WORDS = HERE / "words.mzn"
JUDGED = HERE / "judged.mzn"
JUDGED_ORDERS = HERE / "judged_orders.mzn"
GECODE = "gecode"
OWN_MODEL = "kerfwise model.mzn"
"""What kerfwise asks MiniZinc to compile: no rule's file may have such a name."""
LIMIT_S = 120.0
"""What a rule takes to be compiled for a nest of 300 contours is a second or two; a limit in seconds replaces it."""
LEAST_S = 0.1
_ENDS_S: ContextVar[float] = ContextVar("when compiling ends, by time.monotonic", default=inf)
SAID = "%kerfwise "
"""What begins a line that a model prints for kerfwise."""
_PLACE = re.compile(r"^(?:\(included from file '.*|(?P<file>.+?):(?P<line>\d+)\.(?P<column>\d+)(?:-[\d.]+)?:?)$")
_LIBRARY = HERE / "solver"


@dataclass(frozen=True, slots=True)
class Compiled:
    """The flat model, and what it printed for kerfwise: a name and a value in JSON each."""

    flat: str
    printed: tuple[tuple[str, str], ...]


@contextmanager
def compiled_within(seconds: float) -> Iterator[None]:
    """So long at the most all rules together may take that are compiled meanwhile."""
    before = _ENDS_S.set(time.monotonic() + seconds)
    try:
        yield
    finally:
        _ENDS_S.reset(before)


def expect_in_time(about: Path | None) -> None:
    """An error about a rule that is read, once what all rules may take together is over."""
    if time.monotonic() > _ENDS_S.get():
        raise InputError(
            "what MiniZinc has made of this rule is being read, and the time limit leaves no more for it: give it more "
            "time, or state the rule over fewer contours",
            file=about,
        )


def minizinc_program() -> str:
    """The MiniZinc that is installed, tried before anything relies on it.

    Raises InputError if there is none, or it is too old or broken; the message says how to install it.
    """
    program = found_program()
    if program is None:
        raise ToolFault(f"rules in model files need MiniZinc: {HOW_TO_INSTALL}")
    expect_usable(program)
    return program


def printing(name: str, expression: str) -> str:
    """MiniZinc text that prints the value of an expression while the model is compiled."""
    return f'constraint trace("{SAID}{name} " ++ showJSON({expression}) ++ "\\n");\n'


def solve_all(text: str, about: Path) -> str:
    """What MiniZinc prints for every solution of MiniZinc text that includes the rule file `about`, by Gecode.

    Raises InputError as `compile_model`; also if there is no Gecode.
    """
    program = minizinc_program()
    expect_solving(program, GECODE)
    with tempfile.TemporaryDirectory(prefix="kerfwise-", ignore_cleanup_errors=True) as folder:
        model = Path(folder, OWN_MODEL)
        model.write_text(text, encoding="utf-8", newline="\n")
        ran = run(program, ("--solver", GECODE, "--all-solutions", str(model)), LIMIT_S)
        _expect_done(ran, about, program)
        return ran.said


def compile_model(text: str, about: Path) -> Compiled:
    """Compile MiniZinc text that includes the rule file `about`.

    Raises InputError if MiniZinc cannot be used, or there is a mistake in the file (with its line), or it takes too
    long.
    """
    program = minizinc_program()
    with tempfile.TemporaryDirectory(prefix="kerfwise-", ignore_cleanup_errors=True) as folder:
        model, flat, solver = (Path(folder, name) for name in (OWN_MODEL, "rule.fzn", "kerfwise.msc"))
        model.write_text(text, encoding="utf-8", newline="\n")
        solver.write_text(json.dumps(_solver()), encoding="utf-8", newline="\n")
        words = ("-c", "--solver", str(solver), "--fzn", str(flat), "--no-output-ozn", str(model))
        ends_s, began_s = _ENDS_S.get(), time.monotonic()
        ran = run(program, words, LIMIT_S if ends_s == inf else max(ends_s - began_s, LEAST_S))
        if ran.code is None and not ran.endless and ends_s < inf:
            took_s = time.monotonic() - began_s
            raise InputError(
                f"MiniZinc compiles this rule for the nest and is not done after {took_s:.1f} s, which is all that the "
                "time limit leaves it: give it more time, or state the rule over fewer contours",
                file=about,
            )
        _expect_done(ran, about, program)
        if not flat.exists():
            raise _mistake(ran.complaint or ran.said, about, program)
        printed = [line.removeprefix(SAID).partition(" ") for line in ran.complaint.splitlines() if SAID in line[:20]]
        return Compiled(flat.read_text(encoding="utf-8"), tuple((name, value) for name, _, value in printed))


def _expect_done(ran: Ran, about: Path, program: str) -> None:
    """An error where MiniZinc did not come to its end."""
    if ran.code is None:
        why = "prints without end" if ran.endless else f"is not done after {LIMIT_S:g} s"
        raise InputError(f"MiniZinc compiles this rule for the nest and {why}", file=about)
    if ran.code != 0 and any(word in ran.complaint for word in ("out of memory", "bad_alloc")):
        why = f"needs more than {MOST_GB:g} GB for it: state it over fewer contours, or facts by contour"
        raise InputError(f"MiniZinc compiles this rule for the nest and {why}", file=about)
    if ran.code != 0:
        raise _mistake(ran.complaint or ran.said, about, program)


def _solver() -> dict[str, object]:
    """A solver that is never run: MiniZinc takes its library, which leaves conditions in one piece."""
    return {
        "id": "org.kerfwise.rules",
        "name": "kerfwise rules",
        "version": "1.0.0",
        "mznlib": str(_LIBRARY),
        "executable": sys.executable,
        "supportsMzn": False,
        "supportsFzn": True,
    }


def _mistake(text: str, about: Path, program: str) -> InputError:
    """The error that MiniZinc tells, at the first place in a file that kerfwise did not write."""
    lines = text.splitlines()
    told = next((line.removeprefix("Error:").strip() for line in lines if line.startswith("Error:")), "")
    if not told:
        return unusable(program, f"it ends with {escape_text(text[:100])!r} and no error")
    for words in ("type error:", "symbol error:", "(did you forget to specify a data file?)"):
        told = told.replace(words, "").strip()
    message = f"MiniZinc: {told}{_hint(told, about)}"
    found = (place for line in lines if (place := _PLACE.match(line.strip())) is not None and place["file"])
    places = [place for place in found if not _own(Path(place["file"]))]
    beside = about.resolve().parent
    for place in sorted(places, key=lambda place: not Path(place["file"]).resolve().is_relative_to(beside)):
        file = about if Path(place["file"]).resolve() == about.resolve() else Path(place["file"])
        return InputError(message, file=file, line=int(place["line"]), column=int(place["column"]))
    return InputError(message, file=about)


def _own(file: Path) -> bool:
    """Whether kerfwise, or MiniZinc itself, wrote the file."""
    return not file.exists() or file.name == OWN_MODEL or file.resolve().is_relative_to(HERE)


_ENGINES_OWN = ("stop", "STOP", "leg", "cut_at", "travel", "idle_travel", "begin_ms", "end_ms", "cut_ms", "move_ms")


def _hint(text: str, about: Path) -> str:
    """What to do where a file uses what only the MiniZinc engine has."""
    name = re.search(r"[`'](\w+)'", text)
    if name is not None and name[1] in _ENGINES_OWN:
        return (
            f" for engines other than minizinc: {name[1]} is a word of the sequence that rules do not have; write the "
            "rule with before, picked, directly_before, cuts_between, position, pick or pause_ms"
        )
    if "must be defined" in text:
        own = f"{about.stem.replace('-', '_')}_most"
        return f"; a parameter is called as the file and then by its own name, as in {own}, with a default beside it"
    return ""


# FlatZinc text as data: variables, arrays and constraints, nothing of what they mean.

Value: TypeAlias = "bool | int | str | range | frozenset[int] | float | list[Value]"
"""A constant, the name of a variable (a text), a set, or a list of these."""

_TOKEN = re.compile(
    r'\s*("(?:[^"\\]|\\.)*"|-?\d+\.\.-?\d+|-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?|[A-Za-z_]\w*|[\[\](){},=:;])'
)
_VARIABLE = re.compile(r"var ([^:]+): *(\w+)\s*((?:::[^=;]*)?)(?:= *([^;]+))?;$")
_ARRAY = re.compile(r"array ?\[[^\]]*\] of (?:var )?[^:]+: *(\w+)[^=]*= *(\[.*\]);?$")
_CONSTANT = re.compile(r"(?:bool|int|float|set of int): *(\w+)[^=]*= *([^;]+);?$")
_CONSTRAINT = re.compile(r"constraint (\w+)\(([^()]*)\)((?: *::.*)?);$")
_DEFINES = re.compile(r"defines_var\((\w+)\)")


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable: a bool, or an int with its values; `value` is what it is declared to be, None where nothing is."""

    is_bool: bool
    values: range | frozenset[int] | None
    value: Value | None


@dataclass(frozen=True, slots=True)
class Constraint:
    """A constraint by name; `defines` is the variable that it defines, "" where it defines none."""

    name: str
    args: tuple[Value, ...]
    defines: str = ""


@dataclass(frozen=True, slots=True)
class FlatZinc:
    """A flat model."""

    variables: dict[str, Variable] = field(default_factory=dict)
    arrays: dict[str, list[Value]] = field(default_factory=dict)
    constraints: list[Constraint] = field(default_factory=list)


def read_flatzinc(text: str, about: Path | None = None) -> FlatZinc:
    """Read a flat model; names of arrays and constants are replaced by what they stand for.

    Raises ValueError for a line that is no FlatZinc; MiniZinc writes none. InputError about the rule file, as
    `expect_in_time`.

    Examples
    --------
    >>> flat = read_flatzinc("var 1..3: x;\\narray [1..2] of int: a = [4,5];\\nconstraint int_lin_le(a,[x,x],9);")
    >>> flat.variables["x"].values, flat.constraints[0].args
    (range(1, 4), ([4, 5], ['x', 'x'], 9))
    """
    flat = FlatZinc()
    known: dict[str, Value] = {}
    for line in text.splitlines():
        line = line.strip()
        expect_in_time(about)
        if not line or line.startswith(("predicate", "solve", "%")):
            continue
        if (found := _CONSTRAINT.match(line)) is not None:
            defines = _DEFINES.search(found[3])
            args = tuple(_resolved(value, known) for value in _values(f"[{found[2]}]"))
            flat.constraints.append(Constraint(found[1], args, defines[1] if defines else ""))
        elif (found := _ARRAY.match(line)) is not None:
            values = [_resolved(value, known) for value in _values(found[2])]
            known[found[1]] = flat.arrays[found[1]] = values
        elif (found := _VARIABLE.match(line)) is not None:
            value = None if found[4] is None else _resolved(_values(f"[{found[4]}]")[0], known)
            kind = found[1].strip()
            if kind.startswith("float") or _FRACTION.match(kind):
                raise FractionModel
            values_of = None if kind in ("bool", "int") else _domain(kind)
            flat.variables[found[2]] = Variable(kind == "bool", values_of, value)
        elif (found := _CONSTANT.match(line)) is not None:
            known[found[1]] = _resolved(_values(f"[{found[2]}]")[0], known)
        else:
            raise ValueError(f"no line of FlatZinc: {line[:80]}")
    return flat


class FractionModel(ValueError):
    """A model that counts in fractions."""

    def __init__(self) -> None:
        super().__init__(
            "it counts in fractions, and rules count in whole numbers: multiply both sides until none is left, as in "
            "`5 * position[2] <= 17` for `0.5 * position[2] <= 1.7`, and declare `int`, not `float`"
        )


_FRACTION = re.compile(r"-?\d+\.\d+(?:[eE][-+]?\d+)?\.\.|\{?-?\d+\.\d")


def _domain(text: str) -> range | frozenset[int]:
    value = _values(f"[{text}]")[0]
    if not isinstance(value, range | frozenset):
        raise ValueError(f"no domain: {text}")
    return value


def _resolved(value: Value, known: dict[str, Value]) -> Value:
    if isinstance(value, list):
        return [known.get(v, v) if isinstance(v, str) else v for v in value]
    return known.get(value, value) if isinstance(value, str) else value


def _values(text: str) -> list[Value]:
    """The values of a list, written with its brackets."""
    tokens = _TOKEN.findall(text)
    values, _ = _list(tokens, 1, "]")
    return values


def _list(tokens: list[str], at: int, end: str) -> tuple[list[Value], int]:
    values: list[Value] = []
    while tokens[at] != end:
        token = tokens[at]
        at += 1
        if token == "[":
            inner, at = _list(tokens, at, "]")
            values.append(inner)
        elif token == "{":
            members, at = _list(tokens, at, "}")
            values.append(frozenset(m for m in members if isinstance(m, int)))
        elif token != ",":
            values.append(_atom(token))
    return values, at + 1


def _atom(token: str) -> Value:
    if token in ("true", "false"):
        return token == "true"
    if token[0] == '"':
        return token
    if ".." in token:
        low, _, high = token.partition("..")
        return range(int(low), int(high) + 1)
    if token[0].isdigit() or token[0] == "-":
        return float(token) if re.search(r"[.eE]", token) else int(token)
    return token
