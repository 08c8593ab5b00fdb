"""The search in a run: looks from scratch, the best of them gone on with, and windows of the plan at hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kerfwise.models.engines import setting_out, shares
from kerfwise.models.engines.ideals.windows import polish

from .run import Run

if TYPE_CHECKING:
    from kerfwise.models.engines.search import Searcher


class Searching:
    """The searcher that a run goes on with."""

    def __init__(self, run: Run) -> None:
        self._run = run
        self._searcher: Searcher | None = None

    def look(self, share: float, looks: int) -> None:
        """Searches from scratch, as one alone may be caught; that of the best plan is gone on with later."""
        from kerfwise.models.engines.search import Searcher  # what most small nests are proven without

        run = self._run
        best: Searcher | None = None
        for look in range(looks):
            known = run.known.incumbent
            self._searcher = Searcher(run.problem, run.options.seed + look * shares.SEEDS_APART) if look else None
            self.go_on(share / looks)
            if best is None or run.known.incumbent is not known:
                best = self._searcher
            if run.over():
                break
        self._searcher = best

    def go_on(self, share: float) -> None:
        """Search from where it stands, or from the plan of another member if that is the best."""
        from kerfwise.models.engines.search import Searcher

        run, known = self._run, self._run.known
        if self._searcher is None:
            self._searcher = Searcher(run.problem, run.options.seed)
            if known.incumbent is not None:
                self._searcher.stand_on(known.incumbent.route)
        elif known.incumbent is not None and known.found_by != "search":
            self._searcher.stand_on(known.incumbent.route)
        self._searcher.run(share, run.options.time_s and share, run.watch)
        known.offer(self._searcher.best, "search")
        known.work += share

    def windows(self, share: float) -> None:
        """Windows of the best plan in their best order."""
        run, known = self._run, self._run.known
        if known.incumbent is None or run.over() or setting_out.windows_s(run.problem) > share:
            return
        own = shares.WINDOWS_BYTES * run.most_bytes
        polished = polish(run.problem, known.incumbent, share, run.within(share), own)
        known.offer(polished.incumbent, "windows")
        known.work += polished.work
