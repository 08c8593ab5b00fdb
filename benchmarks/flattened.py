"""Each shipped rule's statements through its MiniZinc file against its Python, counted and compared.

`python -m kerfwise.benchmarks.flattened [NEST ...]` prints a table for each nest: how many statements either text
makes, how many differ, and seconds. Two statements are the same where they say the same of every order and pick.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import product
from pathlib import Path
from typing import assert_never

from kerfwise import read_nest
from kerfwise.encoder.errors import InputError
from kerfwise.jobs.ask import facts_of
from kerfwise.rules.flat.model_file import read_model_file
from kerfwise.rules.flat.model_rule import ModelRule, facts_data
from kerfwise.rules.flat.nodes import Gate, Lit, Node, any_of, gate, holds_under, literals, order
from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.profile.profile import load_profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import (
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Forbid,
    IdleTravel,
    Lag,
    NoGood,
    Pick,
    Precede,
    Statement,
)

NESTS = ("e1x_6.dxf", "s8877.dxf", "plate40.json")
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
        case NoGood() | Crossing() | IdleTravel():
            return statement
        case _:
            assert_never(statement)
    return (_truth(node), statement.weight)


def _truth(node: Node) -> object:
    atoms = sorted({lit.atom for lit in literals(node)}, key=repr)
    if len(atoms) > MOST_TRIED:
        assert isinstance(node, Gate)
        return (frozenset(node.terms), node.bound)
    tried = product((False, True), repeat=len(atoms))
    table = (holds_under(node, {Lit(a): v for a, v in zip(atoms, values, strict=True)}) for values in tried)
    return (tuple(map(repr, atoms)), tuple(bool(held) for held in table))


def rows(path: Path) -> Iterable[str]:
    profile = load_profile()
    facts = facts_of(read_nest(path), profile)
    facts_data(facts)
    yield f"## {path.name}: {facts.n} contours, {len(facts.candidates)} ways to cut\n"
    yield "| rule | Python | MiniZinc | different | Python, s | MiniZinc, s |"
    yield "|---|--:|--:|--:|--:|--:|"
    for name, setting in profile.settings().items():
        if not rule_file(name).exists():
            yield f"| `{name}` | no file | | | | |"
            continue
        began_s = time.perf_counter()
        own = list(RULES[name].statements(facts, setting.options))
        own_s, began_s = time.perf_counter() - began_s, time.perf_counter()
        try:
            flat = list(
                ModelRule(read_model_file(rule_file(name)), "", setting.strength).statements(facts, setting.options)
            )
        except InputError as error:
            yield f"| `{name}` | {len(own)} | {error.message.splitlines()[0][:70]} | | {own_s:.2f} | |"
            continue
        flat_s = time.perf_counter() - began_s
        one, other = Counter(map(said, own)), Counter(map(said, flat))
        different = sum(((one - other) + (other - one)).values())
        yield f"| `{name}` | {len(own)} | {len(flat)} | {different} | {own_s:.2f} | {flat_s:.2f} |"


def main(arguments: Sequence[str]) -> None:
    folder = Path(__file__).parents[1] / "examples" / "nests"
    for name in arguments or [str(folder / nest) for nest in NESTS]:
        print("\n".join(rows(Path(name))), end="\n\n", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
