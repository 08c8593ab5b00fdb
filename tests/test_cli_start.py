"""The command line answers at once: nothing heavy is imported for help."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import kerfwise

NEST = Path(kerfwise.__file__).parent / "examples" / "nests" / "e1x_6.json"
UNNEEDED = (
    *("scipy", "ortools", "matplotlib", "ezdxf", "urllib.request"),
    *(f"kerfwise.{name}" for name in ("models.engines.search", "rules.flat.flatten", "postproc.nc.reordered_svg")),
    *(f"kerfwise.{name}" for name in ("rules.flat.model_rule", "jobs.first_plan", "jobs.process_pool")),
    *(
        f"kerfwise.{name}"
        for name in ("encoder.bevels.room", "encoder.candidates.lead_errors", "models.plan.explain.explain")
    ),
)
HEAVY = ("numpy", "shapely", "numba", "ortools", "matplotlib", "ezdxf", "svgelements", "scipy", "rich", "yaml")


def test_help_imports_nothing_heavy() -> None:
    script = (
        "import sys\n"
        "from kerfwise.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit as end: assert end.code == 0, end.code\n"
        f"print([m for m in {HEAVY!r} if m in sys.modules], file=sys.stderr)\n"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "solve" in run.stdout
    assert run.stderr.strip() == "[]"


@pytest.mark.slow
def test_a_small_solve_imports_no_more_than_it_uses(tmp_path: Path) -> None:
    """What it has no use for takes longer to import than it takes to plan."""
    script = (
        "import sys\n"
        "from kerfwise.cli import main\n"
        f"try: main(['solve', {str(NEST)!r}])\n"
        "except SystemExit as end: assert not end.code, end.code\n"
        f"print('unneeded', [m for m in {UNNEEDED!r} if m in sys.modules], 'kerfwise.postproc.report' in sys.modules)\n"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, cwd=tmp_path)
    assert run.stdout.splitlines()[-1] == "unneeded [] True"


@pytest.mark.parametrize("module", ["kerfwise", "kerfwise.cli"])
def test_python_m_is_the_command_line(module: str) -> None:
    asked = [sys.executable, "-m", module]
    version = subprocess.run([*asked, "--version"], capture_output=True, text=True)
    assert (version.returncode, version.stdout) == (0, f"kerfwise, version {kerfwise.__version__}\n")
    wrong = subprocess.run([*asked, "solv"], capture_output=True, text=True)
    assert wrong.returncode == 2
    assert "unknown verb 'solv': did you mean 'solve'?" in wrong.stderr


def test_at_the_end_handlers_of_before_run_and_python_looks_for_no_circles() -> None:
    script = (
        "import atexit, gc, sys\n"
        "from kerfwise import cli\n"
        "atexit.register(lambda: print('told at exit', gc.get_count()[0] < gc.get_freeze_count()))\n"
        "sys.argv = ['kerfwise', '--version']\n"
        "cli.run()\n"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.splitlines()[1:] == ["told at exit True"]
