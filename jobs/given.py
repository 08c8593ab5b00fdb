"""What a job is given: a nest and the profile it is to be cut by, as files, names or objects."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from kerfwise.encoder.contents import contents
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.listed import listed
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.load import DEFAULT, load_profile
from kerfwise.rules.profile.profile import Profile

if TYPE_CHECKING:
    from kerfwise.encoder.readers.options import FrameName, ReadOptions
    from kerfwise.models.plan.plan import Plan
    from kerfwise.postproc.check.reader.old import Trusted
    from kerfwise.postproc.check.reader.program import NcProgram

    from .nest_job.job import Job

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
class Given:
    """A nest, as the profile has it cut, the profile, and its job file, if one was read."""

    nest: Nest
    profile: Profile
    job: Job | None = None


def plant_of(profile: ProfileLike = DEFAULT, trust: bool = False) -> Profile:
    """The profile itself, the shipped one of that name, or the one in that file; see `load_profile` for `trust`.

    Raises
    ------
    InputError
        If there is none (with the nearest name), or it is wrong anywhere: with file, line and column.
    """
    if isinstance(profile, Profile):
        return profile
    return load_profile(_path("profile", profile, "a Profile, a name or a path"), trust=trust)


def drawn_nest(
    nest: NestLike,
    profile: Profile,
    *,
    units: str | None = None,
    sheet_mm: tuple[float, float] | None = None,
    frame: FrameName | None = None,
    repair: bool = False,
    refit_arcs_mm: float | None = None,
) -> Nest:
    """The nest as it is drawn, read as the profile's section `drawing` says, unless it is said here.

    Raises
    ------
    InputError
        If the file cannot be read, or what it holds cannot be cut.
    """
    if isinstance(nest, Nest):
        return nest
    from kerfwise.encoder.readers import read_nest

    options = reading(profile, units, sheet_mm, frame, repair, refit_arcs_mm)
    return read_nest(_path("nest", nest, "a Nest or a path"), options)


def reading(
    profile: Profile,
    units: str | None = None,
    sheet_mm: tuple[float, float] | None = None,
    frame: FrameName | None = None,
    repair: bool = False,
    refit_arcs_mm: float | None = None,
) -> ReadOptions:
    """How a nest file is read: as the profile's section `drawing` says, unless it is said here."""
    options = profile.read_options()
    return replace(
        options,
        units=units or options.units,
        sheet_size_mm=sheet_mm or options.sheet_size_mm,
        frame=frame or options.frame,
        repair=repair,
        refit_arcs_mm=refit_arcs_mm or options.refit_arcs_mm,
    )


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


def common_cuts_not_made(given: Given) -> str:
    """Which parts are cut all round though they have common edges, and why, in a sentence; "" where none are."""
    edges, tabs = given.profile.common_options(), given.profile.tabs()
    if edges is None:
        return ""
    from kerfwise.encoder.candidates.common_ways import whole_for_tabs, whole_for_want_of_an_order

    kerf_mm = given.profile.material.kerf_mm
    try:
        whole, held = whole_for_tabs(given.nest, kerf_mm, edges, tabs) if tabs is not None else ([], [])
        stuck = whole_for_want_of_an_order(given.nest, kerf_mm, edges, [given.nest.index[name] for name in held])
    except InputError:  # such a contour is told of when its candidates are made
        return ""
    if not whole:
        return (
            f"cuts.common: no common cuts for {listed(stuck, MOST_NAMED)}: in any order some part would be left with "
            "two stretches to cut, as rounded corners between two neighbours are; these parts are all cut all round"
            if stuck
            else ""
        )
    return (
        f"cuts.common: no common cuts for {listed(whole, MOST_NAMED)}: tabs hold {listed(held, MOST_NAMED)}, and parts "
        "that hang together by common edges are all cut all round where tabs hold one of them; without tabs on these "
        "their edges are cut once"
    )


def differences(plan: Plan, given: Given) -> Iterator[str]:
    """A sentence for each thing that is not as it was when the plan was made: nest, profile, the machine's zero."""
    from kerfwise.models.plan.made_from import made_from_others

    yield from made_from_others(plan, given.nest, given.profile)
    if plan.origin != given.profile.machine.origin:
        yield f"the plan's origin is {plan.origin}, here it is {given.profile.machine.origin}: the plan's counts"


def is_plan_file(path: str | Path) -> bool:
    """Whether a file is read as a plan; any other is read as an NC program."""
    return str(path).lower().endswith(".json")


def read_program_of(path: str | Path, given: Given, tell: Tell = silent, trusted: Trusted | None = None) -> NcProgram:
    """An NC program of the nest; cuts that are along none of its contours are told.

    What it leaves to the machine's material is refused, unless that is `trusted`.

    Raises
    ------
    InputError
        If it cannot be read or understood, or is one of another nest.
    """
    from kerfwise.postproc.clock.timed import read_program
    from kerfwise.postproc.verdict.of_nest import cuts_elsewhere

    program = read_program(program_text(path), given.nest, given.profile, str(path), trusted)
    if elsewhere := cuts_elsewhere(program, given.nest, given.profile.material.kerf_mm, str(path)):
        tell(f"{elsewhere} of {len(program.burns)} cuts of the program run along no contour of the nest")
    return program


def program_text(path: str | Path) -> str:
    """The text of an NC program, its line ends as they are in the file.

    Raises
    ------
    InputError
        If there is none to read; with the place, if it is not UTF-8.
    """
    try:
        data = contents(path)
    except OSError as error:
        raise InputError(f"cannot read the program: {error.strerror}", file=path) from None
    except ValueError as error:  # a NUL, or half a character
        raise InputError(f"cannot read the program: no file can have this name ({error})", file=path) from None
    return decoded(data, path)


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


def _path(what: str, given: object, expected: str) -> str | Path:
    if isinstance(given, str | Path):
        return given
    raise InputError(f"{what}: expected {expected}, got {type(given).__name__}")
