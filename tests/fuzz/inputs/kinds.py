"""The kinds of input, and how a case of each is made."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from random import Random
from typing import Any

import yaml

from kerfwise.tests.fuzz.mutations import mutated

from . import seeds
from .byte_damage import damaged, truncated_gzip
from .case import Case
from .command_lines import command_line
from .pairs import chart, pair, part_list
from .tree_damage import YAML_WORDS, as_json, as_yaml, damaged_tree

Make = Callable[[Random], Case]
SHORT = ("--work", "0.01")
PLAIN = "nest.json"


def made(kind: str, seed: int, number: int) -> Case:
    """A case: the same for the same kind, seed and number."""
    return KINDS[kind](Random(f"{seed}/{kind}/{number}"))


def _chosen(rnd: Random, choices: Mapping[tuple[str, ...], int]) -> tuple[str, ...]:
    """One of the command lines, by its weight."""
    return rnd.choices(list(choices), list(choices.values()))[0]


def _profile(rnd: Random) -> Case:
    name = rnd.choice(list(seeds.profiles()))
    if rnd.random() < 0.6:
        bad = as_yaml(damaged_tree(seeds.profile_tree(name), rnd, seeds.profile_words()), rnd)
    else:
        words = (*YAML_WORDS, *(word.encode() for word in seeds.profile_words()))
        bad = damaged(seeds.profiles()[name], rnd, words)
    chain = rnd.random() < 0.15
    files: dict[str, bytes | None] = {"plant.yaml": bad}
    if chain:
        files["near.yaml"] = rnd.choice((b"based_on: plant.yaml\n", b"name: n\nbased_on: plant.yaml\nlocks: []\n"))
    profile = "near.yaml" if chain else "plant.yaml"
    words = _chosen(
        rnd,
        {
            ("profile", "check", profile): 12,
            ("profile", "show", profile): 5,
            ("rules", "-p", profile): 1,
            ("facts", PLAIN, "-p", profile): 4,
            ("solve", PLAIN, "-p", profile, *SHORT): 3,
            ("time", PLAIN, "made.nc", "-p", profile): 2,
            ("heat", PLAIN, "made.nc", "-p", profile): 1,
            ("check", PLAIN, "made.nc", "-p", profile): 2,
        },
    )
    return Case("profile", files | _nest(rnd) if PLAIN in words else files, words, ("plant.yaml",))


def _job(rnd: Random) -> Case:
    """A job file beside a nest."""
    words = (*seeds.JOB_WORDS, *seeds.profile_words())
    if rnd.random() < 0.7:
        bad = as_yaml(damaged_tree(seeds.JOB, rnd, words), rnd)
    else:
        good = yaml.safe_dump(seeds.JOB, sort_keys=False).encode()
        bad = damaged(good, rnd, (*YAML_WORDS, *(word.encode() for word in words)))
    asked = _chosen(
        rnd,
        {
            ("job", "check", "nest.job.yaml"): 8,
            ("facts", PLAIN): 3,
            ("solve", PLAIN, *SHORT): 3,
            ("check", PLAIN, "made.plan.json"): 2,
            ("profile", "show", "--job", "nest.job.yaml", "--sources"): 2,
            ("facts", PLAIN, "--no-job", "--lock", rnd.choice(seeds.JOB_WORDS), "--set", f"{rnd.choice(words)}=1"): 3,
        },
    )
    program, plan = seeds.made("plain")
    files: dict[str, bytes | None] = {
        "nest.job.yaml": bad,
        "plant.yaml": b"name: plant\nbased_on: plasma-carbon-steel\n",
        PLAIN: seeds.nest_bytes("plain"),
        "made.nc": program,
        "made.plan.json": plan,
        "nest.plan.json": plan,
    }
    solved = ("nest.plan.json",) if asked[0] == "solve" else ()  # the last plan gives way to the new one
    return Case("job", files, asked, ("nest.job.yaml",), solved)


def _nest(rnd: Random) -> dict[str, bytes | None]:
    """A good nest, its program and its plan."""
    name = rnd.choice(("plain", "plain", "rich"))
    program, plan = seeds.made(name)
    return {PLAIN: seeds.nest_bytes(name), "made.nc": program, "made.plan.json": plan}


def _dialect(rnd: Random) -> Case:
    name = rnd.choice(("linuxcnc", "linuxcnc-qtplasmac"))
    good = seeds.dialect_bytes(name)
    if rnd.random() < 0.6:
        tree = yaml.safe_load(good)
        bad = as_yaml(damaged_tree(tree, rnd, (*tree, *_DIALECT_WORDS)), rnd)
    else:
        bad = damaged(good, rnd, (*YAML_WORDS, *(word.encode() for word in _DIALECT_WORDS)))
    profile = b"name: own\nbased_on: plasma-carbon-steel\nmachine: {dialect: dialect.yaml, accept_dialect: true}\n"
    files: dict[str, bytes | None] = {"dialect.yaml": bad, "plant.yaml": profile}
    words = _chosen(rnd, {("profile", "check", "plant.yaml"): 8, ("solve", PLAIN, "-p", "plant.yaml", *SHORT): 1})
    return Case("dialect", files | _nest(rnd) if PLAIN in words else files, words, ("dialect.yaml",))


_DIALECT_WORDS = (
    "{mm_min}", "{seconds}", "{text}", "{}", "{0}", "{text!r}", "{text:>99999999}", "{text.__class__}", "{", "}", "G1",
    "G0", "G2", "M3 $0 S1", "M5", "M2", "(", ")", ";", "relative", "absolute", "machine", "program", "plasma", "laser",
    "linuxcnc", "decimals", "max_line", "line_numbers", "F{mm_min}{mm_min}", "G4 P{seconds}", "%", "N10", "G20", "M30",
)  # fmt: skip


def _program(rnd: Random) -> Case:
    name = rnd.choice(("plain", "rich", "rest"))
    good = seeds.made(name)[0]
    bad = mutated(good, rnd) if rnd.random() < 0.7 else damaged(good, rnd)
    words = _chosen(
        rnd,
        {
            ("check", PLAIN, "bad.nc"): 6,
            ("time", PLAIN, "bad.nc"): 6,
            ("time", PLAIN, "bad.nc", "--json"): 1,
            ("heat", PLAIN, "bad.nc"): 3,
            ("heat", PLAIN, "bad.nc", "--model", "logical", "--json"): 1,
            ("solve", PLAIN, "--lock-from", "bad.nc", "--upto", rnd.choice("1239"), *SHORT): 1,
            ("check", PLAIN, "bad.nc", "--origin", "sheet-corner"): 1,
            ("plot", PLAIN, "bad.nc", "-o", "out.svg"): 1,
        },
    )
    nest = seeds.nest_bytes("rich" if name == "rest" else name)
    return Case("program", {PLAIN: nest, "bad.nc": bad}, words, ("bad.nc",))


@cache
def _plan_tree(name: str) -> Any:
    return json.loads(seeds.made(name)[1])


def _plan(rnd: Random) -> Case:
    name = rnd.choice(("plain", "rich", "rest"))
    if rnd.random() < 0.7:
        bad = as_json(damaged_tree(_plan_tree(name), rnd, seeds.PLAN_WORDS), rnd)
    else:
        bad = damaged(seeds.made(name)[1], rnd, [word.encode() for word in seeds.PLAN_WORDS])
    contour = rnd.choice(("A.outer", "B.outer", "D.hole1", "A.outer.slit"))
    words = _chosen(
        rnd,
        {
            ("check", PLAIN, "bad.json"): 5,
            ("time", PLAIN, "bad.json"): 3,
            ("heat", PLAIN, "bad.json"): 2,
            ("explain", PLAIN, "bad.json", contour): 2,
            ("explain", PLAIN, "bad.json", contour, "--all", "--json"): 1,
            ("plot", PLAIN, "bad.json", "-o", "out.svg"): 2,
            ("plot", PLAIN, "bad.json", "-o", "out.html"): 1,
            ("solve", PLAIN, "--lock-from", "bad.json", "--upto", rnd.choice("1239"), *SHORT): 1,
        },
    )
    nest = seeds.nest_bytes("rich" if name == "rest" else name)
    return Case("plan", {PLAIN: nest, "bad.json": bad}, words, ("bad.json",))


def _read(rnd: Random, name: str) -> tuple[str, ...]:
    """A command that reads a nest, with options that change how."""
    words = _chosen(
        rnd,
        {
            ("facts", name): 6,
            ("plot", name, "-o", "out.svg"): 5,
            ("solve", name, *SHORT): 2,
            ("facts", name, "-o", "facts.dzn"): 1,
            ("plot", name, "-o", "out.html"): 1,
        },
    )
    for option, share in (
        (("--repair",), 0.3),
        (("--units", rnd.choice(("mm", "cm", "in", "auto", "furlong"))), 0.1),
        (("--sheet", rnd.choice(("400x300", "5x5", "1e5x1e5"))), 0.1),
        (("--frame", rnd.choice(("sheet", "part"))), 0.1),
        (("--origin", "sheet-corner"), 0.1),
        (("-p", rnd.choice(("laser-wood", "water-jet", "oxyfuel-thick-plate"))), 0.1),
    ):
        if rnd.random() < share:
            words += option
    return words


def _nest_json(rnd: Random) -> Case:
    name = rnd.choice(("plain", "rich"))
    if rnd.random() < 0.7:
        bad = as_json(damaged_tree(seeds.nest(name), rnd, seeds.NEST_WORDS), rnd)
    else:
        bad = damaged(seeds.nest_bytes(name), rnd, [word.encode() for word in seeds.NEST_WORDS])
    return Case("nest", {"bad.json": bad}, _read(rnd, "bad.json"), ("bad.json",))


def _svg(rnd: Random) -> Case:
    bad = damaged(rnd.choice(seeds.SVG), rnd, seeds.SVG_WORDS)
    return Case("svg", {"bad.svg": bad}, _read(rnd, "bad.svg"), ("bad.svg",))


def _dxf(rnd: Random) -> Case:
    good = seeds.drawing(rnd.choice(("lines", "curves")))
    bad = _tags(good, rnd) if rnd.random() < 0.6 else damaged(good, rnd, seeds.DXF_WORDS)
    return Case("dxf", {"bad.dxf": bad}, _read(rnd, "bad.dxf"), ("bad.dxf",))


def _tags(data: bytes, rnd: Random) -> bytes:
    """DXF is pairs of lines, a code and a value: some pairs changed, left out, doubled, moved."""
    lines = data.split(b"\n")
    pairs = [lines[k : k + 2] for k in range(0, len(lines), 2)]
    for _ in range(rnd.choice((1, 1, 2, 3))):
        at, other = rnd.randrange(len(pairs)), rnd.randrange(len(pairs))
        match rnd.randrange(6):
            case 0:
                del pairs[at]
            case 1:
                pairs.insert(other, pairs[at])
            case 2:
                pairs[other:other] = pairs[at : at + rnd.choice((2, 5, 20))] * rnd.choice((1, 2))
            case 3:
                pairs[at] = [rnd.choice(seeds.DXF_WORDS), pairs[at][-1]]
            case 4:
                pairs[at] = [pairs[at][0], rnd.choice(seeds.DXF_WORDS)]
            case _:
                pairs[at] = damaged(b"\n".join(pairs[at]), rnd).split(b"\n")
    return b"\n".join(line for pair in pairs for line in pair)


def _routing(rnd: Random) -> Case:
    name = rnd.choice(seeds.INSTANCES)
    good = seeds.instance(name)
    files: dict[str, bytes | None]
    if rnd.random() < 0.1:
        files = {name: good, "best.csv": damaged(seeds.BEST_KNOWN, rnd, (b"set", b"instance", b"cost", b'"', b"nine"))}
        return Case("routing", files, ("bench", name, "--best-known", "best.csv", *SHORT), ("best.csv",))
    bad = damaged(good, rnd, seeds.ROUTING_WORDS)
    if rnd.random() < 0.15:
        name, bad = f"{name}.gz", truncated_gzip(bad, rnd)
    return Case("routing", {name: bad}, ("bench", name, *SHORT, *(("--json",) * (rnd.random() < 0.2))), (name,))


def _model(rnd: Random) -> Case:
    """A rule in MiniZinc. Each run of MiniZinc takes a tenth of a second and more: few of them."""
    bad = damaged(seeds.rule_file(rnd.choice(("plant.mzn", "shipped.mzn"))), rnd, seeds.MODEL_WORDS)
    words = _chosen(
        rnd,
        {
            ("profile", "check", "plant.yaml"): 4,
            ("solve", PLAIN, "-p", "plant.yaml", *SHORT): 4,
            ("check", PLAIN, "made.nc", "-p", "plant.yaml"): 2,
            ("rules", "test", "rule.mzn", "--cases"): 1,
        },
    )
    files = {"rule.mzn": bad, "plant.yaml": b"name: plant\nmodels: [rule.mzn]\nrules: {rule: soft}\n"}
    return Case("model", files | _nest(rnd), words, ("rule.mzn",))


def _python(rnd: Random) -> Case:
    """A rule in Python that is trusted: the text of one that works, with words of Python and of rules."""
    bad = damaged(seeds.rule_file("plant.py"), rnd, seeds.PYTHON_WORDS)
    words = _chosen(
        rnd,
        {
            ("profile", "check", "plant.yaml", "--trust"): 2,
            ("solve", PLAIN, "-p", "plant.yaml", "--trust", *SHORT): 5,
            ("check", PLAIN, "made.nc", "-p", "plant.yaml", "--trust"): 2,
            ("rules", "-p", "plant.yaml", "--trust"): 1,
            ("rules", "test", "rule.py", "--cases"): 1,
        },
    )
    files = {"rule.py": bad, "plant.yaml": b"name: plant\npython: [rule.py]\nrules: {rule: soft}\n"}
    return Case("python", files | _nest(rnd), words, ("rule.py",))


def _arguments(rnd: Random) -> Case:
    name = rnd.choice(("plain", "rich"))
    program, plan = seeds.made(name)
    files: dict[str, bytes | None] = {
        "nest.json": seeds.nest_bytes(name),
        "nest.svg": seeds.SVG[0],
        "nest.dxf": seeds.drawing("lines"),
        "made.nc": program,
        "made.plan.json": plan,
        "plant.yaml": b"name: plant\nbased_on: plasma-carbon-steel\n",
        "nine.pcglns": seeds.instance("nine.pcglns"),
        "empty.json": b"",
        "folder": None,
        "folder.svg": None,
        "old.nc": b"old",
        "old.plan.json": b"old",
        "old.svg": b"old",
        "old.png": b"old",
    }
    words = command_line(rnd)
    outputs = {k for k, word in enumerate(words) if k and words[k - 1] in _OUTPUTS}
    read = {word for k, word in enumerate(words) if k not in outputs}
    return Case("arguments", files, words, (), tuple(words[k] for k in outputs if words[k] not in read))


_OUTPUTS = ("-o", "--output", "--plan", "--dxf", "--picture", "--conflict-picture")


KINDS: Mapping[str, Make] = {
    "profile": _profile,
    "dialect": _dialect,
    "program": _program,
    "plan": _plan,
    "arguments": _arguments,
    "nest": _nest_json,
    "svg": _svg,
    "dxf": _dxf,
    "routing": _routing,
    "model": _model,
    "python": _python,
    "job": _job,
    "pair": pair,
    "chart": chart,
    "list": part_list,
}
SHARES: Mapping[str, int] = {
    "profile": 15, "dialect": 7, "program": 12, "plan": 9, "arguments": 12, "nest": 9, "svg": 7, "dxf": 6,
    "routing": 5, "model": 1, "python": 2, "job": 4, "pair": 7, "chart": 2, "list": 2,
}  # fmt: skip
"""Of a hundred cases of all kinds, so many are of each."""


def kind_of(number: int, kinds: Sequence[str]) -> str:
    """The kind of a case, by its number: kinds come in turn, by their shares."""
    total = sum(SHARES[kind] for kind in kinds)
    at = number * 37 % total
    for kind in kinds:
        at -= SHARES[kind]
        if at < 0:
            return kind
    raise AssertionError(number)
