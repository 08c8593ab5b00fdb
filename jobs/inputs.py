"""What a job is given: a nest and the profile it is to be cut by, as files, names or objects."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import shapely

from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import read_named
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.narrow_features import cut_across, lost_walls
from kerfwise.encoder.nest import QUANTITY_KEY, Nest, Part
from kerfwise.encoder.small_holes import diameter_under
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.nc.program import ARCS_REFITTED
from kerfwise.rules.options.yaml_positions import wrong_at
from kerfwise.rules.profile.load import DEFAULT, load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.profile_yaml import where_said

if TYPE_CHECKING:
    from kerfwise.encoder.readers.options import FrameName, ReadOptions
    from kerfwise.jobs.nest_job.job import Job
    from kerfwise.postproc.check.reader.program import NcProgram
    from kerfwise.postproc.check.reader.read_program import Trusted


NestLike = Nest | str | Path
"""A nest, or the path of its file."""
ProfileLike = Profile | str | Path
"""A profile, the name of a shipped one, or the path of its file."""
Tell = Callable[[str], None]
"""Called with a sentence that the user should read while a job runs."""
MOST_NAMED = 8
"""So many contours are named in a sentence."""


def silent(text: str) -> None:
    """Tells nobody."""


@dataclass(frozen=True, slots=True)
class Inputs:
    """A nest, as the profile has it cut, the profile, and its job file, if one was read."""

    nest: Nest
    profile: Profile
    job: Job | None = None


def plant_of(profile: ProfileLike = DEFAULT, trust: bool = False) -> Profile:
    """The profile itself, the shipped one of that name, or the one in that file; see `load_profile` for `trust`.

    Raises InputError if there is none (with the nearest name), or it is wrong anywhere: with file, line and column.
    """
    if isinstance(profile, Profile):
        return profile
    return load_profile(_path("profile", profile, "a Profile, a name or a path"), trust=trust)


@dataclass(frozen=True, slots=True)
class DrawingSaid:
    """What is said of how a nest's file is read; for what is None, the profile's section `drawing` holds."""

    units: str | None = None
    sheet_mm: tuple[float, float] | None = None
    frame: FrameName | None = None
    repair: bool = False
    refit_arcs_mm: float | None = None


NOTHING_SAID = DrawingSaid()


def drawn_nest(nest: NestLike, profile: Profile, said: DrawingSaid = NOTHING_SAID) -> Nest:
    """The nest as it is drawn, read as the profile's section `drawing` and what is said beside it have it.

    Raises InputError if the file cannot be read, or what it holds cannot be cut.
    """
    if isinstance(nest, Nest):
        return nest
    from kerfwise.encoder.readers import read_nest

    return read_nest(_path("nest", nest, "a Nest or a path"), reading(profile, said))


def reading(profile: Profile, said: DrawingSaid = NOTHING_SAID) -> ReadOptions:
    """How a nest file is read: as the profile's section `drawing` and what is said beside it have it."""
    options = profile.read_options()
    return replace(
        options,
        units=said.units or options.units,
        units_by_profile=options.units_by_profile and said.units is None,
        sheet_size_mm=said.sheet_mm or options.sheet_size_mm,
        frame=said.frame or options.frame,
        repair=said.repair,
        refit_arcs_mm=said.refit_arcs_mm or options.refit_arcs_mm,
    )


def lines_as_cut(nest: Nest, profile: Profile) -> list[tuple[str, Curve]]:
    """What a plant makes of the lines of a nest, each with what it is for: cut, mark, ignore, or unknown.

    Holes that are marked or left out, slits, and slots that are cut across are what the profile and the answers have
    said; what they leave open is unknown.
    """
    cut_nest = profile.as_cut(nest)
    drawn = cut_nest.drawn or cut_nest
    options = profile.lead_options(cut_nest)
    limits = options.holes
    rows = [(_LINE_OF.get(contour.kind, "cut"), contour.curve) for contour in cut_nest.contours]
    rows += [("ignore", drawn.contour(name).curve) for name in cut_nest.left_out]
    small = [c for c in cut_nest.contours if c.kind == "hole" and diameter_under(c, limits.limit_mm) is not None]
    rows += [("unknown", contour.curve) for contour in small]
    slits = {part.outer.id: [slit.curve for slit in part.slits] for part in cut_nest.parts}
    walls = lost_walls([c for c in cut_nest.contours if c not in small], options.kerf_mm, slits=slits)
    open_ones = options.narrow in ("ask", "refuse")
    for lost in walls.values():
        for feature, wall in lost:
            left = cut_across(feature, options.narrow, options.kerf_mm)
            points = shapely.get_coordinates(wall)
            rows.append(("ignore" if left or not open_ones else "unknown", Curve.of(points, closed=False)))
    return rows


_LINE_OF = {"mark": "mark", "scrap": "scrap"}


