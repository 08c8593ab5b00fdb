"""The judge shares no code with what it judges."""

from __future__ import annotations

import subprocess
import sys

JUDGE = ("simulate", "program", "drawing", "burns", "void", "erosion", "coverage", "stock", "pieces", "findings")


def loaded_by(*modules: str) -> set[str]:
    """Modules of the project that a new Python loads with these."""
    code = f"import sys, {', '.join(modules)}; print(*(m for m in sys.modules if m.startswith('kerfwise')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_the_simulation_loads_nothing_of_the_project() -> None:
    loaded = loaded_by(*(f"kerfwise.tests.metal.{name}" for name in JUDGE))
    assert {m for m in loaded if not m.startswith("kerfwise.tests.metal")} <= {"kerfwise", "kerfwise.tests"}


def test_a_shared_module_would_be_noticed() -> None:
    assert "kerfwise.encoder.geometry.offset" in loaded_by("kerfwise.encoder.geometry.offset")
