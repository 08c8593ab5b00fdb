"""Command lines by chance: every verb with its own options, right and wrong values, files that are there or not."""

from __future__ import annotations

from functools import cache
from random import Random

import click

from kerfwise.apps import VERBS as APP_VERBS
from kerfwise.cli import VERBS, program

NAMES = (
    "nest.json", "nest.json", "nest.json", "nest.svg", "nest.dxf", "made.nc", "made.nc", "made.plan.json",
    "made.plan.json",
    "plant.yaml", "nine.pcglns", "empty.json", "folder", "folder.svg", "old.nc", "old.plan.json", "old.svg", "old.png",
    "nowhere.json", "nowhere/x.json", "", ".", "..", "/", "/dev/null", "/dev/full", "a\nb.json", "\x1b[2J.json",
    "a\0b.json",
    "\udcff.json", "x" * 300 + ".json", "é№.json", "\u202e.nc", "nest.json/x.json", "-", "--", "~", "A.outer", "pierce",
)  # fmt: skip
OUTPUTS = (
    "out.nc", "out.plan.json", "out.svg", "out.png", "out.html", "out.json", "out.dzn", "out.pdf", "out", "old.nc",
    "old.svg",
    "old.plan.json", "old.png", "nest.json", "nest.svg", "plant.yaml", "folder", "folder.svg", "nowhere/out.svg",
    "/dev/full",
    "/dev/null", "/proc/x.svg", "", "a\0.svg", "x" * 300 + ".svg", "\udcff.svg", "folder/out.svg", ".svg", "a\nb.svg",
)  # fmt: skip
NUMBERS = (
    "0", "1", "2", "-1", "0.5", "1e308", "1e400", "nan", "inf", "-inf", "x", "", "9" * 40, "0x10", "1_0", "1e-300",
    " 1", "1.",
    "2147483648", "9223372036854775808", "5,5", "½",
)  # fmt: skip
TEXTS = (
    "mm", "in", "parsec", "auto", "400x300", "0x0", "1e9x1", "x", "nanxnan", "-5x5", "400", "A.outer", "A.*", "",
    "gecode",
    "nothing", "\x1b[2J", "\udcff", "a\nb", "laser-wood", "water-jet", "plasma-carbon-steel", "linuxcnc", "'", "--x",
)  # fmt: skip

TRIED = tuple(verb for verb in (*VERBS, *APP_VERBS) if verb not in ("batch", "serve", "warm-up"))
"""A batch starts processes of its own, which the fuzzer's workers may not; what watches, or serves, never ends."""


@cache
def verbs() -> dict[tuple[str, ...], click.Command]:
    """Every command by its words."""
    context = click.Context(program)
    found: dict[tuple[str, ...], click.Command] = {}
    for verb in TRIED:
        command = program.get_command(context, verb)
        assert command is not None
        found[verb,] = command
        if isinstance(command, click.Group):
            found |= {(verb, name): command.commands[name] for name in command.list_commands(context)}
            if "page" in command.commands:
                found[verb, "pierce"] = command.commands["page"]
    return found


RARE = {("pareto",): 0.1, ("rules", "test"): 0.1, ("bench",): 0.3, ("engines",): 0.2}
"""Verbs that take long, or have little to say: so often."""


def command_line(rnd: Random) -> tuple[str, ...]:
    """The words after `kerfwise`."""
    if rnd.random() < 0.03:
        return tuple(rnd.choice((*TRIED, *TEXTS, *NAMES, "--help", "--version", "-h")) for _ in range(rnd.randrange(4)))
    known = verbs()
    words = rnd.choices(list(known), [RARE.get(verb, 1.0) for verb in known])[0]
    given: list[tuple[str, ...]] = []
    for parameter in known[words].params:
        if isinstance(parameter, click.Option):
            if rnd.random() < (0.7 if parameter.required else 0.12):
                given.append(_option(parameter, rnd))
        elif rnd.random() < 0.95:
            given.append((_argument(parameter.name or "", rnd),))
    if rnd.random() < 0.05:
        given.append((rnd.choice((*TEXTS, *NAMES, "--frobnicate", "-x", "--help")),))
    if rnd.random() < 0.05:
        rnd.shuffle(given)
    must = _LIMITS.get(words, ())
    return (*words, *must, *(word for group in given for word in group))


# `rules new` writes into the checkout it runs from, unless it is told where: no word here is "new".
_LIMITS: dict[tuple[str, ...], tuple[str, ...]] = {
    ("solve",): ("--work", "0.01"),
    ("bench",): ("--work", "0.01"),
    ("pareto",): ("--work", "0.01", "--price", "1"),
    ("compare",): ("--work", "0.01"),
    ("nest",): ("--rounds", "1", "--weigh-work", "0.01"),
    ("make",): ("--rounds", "1", "--weigh-work", "0.01", "--work", "0.01"),
    ("profile", "new"): ("--output", "out.yaml"),
    ("rules", "new"): ("--into", "folder"),
    ("dialects", "new"): ("--output", "out.yaml"),  # else NAME.yaml, wherever NAME leads
    ("rules", "test"): ("--cases",),  # all plans of small nests, for every rule there is, take minutes
}


def _option(option: click.Option, rnd: Random) -> tuple[str, ...]:
    name = rnd.choice(option.opts)
    if option.is_flag:
        return (name,)
    if option.name == "into":  # a new rule is written nowhere but in the folder of the case
        return (name, rnd.choice(("folder", "nowhere", "nest.json", "/dev/null")))
    if option.name == "frames":  # sixty pictures take ten seconds
        return (name, rnd.choice(("nest.json", "nowhere/x", "", "a\0", "/dev/null")))
    if option.name in ("work", "price", "prices") and rnd.random() < 0.5:
        return ()
    return (name, _value(option, rnd))


def _value(option: click.Option, rnd: Random) -> str:
    if isinstance(option.type, click.Choice) and rnd.random() < 0.8:
        return str(rnd.choice(list(option.type.choices)))
    if isinstance(option.type, click.types.FloatParamType | click.types.IntParamType):
        return rnd.choice(NUMBERS)
    metavar = option.metavar or ""
    if "OUT" in metavar or "PLAN" in metavar or "MAP" in metavar or "FRONT" in metavar or "FACTS" in metavar:
        return rnd.choice(OUTPUTS)
    if option.name in ("profile", "lock_from", "best_known", "frames", "plans"):
        return rnd.choice((*NAMES, *TEXTS))
    return rnd.choice((*TEXTS, *NUMBERS))


def _argument(name: str, rnd: Random) -> str:
    likely = {
        "nest": "nest.json", "plan": "made.plan.json", "made": rnd.choice(("made.nc", "made.plan.json")),
        "profile": "plant.yaml", "contour": "A.outer", "rule": "pierce", "files": "nine.pcglns", "name": "some-rule",
    }  # fmt: skip
    return likely.get(name, "nest.json") if rnd.random() < 0.7 else rnd.choice((*NAMES, *TEXTS))
