"""One made nest through `kerfwise solve` under one profile, and its program through the simulation."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import tempfile
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from kerfwise import load_profile, read_nest, read_plan
from kerfwise.cli import main as kerfwise
from kerfwise.postproc.dialects.load import new_dialect_text
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.made_nests import Made, made
from kerfwise.tests.metal.plant import hole_limit_mm, plant, tabs_of
from kerfwise.tests.metal.program import UnreadableProgram, read_program
from kerfwise.tests.metal.simulate import simulate


@dataclass(frozen=True, slots=True)
class Tried:
    """What came of a nest under a profile: a refusal, something broken, or a program with its findings.

    `cuts_with` names what the profile was given besides (`BEYOND`). `rest` says that it takes up the work of another
    program, which stopped after half of its cuts. `along_edges` are the cuts along common edges.
    """

    seed: int
    profile: str
    cuts_with: str = ""
    rest: bool = False
    refused: str = ""
    broken: str = ""
    cuts: int = 0
    along_edges: int = 0
    findings: tuple[Finding, ...] = ()
    program: str = ""


LINKS = "machine: {pierce_time: 2 s}\ncuts: {links: {longest: 90 mm}}\n"
TABS = "rules: {hold-small-parts: {strength: hard, tabs: tipping, width: 0.5 mm, corner: 1 mm}}\n"
PASS = "machine: {pierce_dwell: program}\ncuts: {pierce_pass: zone}\n"
EDGES = "common: {shortest: 15 mm, good_side: any"
COMMON = f"machine: {{pierce_dwell: program, pierce_time: 2 s, edge_preheat: 1 s}}\ncuts: {{{EDGES}}}"
SNAKE = "machine: {pierce_dwell: program, pierce_time: 2 s, edge_preheat: 1 s}\ncuts: {snake: {gap: 30 mm}"
BEYOND: Mapping[str, str] = {
    "": "",
    "links": LINKS,
    "tabs": TABS,
    "links, tabs": LINKS + TABS,
    "scrap lines": "cuts: {scrap: {grid: 150 mm}}\n",
    "remnant, tabs": "cuts: {scrap: {remnant: right}}\n" + TABS,
    "scrap lines, tabs": "cuts: {scrap: {grid: 100 mm}}\n" + TABS,
    "pierce pass": PASS,
    "pierce pass, tabs": PASS + TABS,
    "common cuts": COMMON + "}\n",
    "common cuts, links": COMMON + ", links: {longest: 90 mm}}\n",
    "common cuts, tabs": COMMON + "}\n" + TABS,
    "common cuts, pass": COMMON + ", pierce_pass: zone}\n",
    "common cuts, scrap": COMMON + ", scrap: {grid: 150 mm}}\n",
    "edges that touch": COMMON.removesuffix("}") + ", accept_loss: true}}\n",
    "snake": SNAKE + "}\n",
    "snake of rows": SNAKE.removesuffix("}") + ", rows: 4}}\n",
    "snake, common": SNAKE + f", {EDGES}}}}}\n",
    "snake, split": SNAKE + ", split: {halves: 4, last: 15 mm}}\n",
    "split": SNAKE.replace("snake: {gap: 30 mm}", "split: {halves: 3, last: 15 mm}") + "}\n",
    "kerf by the control": "machine: {dialect: shop.yaml, accept_dialect: true}\n",
    "snake, links": SNAKE + ", links: {longest: 90 mm}}\n",
}
"""What a profile is given besides, by name: cuts beyond one contour and one pierce."""
IN_TURN = tuple(name for name in BEYOND if not any(word in name for word in ("snake", "split", "control")))
SHOP = new_dialect_text("shop", "linuxcnc") + 'kerf: {left: "G41.1 D{kerf}", right: "G42.1 D{kerf}"}\n'
ANSWERS = {"small-holes": ("spot", "skip", "cut"), "narrow": ("slit", "leave")}
"""What a plant answers where a drawing asks: another choice for each seed."""


def beyond(seed: int, profile: str) -> str:
    """What a profile is given besides with the nest of a seed: each in turn, another under another profile."""
    return IN_TURN[(seed + sum(profile.encode())) % len(IN_TURN)]


def nest_of(seed: int, profile: str, cuts_with: str) -> Made:
    """The nest of a seed; where it is to have common cuts its parts stand a kerf apart, or touch."""
    if cuts_with == "edges that touch":
        return made(seed, 0.0)
    return made(seed, load_profile(profile).material.kerf_mm if "common" in cuts_with else None)


def tried(
    nest: Made, profile: str, effort: tuple[str, ...], rests: bool = False, cuts_with: str = ""
) -> tuple[Tried, ...]:
    """Plan, and judge what comes out; `effort` are the limit's words on the command line.

    With `rests` the work stops after half of the cuts, and what is left is planned and judged too.
    """
    with tempfile.TemporaryDirectory(prefix="metal-") as name:
        folder = Path(name)
        (folder / "nest.json").write_text(nest.text, encoding="utf-8")
        (folder / "shop.yaml").write_text(SHOP, encoding="utf-8")
        answers = {question: choices[nest.seed % len(choices)] for question, choices in ANSWERS.items()}
        own = f"name: tried\nbased_on: {profile}\ndrawing: {{answers: {json.dumps(answers)}}}\n{BEYOND[cuts_with]}"
        (folder / "profile.yaml").write_text(own, encoding="utf-8")
        words = ("-p", "profile.yaml", *effort)
        asked = Tried(nest.seed, profile, cuts_with)
        whole = _planned(asked, folder, "nest", words)
        if not rests or whole.cuts < 2:
            return (whole,)
        before = (folder / "nest.nc").read_text(encoding="utf-8")
        resumed = (*words, "--lock-from", "nest.plan.json", "--upto", str(whole.cuts // 2))
        return whole, _planned(replace(asked, rest=True), folder, "rest", resumed, before)


def _planned(asked: Tried, folder: Path, name: str, words: tuple[str, ...], before: str | None = None) -> Tried:
    """What comes of `kerfwise solve` with these words."""
    program = folder / f"{name}.nc"
    code, said = _solve(folder, ("-o", program.name, "--plan", f"{name}.plan.json", *words))
    if code in (1, 2, 3) and not program.exists():  # 3: parts that touch raise a question
        return replace(asked, refused=reason(said))
    if code != 0 or not program.exists():
        return replace(asked, broken=f"exit code {code}: {said.strip()[-400:]}")
    return _burnt(asked, folder, name, before)


def _burnt(asked: Tried, folder: Path, name: str, before: str | None) -> Tried:
    """The program's findings."""
    profile = load_profile(str(folder / "profile.yaml")).as_answered()
    nest = read_nest(folder / "nest.json", profile)
    kept = profile.as_cut(nest)
    lined = kept if kept.losses else replace(nest, scrap=kept.scrap)
    text = (folder / f"{name}.nc").read_text(encoding="utf-8")
    plan = read_plan(folder / f"{name}.plan.json")
    tabs, along_edges = tabs_of(plan), sum(planned.cut.span is not None for planned in plan.cuts)
    try:
        cuts = len({path.order for path in read_program(text, profile.material.kerf_mm).paths})
        uncut = {"spotted": kept.spotted, "left_out": kept.left_out, "hole_limit_mm": hole_limit_mm(profile)}
        found = simulate(lined, text, before=before, tabs=tabs, **uncut, **plant(profile))
    except UnreadableProgram as error:
        return replace(asked, broken=f"unreadable: {error}", program=text)
    return replace(asked, cuts=cuts, along_edges=along_edges, findings=tuple(found), program=text if found else "")


