"""Each shipped rule's statements through its MiniZinc file against its Python, counted and compared.

`python -m kerfwise.benchmarks.flattened [NEST ...]` prints a table for each nest, the path of a file or the number of
contours of a made plate: how many statements either text makes, how many differ, and seconds. Two statements are the
same where they say the same of every order and pick. MiniZinc has at most 120 s for a rule.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any, assert_never

from kerfwise import read_nest
from kerfwise.benchmarks.plates import made_plate
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of
from kerfwise.rules.expression.node import Gate, Lit, Node, any_of, gate, holds_under, literals, order
from kerfwise.rules.flat import flatten
from kerfwise.rules.flat.model_file import read_model_file
from kerfwise.rules.flat.model_rule import ModelRule, facts_data
from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import (
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Forbid,
    IdleTravel,
    Lag,
    Link,
    Move,
    NoGood,
    Pick,
    Precede,
    Statement,
)

FOLDER = Path(__file__).parents[1] / "examples" / "nests"
NESTS = (*(str(FOLDER / name) for name in ("e1x_6.dxf", "s8877.dxf", "plate40.json")), "115", "308")
MOVES = "no-tip-travel"
"""The rule whose file speaks of moves of the torch, for which only the engine minizinc has words."""
MOST_TRIED = 10
"""Of statements with more literals the sums themselves are compared."""


def said(statement: Statement) -> object:
    """What a statement says, the same for two that say the same."""
    match statement:
        case Precede(before, after):
            node = order(before, after)
        case Forbid(candidate):
            node = Lit(Pick(candidate), False)
        case AtLeast():
            weights: dict[Node, int] = {}
            for lit, weight in zip(statement.literals, statement.weights, strict=True):
                term = order(lit.i, lit.j) if isinstance(lit, Before) else Lit(lit)  # type: ignore[arg-type]
                weights[term] = weights.get(term, 0) + weight
            node = gate(weights, statement.bound)
            if statement.when is not None:
                node = any_of([Lit(Pick(statement.when), False), node])
        case Contiguous(contours):
            return ("run", frozenset(contours), statement.weight)
        case Lag(first, second):
            return ("lag", min(first, second), max(first, second), statement.cuts, statement.seconds, statement.weight)
        case Move(leave, reach):
            by = statement.leaving, statement.reaching
            return ("move", frozenset(leave), frozenset(reach), *by, statement.weight)
        case NoGood() | Crossing() | IdleTravel() | Link():
            return statement
        case _:
            assert_never(statement)
    return (_truth(node), statement.weight)


def counted(statements: Iterable[Statement]) -> Counter[object]:
    """What statements say, counted; those that hold in every plan say nothing."""
    return Counter(told for told in map(said, statements) if told != _NOTHING)


def _truth(node: Node) -> object:
    atoms = sorted({lit.atom for lit in literals(node)}, key=repr)
    if len(atoms) > MOST_TRIED:
        assert isinstance(node, Gate)
        return (frozenset(node.terms), node.bound)
    tried = product((False, True), repeat=len(atoms))
    table = (holds_under(node, {Lit(a): v for a, v in zip(atoms, values, strict=True)}) for values in tried)
    return (tuple(map(repr, atoms)), tuple(bool(held) for held in table))


_NOTHING = (_truth(True), None)


def nest_of(name: str) -> Nest:
    """The nest in a file, or the made plate of so many contours."""
    if not name.isdecimal():
        return read_nest(name)
    return replace(made_plate(int(name), seed=1), file=f"made plate {name}")


def rows(name: str) -> Iterable[str]:
    """The table of a nest, line by line."""
    nest, profile = nest_of(name), load_profile()
    facts = facts_of(nest, profile)
    began_s = spent_s()
    facts_data(facts)
    yield f"## {nest.file}: {facts.n} contours, {len(facts.candidates)} ways to cut\n"
    yield f"The facts as data: {spent_s() - began_s:.2f} s.\n"
    yield "| rule | Python | MiniZinc | different | Python, s | MiniZinc, s | kept, s |"
    yield "|---|--:|--:|--:|--:|--:|--:|"
    for rule, setting in profile.settings().items():
        if not rule_file(rule).exists():
            yield f"| `{rule}` | no file | | | | | |"
            continue
        if rule == MOVES:
            yield f"| `{rule}` | no words | | | | | |"
            continue
        model = ModelRule(read_model_file(rule_file(rule)), "", setting.strength)
        try:
            flat, flat_s = timed(model, facts, setting.options)
        except InputError as error:  # such as one that takes longer than it may
            yield f"| `{rule}` | | {error.message.splitlines()[0][:70]} | | | | |"
            continue
        own, own_s = timed(RULES[rule], facts, setting.options)
        flatten._kept.clear()
        _, kept_s = timed(model, facts, setting.options)
        one, other = counted(own), counted(flat)
        different = sum(((one - other) + (other - one)).values())
        yield f"| `{rule}` | {len(own)} | {len(flat)} | {different} | {own_s:.2f} | {flat_s:.2f} | {kept_s:.2f} |"


def timed(rule: Rule[Any], facts: Facts, options: Any) -> tuple[list[Statement], float]:
    """What a rule states, and the seconds that processors took for it, those of MiniZinc too."""
    began_s = spent_s()
    stated = list(rule.statements(facts, options))
    return stated, spent_s() - began_s


def spent_s() -> float:
    """Seconds of processors that this process and those it has started have taken."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def main(arguments: Sequence[str]) -> None:
    """Print the tables; nothing that an earlier run has kept is used."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = os.environ["LOCALAPPDATA"] = folder
        for name in arguments or NESTS:
            for row in rows(name):
                print(row, flush=True)
            print(flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
