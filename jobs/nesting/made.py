"""From nests to programs, sheet by sheet: planned, repaired where that is needed, judged."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from kerfwise.encoder.errors import RulesConflict
from kerfwise.jobs.listening import Listener, Listeners
from kerfwise.jobs.main_job import Finished
from kerfwise.rules.profile.profile import Profile

from .files import nest_files
from .programs import plan_text, program_files
from .repair import planned
from .run import Nested


@dataclass(frozen=True, eq=False, slots=True)
class Made:
    """The nests as they are cut, the plan of each, a line for each and for what was repaired."""

    nested: Nested
    plans: tuple[Finished, ...]
    told: tuple[str, ...]
    interrupted: bool

    def files(self, dxf: bool) -> dict[str, str | bytes]:
        """Nests, programs, plans, pictures and remnants, by the names that they have."""
        files = nest_files(self.nested, ".nest.svg", dxf)
        for name, done in zip(self.nested.names, self.plans, strict=True):
            files |= program_files(name, done)
        return files


def made_of(nested: Nested, profile: Profile, work: float, relax: bool, listener: Callable[[str], Listener]) -> Made:
    """Plan every sheet as `kerfwise solve` would plan it.

    Raises
    ------
    InputError, RulesConflict
        If a sheet has no plan, not even with its parts moved apart: `RulesConflict` names the sheet.
    """
    heard = Listeners(listener)
    plans: list[Finished] = []
    told: list[str] = []
    for number, name in enumerate(nested.names):
        try:
            nested, done, how = planned(nested, number, profile, work, heard, relax)
        except RulesConflict as error:
            raise RulesConflict(f"{name}: {error.message}; nothing was written", error.reasons) from error
        plans.append(done)
        told += [plan_text(name, done), *([how] if how else [])]
    return Made(nested, tuple(plans), tuple(told), heard.interrupted)
