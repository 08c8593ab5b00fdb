"""`kerfwise.resequence`: an old program in a better order."""

from __future__ import annotations

from pathlib import Path

from kerfwise.apps.resequence.resequence import resequence as resequenced
from kerfwise.apps.resequence.result import Paths, Resequenced
from kerfwise.jobs.inputs import ProfileLike
from kerfwise.jobs.programs import ProgramRequest
from kerfwise.jobs.progress import Listener, OnProgress
from kerfwise.models.engines.tuning import REQUEST_WORK as WORK
from kerfwise.rules.profile.load import DEFAULT


def resequence(
    program: str | Path,
    profile: ProfileLike = DEFAULT,
    *,
    paths: Paths = "keep",
    without_rules: bool = False,
    feed_mm_min: float | None = None,
    kerf_mm: float | None = None,
    sheet_mm: tuple[float, float] | None = None,
    time_s: float | None = None,
    work: float = WORK,
    seed: int = 1,
    on_progress: OnProgress | None = None,
) -> Resequenced:
    """Put the burns of an old NC program into the best order by the profile's rules, each burn as it is.

    Parts, holes, links and tabs are told from the burns alone. Nothing is written: see `Resequenced.save`.

    Parameters
    ----------
    program
        The path of the program.
    profile
        A profile, its name or its path; its dialect says which control the program is for.
    paths
        "keep" leaves every burn as it is; "new" plans all contours afresh, with entries and leads of our own.
    without_rules
        Where nobody can tell what some burns cut, go on by travel alone; `ends` then says that no rule was asked.
    feed_mm_min, kerf_mm, sheet_mm
        What the program leaves to the machine: the feed of its material, mm/min, the kerf, mm, width and height of the
        sheet, mm.
    time_s, work, seed, on_progress
        As for `solve`.

    Returns
    -------
    Resequenced
        `program`, `before` and `after` with idle travel, time and verdicts, `ends`; print it to read it.

    Raises
    ------
    InputError
        With file and line, for what cannot be read, or nobody can be sure of, and where the rules cannot be asked.
    RulesConflict
        If contours are planned afresh, and no plan keeps the hard rules.

    Examples
    --------
    >>> import tempfile, kerfwise
    >>> some = kerfwise.solve("examples/nests/e1x_6.json", strategy="random", work=2)
    >>> old = some.save(tempfile.mkdtemp(), "old")[0]
    >>> better = kerfwise.resequence(old, sheet_mm=(700, 300), work=2)
    >>> better.after.idle_mm < better.before.idle_mm, better.after.verdict.ok
    (True, True)
    >>> better.save(old.with_name("better.nc")).name
    'better.nc'
    """
    request = ProgramRequest(feed_mm_min, kerf_mm, sheet_mm)
    return resequenced(
        program, profile, Listener(on_progress), paths=paths, request=request, without_rules=without_rules,
        work=work, time_s=time_s, seed=seed,
    )  # fmt: skip
