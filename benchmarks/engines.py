"""What every engine, local search and bound wins or proves that the others do not: each left out in turn.

Usage: python -m kerfwise.benchmarks.engines [FOLDER] [--work W] [--only PATTERN …] [--without NAME …]
       [--kept rows.json] > docs/engines.md

Made plates (examples/gen_sheet.py) under the default profile, with and without its zones, shipped nests, and routing
instances of FOLDER, each solved by the portfolio within so much work (deterministic seconds, so that other programs
change no figure), then once more without each member that had a part in it. Rows that the file `--kept` has already are
not made again.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from fnmatch import fnmatchcase
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, cast

import kerfwise
from kerfwise.apps.bench.bench_child import load_kernels
from kerfwise.benchmarks.plates import default_without, made_plate
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.models.engines.bounds import FlowBound
from kerfwise.models.engines.portfolio import run_portfolio
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.problem import Problem
from kerfwise.models.problem.simplify import simplify
from kerfwise.models.routing import read_instance
from kerfwise.rules.profile.profile import Profile

PAGE = """\
# What each engine brings

Made by `python -m kerfwise.benchmarks.engines{given} > docs/engines.md` with kerfwise {kerfwise}. Plates of
`examples/gen_sheet.py` (contours, seed) are planned under the default profile, with and without its zones, and with
lags of two cuts; the others are routing instances ([which](routing.md)). Each is solved within {work:g} deterministic
seconds by the whole portfolio, and once more without each member that had a part in it; what the rest makes of the time
is counted. A member stays if something here is dearer, less bounded or unproven without it. What others win by its
absence is shown, too.

| left out | what it is | had a part in | dearer or not proven without it | cheaper or better bounded without it |
|---|---|---:|---|---|
{members}

`cost` and `bound` are changes in %. Runs that none of these had a part in: {alone}. The ideals proved all of them at
once.

Merged tours, chains and exchanges of three arcs serve instances without sites to choose from, of which `prob.100` is
the one that they matter for; no cutting nest here is better for them. Regions pay with more work: with 20 in place of 4
the plate of 308 contours costs the same without them, and its bound is 0.3% lower. Windows of a plan put in their best
order by a sweep had a part in 8 of these runs and in 7 of the 19 `cnc` instances with 1 of work; none was dearer or
less bounded without them, so they were removed.

