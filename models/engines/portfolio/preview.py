"""A first plan to be shown while sets are counted; no engine goes on from it."""

from __future__ import annotations

from kerfwise.models.engines import shares
from kerfwise.models.engines.solution import Incumbent

from .run import Run


class Preview:
    """`plan` is what was shown, if that was worth it."""

    def __init__(self, run: Run) -> None:
        self._run = run
        self._done = False
        self.plan: Incumbent | None = None

    def counting(self, entries: int) -> bool:
        """Whether to go on counting; where it takes long, there is a first plan to be shown."""
        run = self._run
        few = entries < shares.PREVIEW_AFTER_ENTRIES or run.problem.n > shares.PREVIEW_MOST_CONTOURS
        if not (few or self._done or run.options.member):
            self._show()
        return run.watch("ideals", None, None)

    def _show(self) -> None:
        from kerfwise.models.engines.search import Searcher

        run, self._done = self._run, True
        searcher = Searcher(run.problem, run.options.seed)
        searcher.run(shares.PREVIEW_WORK, run.options.time_s and shares.PREVIEW_WORK, run.watch.preview)
        self.plan = searcher.best
