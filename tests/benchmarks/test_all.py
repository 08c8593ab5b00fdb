"""Every benchmark can be begun: each name that it takes from the project is there."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

from kerfwise import benchmarks


@pytest.mark.parametrize("name", sorted(path.stem for path in Path(benchmarks.__path__[0]).glob("*.py")))
def test_it_can_be_imported(name: str) -> None:
    importlib.import_module(f"{benchmarks.__name__}.{name}")
