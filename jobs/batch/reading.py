"""The nest of a piece and its profile, with all that its job file says."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from kerfwise.encoder.contents import is_file
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.shown import shown
from kerfwise.jobs.given import Given, Tell, common_cuts_not_made, drawn_nest, plant_of, tabs_not_left
from kerfwise.jobs.nest_job.asked import Asked, job_for, locked_for, profile_for
from kerfwise.rules.profile.placing import placing_notes
from kerfwise.rules.profile.profile import Profile

from .machines import Machine
from .piece import Piece


class Changed(Exception):
    """Something is not what it was when the piece was handed out."""


def expect_same(piece: Piece, key: str) -> None:
    """Refuse to go on where the files of a piece are not those that its key was made of."""
    if piece.key() != key:
        raise Changed("its file changed while it was planned, or is another one where it was planned")


def given_of(piece: Piece, tell: Tell) -> Given:
    """The nest and its profile, with what its job file says; told is what `solve` says on standard error."""
    job, last = job_for(piece.source, None), piece.last_plan
    if job is not None and job.machine is not None and piece.machine.is_called(job.machine):
        job = replace(job, machine=None)  # it is on the machine that it names
    named = None if job is None else job.profile_path
    if job is not None and named is not None and Path(named).resolve() == Path(piece.machine.profile).resolve():
        job = replace(job, profile=None)  # and so with the profile
    asked = Asked(_plant(piece.machine), last=last if is_file(last) else None)
    plant = profile_for(asked, job, tell)
    drawn = drawn_nest(piece.source, plant, repair=piece.options.repair)
    given = locked_for(plant.as_cut(drawn), piece.source, plant, asked, job, tell)
    for text in _notes(drawn, given):
        tell(text)
    return given


@lru_cache(maxsize=16)
def _plant(machine: Machine) -> Profile:
    """The profile of a machine, read once a process."""
    plant = plant_of(machine.profile, machine.trust)
    if plant.sha256 != machine.sha256:
        raise Changed(f"the profile {shown(machine.profile)} changed while the batch ran, or is another one there")
    return plant


def _notes(drawn: Nest, given: Given) -> Iterator[str]:
    """What a planner should know of the nest, as `solve` says it on standard error."""
    if drawn.reading is not None and drawn.reading.taken:
        yield f"note: {drawn.reading.short()}"
    yield from (f"{note.severity}: {note.text}" for note in given.profile.without_losses(drawn).notes)
    if cut_all_the_same := tabs_not_left(drawn, given.profile):
        yield f"warning: {cut_all_the_same}"
    yield from (f"warning: {text}" for text in placing_notes(given.nest, given.profile))
    yield from (f"note: {text}" for text in (*given.profile.chart_notes(), *given.profile.price_notes()))
    if told := common_cuts_not_made(given):
        yield f"note: {told}"
