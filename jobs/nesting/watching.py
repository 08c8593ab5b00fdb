"""Who watches while parts are laid."""

from __future__ import annotations

from kerfwise.jobs.listening import OnCtrlC
from kerfwise.nesting.allot import Layout


class Watching(OnCtrlC):
    """Told after each round, and asked while sparrow packs; both say whether to go on, `stopped` that not.

    As a context it listens to Ctrl-C while parts are laid.
    """

    def __call__(self, number: int, best: Layout) -> bool:
        """After a round."""
        return not self.stopped

    def going(self, doing: str) -> bool:
        """While something else is done."""
        return not self.stopped