| problem | cost | bound | found by | proved by |
|---|---:|---:|---|---|
{rows}
"""
WORK = 8.0
CHANGED = 5e-4
"""Changes of a cost or bound by less than that share are not shown."""
ENGINES = "kerfwise.models.engines."
PLATES = ((16, 1), (16, 2), (41, 1), (41, 2), (60, 3), (80, 4), (115, 5), (115, 6), (308, 1))
NESTS = ("e1x_6.json", "s8877.json", "plate40.json")
LAGGED = ((8, 1), (16, 1), (24, 1))
"""Plates where two other cuts come between near contours: a state of the dynamic program does not hold that."""


@dataclass(frozen=True)
class Member:
    """Something that may be left out: `place` is a function of a module of the engines, `instead` stands for it then.

    It has a part in a run if it is called and, where it chooses, if it says yes.
    """

    what: str
    place: tuple[str, str]
    instead: Callable[..., Any]


def _nothing(*_: object, **__: object) -> None:
    return None


def _no(*_: object) -> bool:
    return False


MEMBERS = {
    "proof": Member("ideals after a first look", ("portfolio", "proof_suits"), _no),
    "priced": Member("sweeps by multipliers", ("ideals.prove", "priceable"), _no),
    "flows": Member("bounds by linear programs", ("bounds", "flow_bound"), lambda *_: FlowBound(0, 0.0)),
    "cp-sat": Member("constraint programming", ("portfolio", "solve_model"), _nothing),
    "regions": Member("search region by region", ("search.searcher", "regional"), _no),
    "merging": Member("tours merged", ("search.searcher", "mergeable"), _no),
    "chains": Member("Lin-Kernighan chains", ("search.moves.tour_merging", "chained"), _no),
    "exchanges": Member("three arcs exchanged", ("search.state.travel", "_plain"), _no),
}


@dataclass(frozen=True)
class Row:
    """What became of a problem: costs and bounds in µm."""

    cost: int | None
    bound: int
    proven: bool
    found: str
    proved: str
    part: tuple[str, ...] = ()


def problem_of(nest: Nest, profile: Profile) -> Problem:
    """What a nest asks under a profile."""
    asked = make_request(facts_of(nest, profile), profile)
    return make_problem(asked.facts, asked.stated.statements, profile.home_on(asked.facts.nest), feeds_of(profile))


def _plate(contours: int, seed: int, *off: str) -> Problem:
    return problem_of(made_plate(contours, seed), default_without(*off))


def _lagged(contours: int, seed: int) -> Problem:
    profile = default_without()
    lag = profile.rules["heat-lag"]
    rules = {**profile.rules, "heat-lag": replace(lag, options=replace(cast(Any, lag.options), lag_cuts=2))}
    return problem_of(made_plate(contours, seed), replace(profile, rules=rules))


def made(kind: str, contours: int, seed: int) -> Problem:
    """A made plate with `zones`, `free` of them, or with `lags` of two cuts, as the engines take it."""
    plate = _lagged if kind == "lags" else _plate
    return simplify(plate(contours, seed, *(("zone-order",) if kind == "free" else ())))


def _shipped(name: str) -> Problem:
    file = Path(__file__).parents[1] / "examples" / "nests" / name
    return problem_of(read_json(file.read_bytes(), ReadOptions()), default_without())


def _instance(file: Path) -> Problem:
    return read_instance(file).problem


def problems(folder: Path | None) -> dict[str, Callable[[], Problem]]:
    """All problems by name, made when they are asked for."""
    found: dict[str, Callable[[], Problem]] = {f"nest {name}": partial(_shipped, name) for name in NESTS}
    for contours, seed in PLATES:
        found[f"plate {contours}, {seed}, zones"] = partial(_plate, contours, seed)
        found[f"plate {contours}, {seed}"] = partial(_plate, contours, seed, "zone-order")
    for contours, seed in LAGGED:
        found[f"plate {contours}, {seed}, lags"] = partial(_lagged, contours, seed)
    for file in sorted([] if folder is None else [*folder.glob("*/*.pcglns*"), *folder.glob("*/*.sop*")]):
        found[f"{file.parent.name}/{file.name.split('.gz')[0]}"] = partial(_instance, file)
    return found


@contextmanager
def replaced(place: tuple[str, str], make: Callable[[Callable[..., Any]], Callable[..., Any]]) -> Iterator[None]:
    """A function of the engines is another one for a while, made of it, wherever it was imported under its name."""
    module, name = import_module(ENGINES + place[0]), place[1]
    real = getattr(module, name)
    there = [(m, name) for key, m in list(sys.modules.items()) if key.startswith(ENGINES) and vars(m).get(name) is real]
    steps: Any = import_module(ENGINES + "portfolio")
    other, known = make(real), steps.STEPS
    steps.STEPS = tuple(step._make(other if part is real else part for part in step) for step in known)
    for holder, at in there:
        setattr(holder, at, other)
    try:
        yield
    finally:
        steps.STEPS = known
        for holder, at in there:
            setattr(holder, at, real)


def solved(problem: Problem, work: float) -> Row:
    """By the whole portfolio, or what is left of it."""
    options = SolveOptions(work=work)
    known = run_portfolio(problem, options)
    cost = None if known.incumbent is None else known.incumbent.cost
    return Row(cost, known.bound_um, known.proven, known.found_by, known.proved_by)


def without(member: str, problem: Problem, work: float) -> Row:
    """By what is left of the portfolio without a member."""
    with replaced(MEMBERS[member].place, lambda _: MEMBERS[member].instead):
        return solved(problem, work)


def with_parts(problem: Problem, work: float) -> Row:
    """The same, and which members had a part in it."""
    part: list[str] = []

    def noting(name: str, real: Callable[..., Any]) -> Callable[..., Any]:
        def noted(*given: Any, **named: Any) -> Any:
            said = real(*given, **named)
            part.extend([name] if said is not False and name not in part else [])
            return said

        return noted

    def all_noted(left: list[str]) -> Row:
        if not left:
            return solved(problem, work)
        with replaced(MEMBERS[left[0]].place, partial(noting, left[0])):
            return all_noted(left[1:])

    row = all_noted(list(MEMBERS))
    return Row(row.cost, row.bound, row.proven, row.found, row.proved, tuple(sorted(part)))


def effect(whole: Row, less: Row) -> tuple[str, str]:
    """What leaving a member out loses, and what it gains; empty where that is nothing."""
    lost: list[str] = []
    won: list[str] = []
    for name, one, other, sign in (("cost", whole.cost, less.cost, 1), ("bound", whole.bound, less.bound, -1)):
        share = 0.0 if not one or not other else sign * (other - one) / one
        if (one and not other) or abs(share) > CHANGED:
            text = f"no {name}" if not other else f"{name} {sign * share:+.1%}"
            (lost if not other or share > 0 else won).append(text)
    if whole.proven != less.proven:
        (lost if whole.proven else won).append("not proven" if whole.proven else "proven")
    return ", ".join(lost), ", ".join(won)


def member_row(name: str, kept: dict[str, Row]) -> str:
    """A line of the first table."""
    shown: tuple[list[str], list[str]] = ([], [])
    part = [problem for problem, row in kept.items() if "|" not in problem and name in row.part]
    for problem in part:
        if (less := kept.get(f"{problem}|{name}")) is not None:
            for texts, text in zip(shown, effect(kept[problem], less), strict=True):
                texts.extend([f"{problem}: {text}"] if text else [])
    cells = ["<br>".join(texts) or "–" for texts in shown]
    return f"| {name} | {MEMBERS[name].what} | {len(part)} | {' | '.join(cells)} |"


def _figure(name: str, cost: int | None) -> str:
    """A cost of a nest in m, that of a routing instance as it is."""
    return "–" if cost is None else f"{cost}" if "/" in name else f"{cost / 1e6:.3f} m"


def page(kept: dict[str, Row], given: str, work: float) -> str:
    """The page of all rows."""
    whole = {name: row for name, row in kept.items() if "|" not in name}
    rows = [
        f"| {name} | {_figure(name, row.cost)} | {_figure(name, row.bound)} | {row.found} "
        f"| {row.proved if row.proven else ''} |"
        for name, row in whole.items()
    ]
    members = "\n".join(member_row(name, kept) for name in MEMBERS)
    alone = sum(not row.part for row in whole.values())
    return PAGE.format(
        given=given, kerfwise=kerfwise.__version__, work=work, members=members, alone=alone, rows="\n".join(rows)
    )


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path)
    parser.add_argument("--work", type=float, default=WORK)
    parser.add_argument("--only", nargs="+", default=["*"], metavar="PATTERN")
    parser.add_argument("--without", nargs="*", choices=sorted(MEMBERS), default=sorted(MEMBERS))
    parser.add_argument("--kept", type=Path, help="rows of an earlier run of the same program, and where to put more")
    given = parser.parse_args()
    kept: dict[str, Row] = {}
    if given.kept and given.kept.exists():
        kept = {k: Row(**row) for k, row in json.loads(given.kept.read_text(encoding="utf-8")).items()}
    load_kernels()

    def keep(name: str, row: Row) -> None:
        kept[name] = row
        print(name, row, file=sys.stderr, flush=True)
        if given.kept:
            text = json.dumps({k: asdict(row) for k, row in kept.items()}, indent=1)
            given.kept.write_text(text, encoding="utf-8", newline="\n")

    for name, make in problems(given.folder).items():
        if not any(fnmatchcase(name, pattern) for pattern in given.only):
            continue
        posed: Problem | None = None
        if name not in kept:
            posed = simplify(make())
            keep(name, with_parts(posed, given.work))
        for member in given.without:
            if member in kept[name].part and f"{name}|{member}" not in kept:
                posed = simplify(make()) if posed is None else posed
                keep(f"{name}|{member}", without(member, posed, given.work))
    said = " FOLDER" * (given.folder is not None) + f" --work {given.work:g}"
    if given.only != ["*"]:
        said += f" --only {' '.join(repr(pattern) for pattern in given.only)}"
    print(page(kept, said, given.work), end="")


if __name__ == "__main__":
    main()
