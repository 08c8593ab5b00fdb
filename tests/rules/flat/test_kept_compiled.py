"""What MiniZinc has compiled is kept by content; a cache that is broken, foreign or out of reach is done without."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.pipeline import plan_nest, solve_and_verify
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.expression.node import order
from kerfwise.rules.flat import compiler, flatten
from kerfwise.rules.flat.compiler import Compiled, compiled_within, read_flatzinc
from kerfwise.rules.flat.flatten import cache_folder, compiled
from kerfwise.rules.flat.flatzinc_to_expr import Meaning, Words
from kerfwise.rules.flat.model_file import ModelFile, read_model_file
from kerfwise.rules.flat.model_rule import read_model_rule
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile

pytestmark = pytest.mark.minizinc

ROW = nest(300, 120, *(part(name, rect(10 + 90 * k, 20, 60, 60)) for k, name in enumerate("ABC")))
TEXT = "solve satisfy;\n"


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache" / "rules"
    monkeypatch.setattr(flatten, "cache_folder", lambda: folder)
    return folder


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The file of each run of MiniZinc's compiler."""
    made: list[Path] = []

    def compile_model(text: str, about: Path) -> Compiled:
        made.append(about)
        return compiler.compile_model(text, about)

    monkeypatch.setattr(flatten, "compile_model", compile_model)
    return made


def rule(folder: Path, text: str = "array[int] of bool: tried_holds = [true];\n") -> ModelFile:
    folder.mkdir(exist_ok=True)
    (folder / "tried.mzn").write_text(text)
    return read_model_file(folder / "tried.mzn")


def asking(file: ModelFile, more: str = "") -> str:
    return f"{flatten.include(file.path.resolve())}\n{more}var 1..3: x;\n{TEXT}"


def test_the_same_content_is_compiled_once_wherever_it_lies(tmp_path: Path, cache: Path, runs: list[Path]) -> None:
    one, other = rule(tmp_path / "one"), rule(tmp_path / "other")
    first = compiled(one, asking(one))
    assert compiled(one, asking(one)) == first
    assert compiled(other, asking(other)) == first
    assert len(runs) == 1
    assert len(list(cache.iterdir())) == 1


@pytest.mark.parametrize("change", ["data", "file", "included", "compiler", "words"])
def test_what_has_changed_is_compiled_anew(
    tmp_path: Path, cache: Path, runs: list[Path], change: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "beside.mzn").write_text("int: a = 1;\n")
    text = 'include "beside.mzn"; array[int] of bool: tried_holds = [true];\n'
    file, more = rule(tmp_path, text), ""
    compiled(file, asking(file))
    if change == "data":
        more = "int: b = 2;\n"
    elif change == "file":
        file = rule(tmp_path, f"{text}% more\n")
    elif change == "included":
        (tmp_path / "beside.mzn").write_text("int: a = 2;\n")
    else:
        flatten._maker.cache_clear()
        monkeypatch.setattr(flatten, "version_of", lambda program: "version 9.9.9")
    if change == "words":
        flatten._maker.cache_clear()
        monkeypatch.setattr(flatten, "_FACTS", Path("flat", "judged.mzn"))
    compiled(file, asking(file, more))
    assert len(runs) == 2
    flatten._maker.cache_clear()


@pytest.mark.parametrize("damage", ["empty", "cut short", "changed", "no content", "a folder"])
def test_a_broken_file_is_not_used(tmp_path: Path, cache: Path, runs: list[Path], damage: str) -> None:
    file = rule(tmp_path)
    wanted = compiled(file, asking(file))
    (kept,) = cache.iterdir()
    data = kept.read_bytes()
    if damage == "a folder":
        kept.unlink()
        kept.mkdir()
    else:
        kept.write_bytes(
            {"empty": b"", "cut short": data[:-3], "changed": data[:-3] + b"xyz", "no content": data[:64]}[damage]
        )
    assert compiled(file, asking(file)) == wanted
    assert len(runs) == 2
    if damage != "a folder":
        assert kept.read_bytes() == data


def test_a_sealed_file_that_says_something_else_is_not_used(tmp_path: Path, cache: Path, runs: list[Path]) -> None:
    file = rule(tmp_path)
    wanted = compiled(file, asking(file))
    (kept,) = cache.iterdir()
    maker = kept.read_bytes()[:32]
    flatten.write_sealed(kept, maker, b"not compressed")
    assert compiled(file, asking(file)) == wanted
    assert len(runs) == 2


def test_a_place_that_cannot_be_written_is_done_without(tmp_path: Path, cache: Path, runs: list[Path]) -> None:
    cache.parent.mkdir()
    cache.parent.joinpath("rules").write_text("a file where the folder would be")
    file = rule(tmp_path)
    assert compiled(file, asking(file)) == compiled(file, asking(file))
    assert len(runs) == 2


