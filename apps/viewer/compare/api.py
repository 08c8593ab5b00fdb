"""`kerfwise.compare`: two plans side by side."""

from __future__ import annotations

from collections.abc import Iterable

from kerfwise.api.reading import LockLike, PlanOrResult, Settings, nest_request, plan_or_path
from kerfwise.apps.viewer.compare import Comparison, SideAsked, expect_two, pair_of, side_of
from kerfwise.apps.viewer.compare import compare as compared
from kerfwise.apps.viewer.compare.sides import Side
from kerfwise.jobs.inputs import NestLike, ProfileLike
from kerfwise.jobs.nest_job.request import JobLike, inputs_for
from kerfwise.jobs.progress import Listener, OnProgress
from kerfwise.jobs.request import NoPlan
from kerfwise.models.engines.solution import Limits
from kerfwise.models.engines.tuning import REQUEST_WORK as WORK


def compare(
    nest: NestLike,
    a: PlanOrResult | None = None,
    b: PlanOrResult | None = None,
    profile: ProfileLike | None = None,
    profile_b: ProfileLike | None = None,
    *,
    with_: Iterable[str] | str = (),
    without: Iterable[str] | str = (),
    heat: bool = False,
    locks: Iterable[LockLike] | LockLike = (),
    job: JobLike = None,
    settings: Settings = (),
    time_s: float | None = None,
    work: float = WORK,
    seed: int = 1,
    relax: bool = False,
    on_progress: OnProgress | None = None,
) -> Comparison:
    """Put two ways to cut a nest side by side: figures, what each rule costs, which cuts differ, both routes.

    Parameters
    ----------
    nest
        A nest, or the path of its file.
    a, b
        Plans, results, or the paths of plans (.json) or of NC programs. What is None is planned now.
    profile, profile_b
        Profiles, names or paths: that of A, or of both, and that of B. None as for `solve`.
    with_, without
        Rules that B is planned with, such as "t-max" or "hull-before=soft", and without.
    heat
        Simulate how hot both make the sheet.
    locks, job, settings, time_s, work, seed, relax, on_progress
        As for `solve`, for both; limits are those of each plan.

    Returns
    -------
    Comparison
        `figures`, `rules`, `changed`, `claim`; print it to read it; `picture()`, `save(…)`, `as_json()`.

    Raises
    ------
    InputError
        If something given cannot be used, or a plan or program is of another nest.
    NoPlan
        If a side is to be planned, and no plan keeps the hard rules: a note of the error says which side.
    KeyboardInterrupt
        If Ctrl-C was pressed before there was a plan.

    Examples
    --------
    >>> import kerfwise
    >>> made = kerfwise.compare("examples/nests/e1x_6.json", without="level-ahead", work=2)
    >>> [figure.texts for figure in made.figures if figure.key == "idle_mm"]
    [('1.873 m', '1.682 m', '-10.2%')]
    >>> made.a.plan.solve.status, made.b.verdict.ok, [pair.told for pair in made.changed][0]
    ('optimal', True, 'moved, entry 32.6 mm away')
    """
    on, off = _listed(with_), _listed(without)
    first, second = (None if side is None else plan_or_path(side) for side in (a, b))
    profiles = [profile] if profile_b is None else [profile, profile_b]
    expect_two(first, second, len(profiles), on, off)
    notes: list[str] = []
    inputs = [inputs_for(nest, nest_request(one, job, settings, locks, a), notes.append) for one in profiles]
    limits: Limits = {"work": work, "seed": seed, "time_s": time_s}
    of_a, of_b = pair_of((inputs[0], inputs[-1]), first, second, on, off, limits, relax)
    side_a, side_b = _side("A", of_a, heat, on_progress, notes), _side("B", of_b, heat, on_progress, notes)
    return compared(side_a, side_b, notes=tuple(dict.fromkeys(notes)))


def _side(letter: str, request: SideAsked, heat: bool, on_progress: OnProgress | None, notes: list[str]) -> Side:
    listener = Listener(on_progress)
    try:
        return side_of(request, heat, listener, lambda text: notes.append(f"{letter}: {text}"))
    except NoPlan as error:
        if listener.interrupted:
            raise KeyboardInterrupt from None
        error.add_note(f"{letter}: {request.name}")
        raise


def _listed(names: Iterable[str] | str) -> list[str]:
    return [names] if isinstance(names, str) else list(names)
