"""What goes for every test.

Every program that a test has planned is burnt by the simulation of `metal` before the test is done. A test that needs
LinuxCNC's interpreter or MiniZinc says so by its marker. Processes that share the tests find kernels compiled.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise import Nest, Plan, Profile
from kerfwise import pipeline as production
from kerfwise.encoder import progress_notice
from kerfwise.models.jit import take_plainly
from kerfwise.postproc.dialects import Dialect, load_dialect
from kerfwise.rules.flat import flatten
from kerfwise.tests.metal.coverage import Tabs
from kerfwise.tests.metal.layers import simulate_layers
from kerfwise.tests.metal.plant import plant, tabs_of
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.tools.amount import register_profiles
from kerfwise.tests.tools.needed import LEFT_OUT, WITHOUT, keep_from
from kerfwise.tests.tools.outside.mapped import in_linuxcnc

ROOT = Path(__file__).parents[1]
LONGEST = {"test_installing.py", "test_plates.py", "test_batch.py", "test_tutorial_planner.py"}
"""Files with a test that takes a quarter of a minute or more in one process: begun last, it would be waited for."""
Made = list[tuple[Nest, Profile, Dialect, str, str | None, Plan]]


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--all` runs what takes long as well."""
    parser.addoption("--all", action="store_true", dest="everything", help="run tests marked full, and all examples")


def pytest_configure(config: pytest.Config) -> None:
    """What Python compiles is kept, for the next run too and for the commands that tests run as processes.

    Kernels are compiled, whatever runs first; how they run as plain Python has tests of its own.
    """
    register_profiles(config.option.everything)
    take_plainly(0)
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes() -> None:
    """Kernels are compiled once, before the processes that run the tests start: each would compile all of them."""
    if "KERNELS_ARE_COMPILED" not in os.environ:
        subprocess.run([sys.executable, "-m", "kerfwise.tests.tools.kernels"], cwd=ROOT.parent, check=False)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave tests marked full out, unless somebody asks for them; begin with what takes longest in one process."""
    named = any("::" in argument for argument in config.args)
    if not (config.option.everything or named or "full" in config.option.markexpr):
        left_out = [item for item in items if item.get_closest_marker("full") is not None]
        items[:] = [item for item in items if item.get_closest_marker("full") is None]
        config.hook.pytest_deselected(items=left_out)
    items.sort(key=lambda item: item.path.name not in LONGEST)


def pytest_runtest_setup(item: pytest.Item) -> None:
    """A test whose program is missing fails, in one line that says how to get it."""
    for marker, without in WITHOUT.items():
        if item.get_closest_marker(marker) is not None and (how := without()):
            pytest.fail(how, pytrace=False)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """What is missing is said once more at the end, however many tests failed for it."""
    texts = {report.longreprtext for report in terminalreporter.stats.get("error", [])}
    for text in sorted(texts):
        if text.endswith(LEFT_OUT):
            terminalreporter.write_line(text, red=True)


@pytest.fixture(autouse=True)
def only_marked_tests_use_programs(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """LinuxCNC and MiniZinc are there for tests with their marker, so that `-m` leaves out all that need them."""
    for marker in WITHOUT:
        if request.node.get_closest_marker(marker) is None:
            keep_from(marker, monkeypatch)


@pytest.fixture(scope="session")
def compiled_rules(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the tests of one process keep what MiniZinc has compiled."""
    return tmp_path_factory.mktemp("compiled")


@pytest.fixture(autouse=True)
def nothing_kept_from_elsewhere(compiled_rules: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No test finds what the user's own runs have compiled."""
    monkeypatch.setattr(flatten, "cache_folder", lambda: compiled_rules)


@pytest.fixture(autouse=True)
def nothing_takes_long(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a test sees on standard error does not depend on how busy the machine is."""
    monkeypatch.setattr(progress_notice, "AFTER_S", 1e6)


@pytest.fixture(autouse=True)
def programs_made(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Made]:
    """What the test plans, by the command line or by itself; `@pytest.mark.scrap("why")` lets a test make scrap."""
    made: Made = []
    write = production.write_program

    def noted(plan: Plan, nest: Nest, profile: Profile) -> str:
        program = write(plan, nest, profile)
        profile = profile.at_spacing(plan.sequence().spacing_mm(profile.machine.torches.axis))
        old = write(before(plan), nest, profile) if plan.already_cut else None
        made.append((nest, profile, load_dialect(profile.machine.dialect), program, old, plan))
        return program

    monkeypatch.setattr(production, "write_program", noted)
    yield made
    if request.node.get_closest_marker("scrap") is None:
        found = [str(f) for *one, plan in made for f in judged(*one, tabs_of(plan))]
        assert not found, "this would make scrap:\n" + "\n".join(found)


def before(plan: Plan) -> Plan:
    """What was cut before a program that goes on after a stop, as a plan of its own."""
    return replace(plan, cuts=plan.already_cut, already_cut=(), broken_off=None)


def judged(
    nest: Nest, profile: Profile, dialect: Dialect, program: str, old: str | None = None, tabs: Tabs | None = None
) -> list[object]:
    """The findings of a program, which may go on after an `old` one; without a kerf nothing is burnt.

    The simulation reads LinuxCNC's words: a program for another control is spelt in these first.
    """
    if profile.material.kerf_mm <= 0:
        return []
    if any(contour.bevelled for contour in (nest.drawn or nest).contours):
        return list(simulate_layers(nest, program, profile))
    program = in_linuxcnc(program, dialect.control, dialect.name)
    more = {} if old is None else {"before": in_linuxcnc(old, dialect.control, dialect.name)}
    return [*simulate(profile.as_cut(nest), program, tabs=tabs, **plant(profile), **more)]
