"""Where each value of a profile comes from: a line of a file, a row of a material chart, or nobody has said it."""

from __future__ import annotations

from collections.abc import Iterator

from kerfwise.rules.charts.columns import COLUMNS

from .chart_use import Taken
from .profile import Profile


class Sources:
    """Where the values of a profile come from, by such as `machine.home` and `rules.pierce`."""

    def __init__(self, profile: Profile) -> None:
        self._profile = profile
        taken = profile.chart.taken if profile.chart is not None else ()
        self._charted = {".".join(COLUMNS[one.column].key): one for one in taken}

    def of(self, key: str) -> str:
        """Where a key has its value from, as a person reads it."""
        if key in self._charted:
            return self._row(self._charted[key])
        return self._profile.said_at.get(key, "default")

    def says(self, key: str) -> bool:
        """Whether a chart or a file, or the command line, gives a key."""
        return key in self._charted or key in self._profile.said_at

    def charted(self) -> Iterator[str]:
        """A sentence for each value that the chart has given."""
        for key, one in self._charted.items():
            yield f"{key}: {one.text}, {self._row(one)}"

    def _row(self, one: Taken) -> str:
        assert self._profile.chart is not None
        lines = " and ".join(map(str, one.lines))
        between = f", between {' and '.join(one.between)}" if one.between else ""
        return f"{self._profile.chart.file}:{lines}{between}"
