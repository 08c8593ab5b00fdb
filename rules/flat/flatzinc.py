"""FlatZinc text as data: variables, arrays and constraints, nothing of what they mean."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TypeAlias

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


def read_flatzinc(text: str) -> FlatZinc:
    """Read a flat model; names of arrays and constants are replaced by what they stand for.

    Raises
    ------
    ValueError
        For a line that is no FlatZinc; MiniZinc writes none.

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
            values_of = None if kind in ("bool", "int") or kind.startswith("float") else _domain(kind)
            flat.variables[found[2]] = Variable(kind == "bool", values_of, value)
        elif (found := _CONSTANT.match(line)) is not None:
            known[found[1]] = _resolved(_values(f"[{found[2]}]")[0], known)
        else:
            raise ValueError(f"no line of FlatZinc: {line[:80]}")
    return flat


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