def test_no_place_at_all(tmp_path: Path, runs: list[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flatten, "cache_folder", lambda: None)
    file = rule(tmp_path)
    assert compiled(file, asking(file)) == compiled(file, asking(file))
    assert len(runs) == 2


def test_mistakes_are_not_kept(tmp_path: Path, cache: Path, runs: list[Path]) -> None:
    file = rule(tmp_path, "array[int] of bool: tried_holds = [nothing];\n")
    for _ in range(2):
        with pytest.raises(Exception, match="nothing"):
            compiled(file, asking(file))
    assert len(runs) == 2


def test_many_runs_at_once(tmp_path: Path, cache: Path) -> None:
    file = rule(tmp_path)
    with ThreadPoolExecutor(4) as pool:
        made = list(pool.map(lambda k: compiled(file, asking(file, f"int: b = {k % 2};\n")).flat, range(12)))
    assert set(made) == {made[0], made[1]}
    assert [path.suffix for path in cache.iterdir()] == [".flat", ".flat"]


def test_the_oldest_goes_first(tmp_path: Path, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flatten, "MOST_FILES", 2)
    file = rule(tmp_path)
    for k in range(3):
        compiled(file, asking(file, f"int: b = {k};\n"))
        for path in cache.iterdir():
            os.utime(path, (path.stat().st_mtime - 100,) * 2)
    monkeypatch.setattr(flatten, "compile_model", None)
    assert len(list(cache.iterdir())) == 2
    compiled(file, asking(file, "int: b = 1;\n"))
    compiled(file, asking(file, "int: b = 2;\n"))


def test_a_warm_cache_gives_the_same_bytes_without_compiling(tmp_path: Path, cache: Path, runs: list[Path]) -> None:
    (tmp_path / "last.mzn").write_text(
        "array[int] of var bool: last_holds = [before(3, 1), picked(1) -> before(2, 1)];\n"
    )
    (tmp_path / "plant.yaml").write_text("models: last.mzn\nrules: {level-ahead: off}\n")

    def made() -> str:
        flatten._kept.clear()
        profile = load_profile(tmp_path / "plant.yaml")
        done = solve_and_verify(make_request(facts_of(ROW, profile), profile), profile, SolveOptions(work=1.0))
        assert done.verdict.ok
        return done.plan.to_json() + done.program

    cold = made()
    count = len(runs)
    assert count >= 2  # what it states, and how it is judged
    assert made() == cold
    assert len(runs) == count


@pytest.mark.parametrize(
    ("given", "folder"),
    [({"XDG_CACHE_HOME": "/c"}, "/c/kerfwise/rules"), ({"HOME": "/h"}, "/h/.cache/kerfwise/rules")],
)
def test_the_place_is_the_users(given: dict[str, str], folder: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    for name, value in given.items():
        monkeypatch.setenv(name, value)
    assert cache_folder() == Path(folder)


def test_compiling_ends_within_the_limit(tmp_path: Path, cache: Path) -> None:
    """Three nested loops over 400 numbers take MiniZinc half a minute; the command has a second."""
    (tmp_path / "tried.mzn").write_text(
        "% tried: of three outer contours, the first is not cut last\n"
        "array[int] of var bool: tried_holds =\n"
        "  [before(1, 2) \\/ before(2, 3) \\/ i * j = k | i, j, k in 1..400];\n"
    )
    profile = load_profile_of(tmp_path, "models: [tried.mzn]\nrules: {tried: hard}\n")
    with pytest.raises(InputError, match=r"is not done after \d+\.\d s, which is all that the time limit leaves it"):
        plan_nest(Inputs(ROW, profile), SolveOptions(time_s=1.0))


def test_reading_ends_within_the_limit(tmp_path: Path, cache: Path) -> None:
    file = tmp_path / "tried.mzn"
    file.write_text("% tried: in a row\narray[int] of var bool: tried_holds = [before(1, 2), before(2, 3)];\n")
    rule, facts = read_model_rule(file), facts_of(ROW, load_profile())
    assert len(list(rule.statements(facts, rule.Options()))) == 2
    with compiled_within(-1.0), pytest.raises(InputError, match="is being read, and the time limit leaves no more"):
        list(rule.statements(replace(facts, zone=facts.zone.copy(), parent=facts.parent.copy()), rule.Options()))


FLAT = """var bool: ab;
var bool: ba:: is_defined_var;
array [1..1] of var bool: flat_before = [ab];
array [1..1] of var bool: tried_holds = [ba];
constraint bool_not(ab,ba):: defines_var(ba);
"""


def test_reading_ends_within_one_line_and_one_element() -> None:
    flat, about = read_flatzinc(FLAT), Path("tried.mzn")
    assert Meaning(flat, Words(2, ()), about).elements("tried_holds") == [order(1, 0)]
    with compiled_within(-1.0):
        with pytest.raises(InputError, match=r"tried\.mzn: what MiniZinc has made of this rule is being read"):
            read_flatzinc(FLAT, about)
        with pytest.raises(InputError, match=r"tried\.mzn: what MiniZinc has made of this rule is being read"):
            Meaning(flat, Words(2, ()), about).elements("tried_holds")


def load_profile_of(folder: Path, text: str) -> Profile:
    (folder / "plant.yaml").write_text(f"name: plant\nbased_on: plasma-carbon-steel\n{text}")
    return load_profile(str(folder / "plant.yaml"))
