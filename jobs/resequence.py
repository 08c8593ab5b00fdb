"""An old program in a better order: its burns as they are, or its contours planned afresh."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.models.engines.names import Engine
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.postproc.check.reader.on_machine import read_on_machine
from kerfwise.rules.profile.load import DEFAULT

from .best_order import in_best_order
from .given import Given, ProfileLike, Tell, plant_of, silent
from .judged_side import judged_by_side
from .listening import Listener
from .main_job import plan_nest
from .new_order import broken_more, no_better, stays
from .old_program import Asked, OldJob, read_old_job
from .resequenced import Measured, Paths, Resequenced
from .solve_options import options_for

_TOLD = 3


def resequence(
    path: str | Path,
    profile: ProfileLike = DEFAULT,
    *,
    paths: Paths = "keep",
    asked: Asked | None = None,
    without_rules: bool = False,
    work: float = 30.0,
    time_s: float | None = None,
    seed: int = 1,
    engine: Engine = "portfolio",
    listener: Listener | None = None,
    tell: Tell = silent,
) -> Resequenced:
    """Put an old program's burns into the best order, or plan its contours afresh.

    Parameters
    ----------
    path
        File of the program.
    profile
        The plant; its dialect says which control the program is for.
    paths
        "keep" leaves every burn as it is, "new" makes leads and entries new.
    asked
        What the program does not say.
    without_rules
        Go on by travel alone where the rules cannot be asked, since nobody can tell what the burns cut. With "new"
        there is nothing to go on with.
    work, time_s, seed, engine
        As for a plan of a nest.
    listener
        Listens while the plan is made.
    tell
        Told what the user should know.

    Raises
    ------
    InputError
        With file and line, for what cannot be read, or what nobody can be sure of.
    RulesConflict
        If contours are planned afresh, and no plan keeps the hard rules.
    """
    plant, listener = plant_of(profile), listener or Listener()
    job = read_old_job(path, plant, asked, afresh=paths == "new", tell=tell)
    if (hole := next((burn for burn in job.program.burns if burn.pierces_only), None)) is not None:
        raise InputError(
            "the torch is lit here and does not move, as in a pierce pass: in another order cuts could come before "
            "their holes; such a program keeps its order",
            file=job.name,
            line=hole.line,
        )
    if job.told is not None:
        limits = options_for(job.told.nest, job.profile, work=work, seed=seed, time_s=time_s, engine=engine)
    else:
        limits = SolveOptions(seed, work, time_s)
    if paths == "new":
        return _afresh(job, limits, engine, listener, tell)
    return in_best_order(job, limits, listener, tell, without_rules)


def _afresh(job: OldJob, limits: SolveOptions, engine: Engine, listener: Listener, tell: Tell) -> Resequenced:
    nest = job.nest
    job, verdict = judged_by_side(job, nest, job.text, tell)
    before = Measured.of(job.program, job.profile, nest, verdict)
    done = plan_nest(Given(job.profile.as_cut(nest), job.profile), limits, engine=engine, listener=listener, tell=tell)
    made = done.made
    if not made.verdict.ok:
        broken = (made.verdict.rule(name) for name in made.verdict.broken())
        reasons = tuple(f"{j.id}: {v.text}" for j in broken for v in j.violations[:_TOLD])
        raise RulesConflict(f"{job.name}: the check refuses the new plan; nothing is written", reasons)
    after = Measured.of(read_on_machine(made.program, nest, job.profile), job.profile, nest, made.verdict)
    proven = made.plan.solve.status == "optimal"
    ends = "proven: no plan is better within these zones and entries" if proven else "found, not proven"
    mended = broken_more(before.verdict, after.verdict)
    if (worse := no_better(before, after, job.profile)) and not mended:
        ends = f"the old program stays: planned afresh it is no better ({worse})"
        return replace(stays(job, before, nest, False, ends, listener), paths="new")
    if worse:
        ends += f"; it is no better otherwise ({worse}), but the old program breaks {', '.join(mended)}"
    notes = list(job.notes)
    extra = next((line.line for line in job.old.lines if "material" in line.state or "tool" in line.state), None)
    if extra is not None:
        notes.append(
            f"line {extra}: what the program chooses on the machine (material, tool) is not in the new program, which "
            "is written for the profile"
        )
        tell(notes[-1])
    old = stays(job, before, nest, proven, ends, listener)
    return replace(old, paths="new", program=made.program, after=after, plan=made.plan, notes=tuple(notes))
