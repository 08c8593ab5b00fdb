"""A day, as job files have it: 2026-12-24."""

from __future__ import annotations

import datetime
import re
from dataclasses import dataclass
from typing import Any

import yaml

from kerfwise.rules.options.kind import OptionKind, Unfit, scalar_text

_WRITTEN = r"\d{4}-\d{2}-\d{2}"


@dataclass(frozen=True, slots=True)
class Day(OptionKind):
    """A day of the calendar: year, month and day, as in ISO 8601."""

    def read(self, node: yaml.Node) -> datetime.date:
        text = scalar_text(node, self).strip()
        if not re.fullmatch(_WRITTEN, text, re.ASCII):
            raise self.refuse(node)
        try:
            return datetime.date.fromisoformat(text)
        except ValueError as error:
            raise Unfit(f"there is no such day as {text}: {error}", node) from None

    def write(self, value: datetime.date) -> str:
        return value.isoformat()

    def schema(self) -> dict[str, Any]:
        return {"type": "string", "format": "date", "pattern": f"^{_WRITTEN}$"}

    def expected(self) -> str:
        return "a day such as 2026-12-24 (year-month-day)"
