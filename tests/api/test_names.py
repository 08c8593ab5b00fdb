"""What `import kerfwise` gives, and that it costs next to nothing until it is used."""

from __future__ import annotations

import subprocess
import sys
from importlib import import_module

import pytest

import kerfwise
from kerfwise import api

MOST_MODULES = 5
"""Of kerfwise itself and of the standard library, beyond what Python has loaded by itself."""


def run(script: str) -> str:
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return done.stdout.strip()


@pytest.mark.slow
def test_import_loads_next_to_nothing() -> None:
    script = (
        "import sys, typing, __future__\nbefore = set(sys.modules)\n"
        "import kerfwise\nkerfwise.__version__, dir(kerfwise)\n"
        "print(*sorted(set(sys.modules) - before))"
    )
    assert len(run(script).split()) <= MOST_MODULES
    used = script.replace("dir(kerfwise)", "kerfwise.read_nest")
    assert len(run(used).split()) > 100  # so that the count above can fail


def test_names_are_those_of_the_interface() -> None:
    of_apps = set(kerfwise.__all__) - {"__version__", *api.__all__}
    assert {"compare", "distort", "edit", "make", "nest", "resequence", "trade_off"} <= of_apps
    assert dir(kerfwise) == sorted(set(kerfwise.__all__)) == sorted(["__version__", *api.__all__, *of_apps])
    for name in api.__all__:
        assert getattr(kerfwise, name) is getattr(api, name)
    for name in of_apps:
        assert getattr(kerfwise, name).__module__.startswith("kerfwise.apps."), name
    assert all(getattr(kerfwise, name).__doc__ for name in (*api.__all__, *of_apps))


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'solv'"):
        kerfwise.solv  # type: ignore[attr-defined]  # noqa: B018


def test_subpackages_are_not_hidden() -> None:
    given = import_module("kerfwise.jobs.inputs")
    assert kerfwise.jobs.inputs is given  # type: ignore[attr-defined]