def _solve(folder: Path, words: tuple[str, ...]) -> tuple[int, str]:
    """Exit code and what was said, by the command line's own entry."""
    said, code = io.StringIO(), 0
    here = Path.cwd()
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            kerfwise(["solve", "nest.json", *words])
    except SystemExit as left:
        code = int(left.code or 0)
    except Exception:
        return 70, traceback.format_exc()
    finally:
        os.chdir(here)
    return code, said.getvalue()


_IDS = re.compile(r"\b[\w-]+\.(?:outer|hole\d+|mark\d+)\b|\b[A-Z]\d+\b")
_LISTS = re.compile(r" \(…(?:, …)*(?: and N more)?\)")
_NUMBERS = re.compile(r"-?\d+(?:\.\d+)?")


def reason(said: str) -> str:
    """The class of a refusal: first detail or line without ids and numbers, or what the check finds broken."""
    broken = re.findall(r"^broken\s+hard (\S+)", said, re.MULTILINE)
    if broken:
        return f"the plan does not pass the check: {', '.join(sorted(set(broken)))}"
    lines = said.splitlines() or ["nothing said"]
    line = next((line for line in lines if line.startswith("kerfwise: ")), lines[0])
    line = line.removeprefix("kerfwise: ").removeprefix("nest.json: ")
    detail = next((text[4:] for text in said.splitlines() if text.startswith("  - ")), "")
    told_class = _NUMBERS.sub("N", _IDS.sub("…", detail or line))
    told_class = _LISTS.sub("", told_class.removeprefix("shared-metal: ").removeprefix("… at (N, N): "))
    return told_class.removeprefix("N ").split(";")[0][:150]
