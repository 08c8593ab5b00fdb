"""One made nest through `kerfwise solve` under one profile, and its program through the simulation."""

from __future__ import annotations

import contextlib
import io
import os
import re
import tempfile
import traceback
from dataclasses import dataclass
from pathlib import Path

from kerfwise.cli import main as kerfwise
from kerfwise.encoder.readers import read_nest
from kerfwise.rules.profile import load_profile
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.made_nests import Made
from kerfwise.tests.metal.program import UnreadableProgram, read_program
from kerfwise.tests.metal.simulate import simulate


@dataclass(frozen=True, slots=True)
class Tried:
    """What came of a nest under a profile: a refusal, something broken, or a program with its findings."""

    seed: int
    profile: str
    refused: str = ""
    broken: str = ""
    cuts: int = 0
    findings: tuple[Finding, ...] = ()
    program: str = ""


def tried(nest: Made, profile: str, effort: tuple[str, ...]) -> Tried:
    """Plan, and judge what comes out; `effort` are the limit's words on the command line."""
    with tempfile.TemporaryDirectory(prefix="metal-") as name:
        folder = Path(name)
        (folder / "nest.json").write_text(nest.text, encoding="utf-8")
        code, said = _solve(folder, profile, effort)
        written = folder / "nest.nc"
        if code in (1, 2) and not written.exists():
            return Tried(nest.seed, profile, refused=reason(said))
        if code != 0 or not written.exists():
            return Tried(nest.seed, profile, broken=f"exit code {code}: {said.strip()[-400:]}")
        return judged(nest.seed, folder / "nest.json", profile, written.read_text(encoding="utf-8"))


def judged(seed: int, file: Path, profile_name: str, text: str) -> Tried:
    """The program's findings."""
    profile = load_profile(profile_name)
    edge_starts = profile.leads.edge_start
    try:
        cuts = len(read_program(text).paths)
        found = simulate(
            read_nest(file, profile.read_options()), text, profile.material.kerf_mm, edge_starts=edge_starts
        )
    except UnreadableProgram as error:
        return Tried(seed, profile_name, broken=f"unreadable: {error}", program=text)
    return Tried(seed, profile_name, cuts=cuts, findings=tuple(found), program=text if found else "")


def _solve(folder: Path, profile: str, effort: tuple[str, ...]) -> tuple[int, str]:
    """Exit code and what was said, by the command line's own entry."""
    said, code = io.StringIO(), 0
    before = Path.cwd()
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            kerfwise(["solve", "nest.json", "-p", profile, "-o", "nest.nc", *effort])
    except SystemExit as left:
        code = int(left.code or 0)
    except Exception:
        return 70, traceback.format_exc()
    finally:
        os.chdir(before)
    return code, said.getvalue()


_IDS = re.compile(r"\b[\w-]+\.(?:outer|hole\d+|mark\d+)\b|\b[A-Z]\d+\b")
_NUMBERS = re.compile(r"-?\d+(?:\.\d+)?")


def reason(said: str) -> str:
    """The class of a refusal: first detail or line without ids and numbers, or what the check finds broken."""
    broken = re.findall(r"^broken\s+hard (\S+)", said, re.MULTILINE)
    if broken:
        return f"the plan does not pass the check: {', '.join(sorted(set(broken)))}"
    told = (
        [line for line in said.splitlines() if line.startswith("kerfwise: ")] or said.splitlines() or ["nothing said"]
    )
    line = told[0].removeprefix("kerfwise: ").removeprefix("nest.json: ")
    detail = next((text[4:] for text in said.splitlines() if text.startswith("  - ")), "")
    told_class = _NUMBERS.sub("N", _IDS.sub("…", detail or line))
    return told_class.removeprefix("… at (N, N): ").split(";")[0][:150]
