"""Runs a case: its command lines, one after the other, in an empty folder with its files.

Nothing of kerfwise is used but its command line and `import kerfwise`, so that files may be moved and renamed.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shlex
import shutil
import tempfile
import time
import traceback
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

import kerfwise
from kerfwise.cli import main
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.tests.golden import meaning

HELD = re.compile(r"(holds|off) +(hard|soft|off) +\S")
"""A rule that holds, as the check prints it: one case has the sentences of all."""
HERE = Path(__file__).parent
ROOT = HERE.parents[1]
NOT_SAID = re.compile(r"still going|compil|\bLast \d+ s\b")
"""Lines on standard error that come by the clock."""


@dataclass(frozen=True)
class Ran:
    """What a case means, and the texts that it came with."""

    name: str
    means: dict[str, Any]
    texts: str


def cases() -> dict[str, dict[str, Any]]:
    """All cases by name, as `cases.yaml` has them."""
    held = yaml.safe_load((HERE / "cases.yaml").read_text(encoding="utf-8"))
    return {name: {"nests": held["nests"], **case} for name, case in held["cases"].items()}


def run(name: str, case: dict[str, Any], into: Path | None = None) -> Ran:
    """Run a case in a folder for it alone; it stays where `into` names one."""
    with _folder(name, into) as folder:
        for file, content in case.get("files", {}).items():
            _write(folder / file, content, case["nests"])
        steps, texts = [], []
        for step in case["run"]:
            means, said = _step(step, folder, bool(case.get("whole_texts")))
            steps.append(means)
            texts += [f"$ {_title(step)}", *said, ""]
        return Ran(name, {"about": case["about"], "steps": steps}, "\n".join(texts))


def timed(name: str, case: dict[str, Any], into: Path | None = None) -> tuple[Ran, float]:
    """The same with its seconds; a case that cannot be run means its error."""
    began = time.perf_counter()
    try:
        ran = run(name, case, into)
    except Exception as error:
        ran = Ran(name, {"error": repr(error)}, traceback.format_exc())
    return ran, time.perf_counter() - began


@contextlib.contextmanager
def _folder(name: str, into: Path | None) -> Iterator[Path]:
    """An empty folder as the working folder, and a user without settings of kerfwise."""
    base = Path(tempfile.mkdtemp(prefix="golden-")).resolve()
    folder = base / name if into is None else into.resolve() / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    before, kept = Path.cwd(), {k: os.environ.get(k) for k in ("XDG_CONFIG_HOME", "KERFWISE_TRUST", "COLUMNS")}
    os.chdir(folder)
    os.environ.update(XDG_CONFIG_HOME=str(base / "config"), KERFWISE_TRUST="", COLUMNS="120")
    try:
        yield folder
    finally:
        os.chdir(before)
        for key, value in kept.items():
            os.environ.pop(key) if value is None else os.environ.update({key: value})
        shutil.rmtree(base)


def _write(path: Path, content: Any, nests: dict[str, Any]) -> None:
    """A file of a case: text, a mapping, the name of a nest of the table, or a path of the repository."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(content, str) and content in nests:
        content = nests[content]
    if isinstance(content, str) and "\n" not in content:
        shutil.copyfile(ROOT / content, path)
    elif isinstance(content, str):
        path.write_text(content, encoding="utf-8")
    else:
        if "seed" in content:
            size = content.get("size")
            web = {k: content[k] for k in ("gap_mm", "web_mm") if k in content}
            content = make_sheet(content["seed"], content["contours"], None if size is None else tuple(size), **web)
        if "parts" in content and path.suffix == ".json":
            content = {"format": "kerfwise-nest/1", "units": "mm", **content}
        as_json = path.suffix == ".json"
        text = json.dumps(content) if as_json else yaml.safe_dump(content, sort_keys=False, allow_unicode=True)
        path.write_text(text, encoding="utf-8")


def _step(step: Any, folder: Path, whole_texts: bool) -> tuple[dict[str, Any], list[str]]:
    """One step: a command line, or a change to a file."""
    if isinstance(step, dict):
        return _edited(step, folder), []
    before = _held(folder)
    words = shlex.split(step)
    code, out, err = _command(words)
    said = [f"exit {code}", *_scrubbed(out, folder), *(f"! {line}" for line in _scrubbed(err, folder))]
    means: dict[str, Any] = {"run": step, "exit": code}
    if "--json" in words and out.startswith(("{", "[")):
        said = said[:1]
        means["printed"] = meaning.of_printed(out, said)
    now = _held(folder)
    written: dict[str, Any] = {}
    for name, content in now.items():
        if before.get(name) != content:
            texts: list[str] = []
            written[name] = meaning.of_file(folder / name, texts)
            said += [f"{name}: {line}" for line in _one_of_a_kind(texts)]
    if gone := [name for name in before if name not in now]:
        means["removed"] = gone
    means["written"] = written
    if words[0] in ("solve", "check") and code in (0, 1):
        means |= _judged(words, written, said)
        if not whole_texts:
            said = [line for line in said if not HELD.match(line)]
    return means, _scrubbed("\n".join(said), folder)


def _one_of_a_kind(lines: list[str]) -> list[str]:
    """The first of all lines that differ by numbers and contours only."""
    kinds: dict[str, str] = {}
    for line in lines:
        kinds.setdefault(re.sub(r"[\w#+-]+\.(outer|hole|mark|slit|scrap)\d*|[PA-Z]*\d[\d.]*", "#", line), line)
    return list(kinds.values())


def _command(words: list[str]) -> tuple[int, str, str]:
    """`kerfwise WORDS…` in this process: exit code, and what was printed."""
    out, err = io.StringIO(), io.StringIO()
    code: Any = None
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
        try:
            main(words)
        except SystemExit as end:
            code = end.code
    return code, out.getvalue(), err.getvalue()


