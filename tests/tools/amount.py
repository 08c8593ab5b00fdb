"""How much of a family of tests runs: a small part by default, all of it with `pytest --all`.

A test marked `full` is left out unless `--all` or `-m` asks for it, or it is named on the command line. What it shows
is shown by a smaller test too, which always runs.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from hypothesis.database import DirectoryBasedExampleDatabase

ROOT = Path(__file__).parents[2]
SHARE = 10
"""One example of this many is drawn by default."""
FEWEST = 3


def register_profiles(everything: bool) -> None:
    """Properties draw fewer examples by default than with `--all`; what has failed is kept, and tried first.

    No example has a deadline, which would depend on the load of the machine.
    """
    kept = DirectoryBasedExampleDatabase(ROOT / ".hypothesis" / "examples")
    settings.register_profile("all", deadline=None, database=kept, print_blob=True, max_examples=100)
    settings.register_profile("few", settings.get_profile("all"), max_examples=100 // SHARE)
    settings.load_profile("all" if everything else "few")


def share_of(count: int) -> int:
    """`count` with `--all`, and a tenth of it otherwise."""
    share = settings.get_profile("all").max_examples // settings().max_examples
    return max(count // share, min(count, FEWEST))


def examples(count: int, **more: Any) -> settings:
    """Settings of a property that draws `count` examples with `--all`, and a tenth of them otherwise."""
    return settings(max_examples=share_of(count), **more)


def full(*values: Any) -> Any:
    """A row of `pytest.mark.parametrize` that runs with `--all` only."""
    if len(values) == 1 and isinstance(values[0], type(pytest.param())):
        (row,) = values
        return pytest.param(*row.values, id=row.id, marks=[*row.marks, pytest.mark.full])
    return pytest.param(*values, marks=pytest.mark.full)


def few(values: Iterable[Any], count: int = 1) -> list[Any]:
    """One parameter's values: the first `count` run always, the others with `--all` only."""
    return [value if n < count else full(value) for n, value in enumerate(values)]


def rows(values: Iterable[Iterable[Any]], count: int = 1) -> list[Any]:
    """Several parameters' values, row by row: the first `count` rows run always, the others with `--all` only."""
    return [pytest.param(*row) if n < count else full(*row) for n, row in enumerate(values)]
