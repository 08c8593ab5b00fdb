"""Work of a batch that kills its own process."""

from __future__ import annotations

import os
import signal

from kerfwise.apps.batch import run
from kerfwise.apps.batch.run import TaskOutput


def dies_at_one(task: run.Task) -> TaskOutput:
    """Plan what is asked for, unless it is the nest `one`."""
    if task.piece.name == "one":
        os.kill(os.getpid(), signal.SIGKILL)
    return run.plan_task(task)