def _judged(words: list[str], written: dict[str, Any], said: list[str]) -> dict[str, Any]:
    """The verdict on what was solved or checked, by the Python interface, which has it as data."""
    options, given = _options(words)
    if words[0] == "check":
        nest, made = [*given, None][:2]
        plan = options.get("--plan", [None])[0]
    else:
        nest = given[0]
        programs = [n for n in written if isinstance(written[n], dict) and "words" in written[n]]
        plans = [n for n in written if isinstance(written[n], dict) and "cuts" in written[n]]
        if len(programs) != 1 or len(plans) != 1:
            return {}
        made, plan = programs[0], plans[0]
    if made is None or any(word in options for word in ("--feed", "--kerf")):
        return {}
    try:
        with warnings.catch_warnings(), contextlib.redirect_stderr(io.StringIO()):
            warnings.simplefilter("ignore")
            result = kerfwise.check(_nest(nest, options), made, _profile(options), plan, job=_job(nest, options, plan))
    except kerfwise.KerfwiseError as error:
        said.append(f"not judged: {error}")
        return {"verdict": "not judged"}
    return {"verdict": meaning.verdicts(result)}


VALUELESS = {"--no-job", "--trust", "--repair", "--relax", "--redo-last", "-v", "--verbose", "--json", "--all"}


def _options(words: list[str]) -> tuple[dict[str, list[str]], list[str]]:
    """The options of a command line with their values, and its arguments."""
    options: dict[str, list[str]] = {}
    given: list[str] = []
    rest = iter(words[1:])
    for word in rest:
        if word in VALUELESS:
            options[word] = []
        elif word.startswith("-"):
            options.setdefault({"-p": "--profile", "-o": "--output"}.get(word, word), []).append(next(rest))
        else:
            given.append(word)
    return options, given


def _nest(nest: str, options: dict[str, list[str]]) -> Any:
    """The nest as the command read it: a path, where nothing is said about how to read it."""
    more: dict[str, Any] = {}
    if "--sheet" in options:
        wide, high = options["--sheet"][0].split("x")
        more["sheet_mm"] = float(wide), float(high)
    if "--refit-arcs" in options:
        more["refit_arcs_mm"] = float(options["--refit-arcs"][0])
    more |= {key: options[f"--{key}"][0] for key in ("units", "frame") if f"--{key}" in options}
    more |= {"repair": True} if "--repair" in options else {}
    return kerfwise.read_nest(nest, _profile(options) or "plasma-carbon-steel", **more) if more else nest


def _profile(options: dict[str, list[str]]) -> Any:
    named = options.get("--profile", [None])[0]
    return kerfwise.load_profile(named, trust=True) if named is not None and "--trust" in options else named


def _numbered(lock: str, plan: str | None) -> str:
    """The lock with the contours that its numbers, such as #7, stood for when the plan was made."""
    if "#" in lock and plan is not None:
        for number, contour in json.loads(Path(plan).read_text(encoding="utf-8"))["job"].get("numbered", {}).items():
            lock = lock.replace(number, contour)
    return lock


def _job(nest: str, options: dict[str, list[str]], made: str | None) -> Any:
    """The job file with what the command line set and locked, in a file of its own outside the folder of the case."""
    values = [*options.get("--set", []), *(f"machine.origin={v}" for v in options.get("--origin", []))]
    locks = [_numbered(lock, made) for lock in options.get("--lock", [])]
    if not values and not locks:
        return options["--job"][0] if "--job" in options else (False if "--no-job" in options else None)
    if Path(nest).with_suffix(".job.yaml").exists():
        raise ValueError("a case has a job file, or --set and --lock, not both: the verdict would miss one")
    with tempfile.TemporaryDirectory() as aside:
        file = Path(aside) / "verdict.job.yaml"
        sets = [f"  {value.replace('=', ': ', 1)}" for value in values]
        held = (["set:", *sets] if sets else []) + [f"locks: {json.dumps(locks)}"]
        file.write_text("\n".join(held) + "\n", encoding="utf-8")
        return kerfwise.read_job(file)


def _edited(step: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Change a file as somebody might: the first `count` places (all, if none is given) that `replace` matches."""
    file = folder / step["edit"]
    text, made = re.subn(step["replace"], step["by"], file.read_text(encoding="utf-8"), count=step.get("count", 0))
    file.write_text(text, encoding="utf-8")
    return {"edit": step["edit"], "replace": step["replace"], "places": made}


def _title(step: Any) -> str:
    return step if isinstance(step, str) else f"edit {step['edit']}"


def _held(folder: Path) -> dict[str, bytes]:
    """The bytes of all files in the folder by name."""
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def _scrubbed(text: str, folder: Path) -> list[str]:
    """The lines of a text without paths of this machine, hashes, and what depends on the clock."""
    for path, by in ((folder, "."), (folder.parent, ".."), (ROOT, "REPOSITORY"), (ROOT.parent, "ABOVE")):
        text = text.replace(str(path), by)
    text = re.sub(r"\b[0-9a-f]{12,64}\b|\b[0-9A-F]{12,64}\b", "#", text.replace(kerfwise.__version__, "VERSION"))
    text = re.sub(r"\b\d+(\.\d+)?( s of (computing|work)| s by the clock)", r"…\2", text)
    text = re.sub(r" +\d+\.\d+ s(,? +)(at most )?\d+ MB", r" … s\1\2… MB", text)  # a run of a benchmark
    return [line.rstrip() for line in text.splitlines() if line.strip() and not NOT_SAID.search(line)]