def tabs_not_left(nest: Nest, plant: Profile) -> str:
    """That the nest draws tabs and the profile leaves none, in a sentence; "" where it is not so."""
    drawn = [part.outer.id for part in nest.parts if part.tabs]
    if not drawn or plant.tabs() is not None:
        return ""
    shown = ", ".join(drawn[:3]) + (", …" if len(drawn) > 3 else "")
    return (
        f"the nest draws tabs ({shown}), and the profile's rule that leaves tabs is off: they are cut; "
        "`kerfwise rules` says which rule it is"
    )


def common_cuts_not_made(inputs: Inputs) -> str:
    """Which parts are cut all round though they have common edges, and why, in a sentence; "" where none are."""
    edges, tabs = inputs.profile.common_options(), inputs.profile.tabs()
    if edges is None:
        return ""
    from kerfwise.encoder.candidates.common_paths import whole_for_tabs, whole_for_want_of_an_order

    kerf_mm = inputs.profile.material.kerf_mm
    try:
        whole, held = whole_for_tabs(inputs.nest, kerf_mm, edges, tabs) if tabs is not None else ([], [])
        kept = [inputs.nest.index[name] for name in held]
        stuck = whole_for_want_of_an_order(inputs.nest, kerf_mm, edges, kept)
        free = stuck and whole_for_want_of_an_order(inputs.nest, kerf_mm, replace(edges, mouths_first=False), kept)
    except InputError:  # such a contour is told of when its candidates are made
        return ""
    if not whole:
        within = " that cuts parts in the concavity of another before that one" if free != stuck else ""
        return (
            f"cuts.common: no common cuts for {join_names(stuck, MOST_NAMED)}: in any order{within} some part would be "
            "left with two stretches to cut, as rounded corners between two neighbours are; these parts are all cut "
            "all round"
            if stuck
            else ""
        )
    return (
        f"cuts.common: no common cuts for {join_names(whole, MOST_NAMED)}: "
        f"tabs hold {join_names(held, MOST_NAMED)}, and parts "
        "that hang together by common edges are all cut all round where tabs hold one of them; without tabs on these "
        "their edges are cut once"
    )


def differences(plan: Plan, inputs: Inputs, judged: bool = False) -> Iterator[str]:
    """A sentence for each thing that is not as it was when the plan was made: nest, profile, the machine's zero.

    One more says what of the plan is not so by nest and profile, unless it is `judged` anyway.
    """
    from kerfwise.models.plan.read_plan import source_changes

    yield from source_changes(plan, inputs.nest, inputs.profile)
    if plan.origin != inputs.profile.machine.origin:
        yield f"the plan's origin is {plan.origin}, here it is {inputs.profile.machine.origin}: the plan's counts"
    if not judged:
        yield from damaged(plan, inputs)


def damaged(plan: Plan, inputs: Inputs) -> Iterator[str]:
    """A sentence where leads, lengths or times of a plan are not as its nest and its profile have them."""
    from kerfwise.postproc.verdict.check_plan import damage_of

    sure = "" if plan.profile.get("sha256") else ", or made with another profile (it does not say with which)"
    for text in islice(damage_of(plan, inputs.nest, inputs.profile), 1):
        yield f"the plan is damaged{sure}, and taken as it stands: {text}; `kerfwise check` says all"


def is_plan_file(path: str | Path) -> bool:
    """Whether a file is read as a plan; any other is read as an NC program."""
    return str(path).lower().endswith(".json")


def read_program_of(path: str | Path, inputs: Inputs, tell: Tell = silent, trusted: Trusted | None = None) -> NcProgram:
    """An NC program of the nest; cuts that are along none of its contours are told.

    What it leaves to the machine's material is refused, unless that is `trusted`. Raises InputError if it cannot be
    read or understood, or is one of another nest.
    """
    from kerfwise.postproc.clock import read_program
    from kerfwise.postproc.verdict.check_plan import cuts_elsewhere

    program = read_program(program_text(path), inputs.nest, inputs.profile, str(path), trusted)
    if elsewhere := cuts_elsewhere(program, inputs.nest, inputs.profile.material.kerf_mm, str(path)):
        tell(f"{elsewhere} of {len(program.burns)} cuts of the program run along no contour of the nest")
    return program


def program_text(path: str | Path) -> str:
    """The text of an NC program, its line ends as they are in the file.

    Raises InputError if there is none to read; with the place, if it is not UTF-8.
    """
    return decoded(read_named(path, "the program"), path)


def decoded(data: bytes, path: str | Path) -> str:
    """The text of a program's bytes; InputError with the place, if they are not UTF-8."""
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        before = data[: error.start]
        raise InputError(
            f"not an NC program: byte 0x{data[error.start]:02X} is not UTF-8; save the program as UTF-8 or ASCII",
            file=path,
            line=before.count(b"\n") + 1,
            column=len(before[before.rfind(b"\n") + 1 :].decode("utf-8")) + 1,
        ) from None


