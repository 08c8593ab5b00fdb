"""The Python interface: what `import kerfwise` gives. Apps add their own functions to it.

A nest is planned in three lines:

>>> import kerfwise
>>> result = kerfwise.solve("examples/nests/e1x_6.json", "plasma-carbon-steel", work=2)  # doctest: +SKIP
>>> paths = result.save("out")  # doctest: +SKIP

Nests and profiles are objects, or what they are read from: the path of a nest, the name of a shipped profile, the path
of a plant's own. Lengths are mm, times s, temperatures °C, speeds mm/s.

Threads: functions and what they return keep no state of their own and may be used by several threads at once. `solve`
takes Ctrl-C in the main thread only; in another thread, return False from `on_progress` to stop it. Each plan uses
two threads by itself: to plan many nests at once, use processes rather than threads.
"""

from __future__ import annotations

from kerfwise.encoder.errors import InputError, KerfwiseError, RulesConflict
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import Questions
from kerfwise.jobs.display import Picture
from kerfwise.jobs.nest_job import Job
from kerfwise.jobs.programs import Times
from kerfwise.jobs.progress import Reached
from kerfwise.jobs.request import NoPlan
from kerfwise.jobs.result import Result
from kerfwise.models.plan.conflict import Conflict
from kerfwise.models.plan.explain.explain import Explanation
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.profile import Profile

from .judging import check, draw, explain, times
from .planning import conflict, facts, solve
from .reading import load_profile, read_job, read_nest, read_plan

__all__ = [
    "CheckResult",
    "Conflict",
    "Explanation",
    "InputError",
    "Job",
    "KerfwiseError",
    "Lock",
    "Nest",
    "NoPlan",
    "Picture",
    "Plan",
    "Profile",
    "Questions",
    "Reached",
    "Result",
    "RulesConflict",
    "Times",
    "check",
    "conflict",
    "draw",
    "explain",
    "facts",
    "load_profile",
    "read_job",
    "read_nest",
    "read_plan",
    "solve",
    "times",
]
