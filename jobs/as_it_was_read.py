"""How a nest was read when its plan or program was made, so that nobody has to say it again."""

from __future__ import annotations

import re
from pathlib import Path

from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.nc.program import ARCS_REFITTED
from kerfwise.rules.profile.profile import Profile

from .given import Tell

_HEAD_BYTES = 4000
_SAID = re.compile(rf'"refit_arcs_mm": "([0-9.]+)"|{ARCS_REFITTED} ([0-9.]+) MM', re.IGNORECASE)


def refit_said(made: Plan | str | Path | None) -> float | None:
    """How near to flattened outlines a plan, or the head of its file or program, says that arcs were made, mm.

    None where it says nothing, and for a file that cannot be read, which whoever reads it whole says.
    """
    if isinstance(made, Plan):
        said = made.nest.get("refit_arcs_mm")
        return None if said is None else float(said)
    if made is None:
        return None
    try:
        with Path(made).open("rb") as file:
            found = _SAID.search(file.read(_HEAD_BYTES).decode("utf-8", "replace"))
        return None if found is None else float(found[1] or found[2])
    except (OSError, ValueError):
        return None


def refit_as_made(given_mm: float | None, made: Plan | str | Path | None, profile: Profile, tell: Tell) -> float | None:
    """How near to flattened outlines arcs are made: as is given, or as what was made of the nest says.

    That is told where it goes before the profile, and so is what is given where the other does not say the same. None
    where neither says it: the profile's section `drawing` does then.
    """
    if made is None:
        return given_mm
    said_mm, name = refit_said(made), "the plan" if isinstance(made, Plan) else Path(str(made)).name
    if given_mm is not None:
        if said_mm is None:
            tell(f"arcs are refitted within {given_mm:g} mm (--refit-arcs); {name} does not say that they were for it")
        elif f"{given_mm:.9g}" != f"{said_mm:.9g}":
            tell(f"arcs are refitted within {given_mm:g} mm (--refit-arcs); for {name} they were within {said_mm:g} mm")
        return given_mm
    if said_mm is None or said_mm == profile.drawing.refit_arcs_mm:
        return None
    tell(f"arcs are refitted within {said_mm:g} mm (--refit-arcs), as they were for {name}")
    return said_mm
