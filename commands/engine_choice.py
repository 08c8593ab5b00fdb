"""Engines on the command line: by their names, and by the names that they had before."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import click

from kerfwise.models.engines.names import ENGINES, OLD_NAMES, Engine


class EngineChoice(click.Choice[Any]):
    """One of `engines`; an old name is read as the new one, and not listed."""

    def __init__(self, engines: Iterable[Engine] = ENGINES) -> None:
        super().__init__(list(engines))

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The engine's name of today, or a usage error."""
        return super().convert(OLD_NAMES.get(value, value), param, ctx)