def _path(what: str, value: object, expected: str) -> str | Path:
    if isinstance(value, str | Path):
        return value
    raise InputError(f"{what}: expected {expected}, got {type(value).__name__}")


# How a nest was read when its plan or program was made, so that nobody has to say it again.

_HEAD_BYTES = 4000
_SAID = re.compile(rf'"refit_arcs_mm": "([0-9.]+)"|{ARCS_REFITTED} ([0-9.]+) MM', re.IGNORECASE)


def refit_said(plan: Plan | str | Path | None) -> float | None:
    """How near to flattened outlines a plan, or the head of its file or program, says that arcs were made, mm.

    None where it says nothing, and for a file that cannot be read, which whoever reads it whole says.
    """
    if isinstance(plan, Plan):
        value = plan.nest.get("refit_arcs_mm")
        return None if value is None else float(value)
    if plan is None:
        return None
    try:
        with Path(plan).open("rb") as file:
            found = _SAID.search(file.read(_HEAD_BYTES).decode("utf-8", "replace"))
        return None if found is None else float(found[1] or found[2])
    except (OSError, ValueError):
        return None


def refit_as_made(given_mm: float | None, plan: Plan | str | Path | None, profile: Profile, tell: Tell) -> float | None:
    """How near to flattened outlines arcs are made: as is given, or as what was made of the nest says.

    That is told where it goes before the profile, and so is what is given where the other does not say the same. None
    where neither says it: the profile's section `drawing` does then.
    """
    if plan is None:
        return given_mm
    said_mm, name = refit_said(plan), "the plan" if isinstance(plan, Plan) else Path(str(plan)).name
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


def expect_one_torch(profile: Profile, what: str, plan: Plan | None = None, file: str = "") -> None:
    """Refuse what knows one torch only, where the profile has several, or a plan, read from `file`, uses them.

    Raises InputError that says so, with the place.
    """
    if profile.machine.torches.several:
        text = f"{what} knows one torch, and the profile has several (machine.torches)"
        raise wrong_at(where_said(profile, ("machine", "torches")), text, profile.file)
    if plan is not None and any(c.cut.torch > 1 for c in plan.cuts):
        raise InputError(f"{what} knows one torch, and the plan uses several", file=file or None)


def of_first_torch(plan: Plan) -> Plan:
    """The plan with the cuts of the first torch alone."""
    first = tuple(planned for planned in plan.cuts if planned.cut.torch == 1)
    return plan if len(first) == len(plan.cuts) else replace(plan, cuts=first)


def expect_of_first(plan: Plan, contour: str) -> None:
    """Refuse what only the cuts of the first torch can be asked.

    Raises InputError if the contour is one that another torch cuts: what it is cut with is named.
    """
    for planned in plan.cuts:
        if planned.cut.contour == contour and planned.cut.torch > 1:
            first = planned.cut.together
            raise InputError(
                f"{contour} is cut by torch {planned.cut.torch} at the time of {first}, by the same motion: ask about "
                f"{first}"
            )


def dates_ignored(nest: Nest, profile: Profile) -> int:
    """How many parts have a due date or a priority that the order of cutting does not follow."""
    if profile.objective.completion > 0:
        return 0
    parts = (nest.drawn or nest).parts
    priorities = {attribute_text(part, "priority") for part in parts}
    dated = [
        part
        for part in parts
        if attribute_text(part, "due") or (attribute_text(part, "priority") and len(priorities) > 1)
    ]
    return len(dated) if len({(attribute_text(p, "due"), attribute_text(p, "priority")) for p in parts}) > 1 else 0


def fewer_than_wanted(inputs: Inputs) -> str:
    """Which parts say that more of them are wanted than the sheets hold, in a sentence; "" where none do."""
    parts, sheets = (inputs.nest.drawn or inputs.nest).parts, 1 if inputs.job is None else inputs.job.quantity
    wanted = {k: n for k, p in enumerate(parts) if isinstance(n := p.attributes.get(QUANTITY_KEY), int) and n > sheets}
    alike = [(len(p.holes), round(p.polygon.area, 1), round(p.outer.curve.length_mm, 1)) for p in parts if wanted]
    cut = Counter(alike)
    rows = [
        f"{parts[k].id} ({count} wanted, {there} cut)"
        for k, count in wanted.items()
        if count > (there := cut[alike[k]] * sheets)
    ]
    text = "a plan cuts what the nest holds: `kerfwise nest` lays more, and quantity in the job file counts sheets"
    return f"more parts are wanted than are cut: {join_names(rows, MOST_NAMED)}; {text}" if rows else ""


def attribute_text(part: Part, key: str) -> str:
    """What an attribute of a part says, a number as text; "" where it has none."""
    value = part.attributes.get(key)
    return str(value) if isinstance(value, str | int | float) and not isinstance(value, bool) else ""
