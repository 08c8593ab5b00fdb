"""Whether a profile and the dialect that it names belong together."""

from __future__ import annotations

from kerfwise.encoder.nest import Nest
from kerfwise.rules.options.yaml_positions import Place, place_in, wrong_at
from kerfwise.rules.profile.machine_section import MACHINE_WAITS
from kerfwise.rules.profile.profile import Profile

from .dialect import Dialect
from .load import dialect_names, load_dialect, pierce_dwell_of
from .power import powers_of


def fitting_dialect(profile: Profile) -> Dialect:
    """The dialect of the profile's machine.

    Raises
    ------
    InputError
        If there is none of that name, if it is for another process and the profile does not accept that, or if the
        profile asks for edge starts, or a pierce pass, of a control that waits at every start, or for a pierce pass
        where the torch waits for metal to cool: with the place in the profile's file.
    """
    machine = profile.machine
    dialect = load_dialect(machine.dialect)
    if machine.process not in dialect.processes and not machine.accept_dialect:
        others = [name for name in dialect_names() if machine.process in load_dialect(name).processes]
        raise wrong_at(
            _said_at(profile, ("machine", "dialect"), ("machine", "process")),
            f"machine.dialect: '{machine.dialect}' is for {' and '.join(dialect.processes)}, the machine's process is "
            f"{machine.process}: its programs would not run, or would run wrong. Say dialect: {' or '.join(others)}, "
            "correct machine.process, or say accept_dialect: true to have it all the same",
        )
    if profile.cuts.pierce_pass and pierce_dwell_of(profile, dialect) == "machine":
        raise wrong_at(
            _said_at(profile, ("cuts", "pierce_pass")),
            f"cuts.pierce_pass: under the dialect '{dialect.name}' the machine waits at every start, also where a cut "
            "begins at a hole: say machine: {pierce_dwell: program} and set the machine's own delay to 0",
        )
    if profile.cuts.pierce_pass and (limit := profile.temperature_limit()) is not None and limit.dwells:
        raise wrong_at(
            _said_at(profile, ("cuts", "pierce_pass")),
            "cuts.pierce_pass: where the torch waits for metal to cool (dwells) holes are pierced one by one: say "
            "pierce_pass: off, or dwells: false",
        )
    if machine.torches.several and not (dialect.torch_select and dialect.torch_deselect):
        others = [name for name in dialect_names() if load_dialect(name).torch_select]
        raise wrong_at(
            _said_at(profile, ("machine", "torches"), ("machine", "dialect")),
            f"machine.torches: the dialect '{dialect.name}' has no words for a second torch (torch_select, "
            f"torch_deselect): take {' or '.join(others)}, give a copy of it these words, or say count: 1",
        )
    if profile.leads.edge_start and pierce_dwell_of(profile, dialect) == "machine":
        raise wrong_at(_said_at(profile, ("leads", "edge_start")), f"leads.edge_start: {MACHINE_WAITS}")
    if profile.kerf_starts and pierce_dwell_of(profile, dialect) == "machine":
        place = _said_at(profile, ("machine", "kerf_start"), ("cuts", "common"))
        raise wrong_at(place, f"machine.kerf_start: {MACHINE_WAITS}")
    if profile.material.power is not None and dialect.powers is None and dialect.control == "grbl":
        raise wrong_at(
            _said_at(profile, ("material", "power"), ("material", "chart"), ("machine", "dialect")),
            f"material.power: the dialect '{dialect.name}' has S words of its own: write {{power}}, {{pierce_power}} "
            "and {mark_power} in their place and give it the key powers, as the dialect grbl has them",
        )
    return dialect


def expect_words(nest: Nest, profile: Profile, dialect: Dialect, resumes: bool = False) -> None:
    """Refuse a nest whose program a dialect has no words for; `resumes` says that it goes on after a stop.

    Raises
    ------
    InputError
        For marks where it cannot mark, and for a program that must tell what is cut where it knows no comments.
    """
    marks = [contour.id for contour in profile.as_cut(nest).contours if contour.kind == "mark"]
    place = _said_at(profile, ("machine", "dialect"))
    if marks and not dialect.marks:
        shown = ", ".join(marks[:3]) + (", …" if len(marks) > 3 else "")
        raise wrong_at(
            place,
            f"machine.dialect: '{dialect.name}' has no words for marking, and the nest has {len(marks)} ({shown}): "
            "take another dialect, or a nest without them",
        )
    powers = powers_of(dialect, profile)
    if (
        marks
        and dialect.says_power
        and profile.material.power is not None
        and powers["mark_power"] * 2 > powers["power"]
    ):
        raise wrong_at(
            _said_at(profile, ("material", "mark_power"), ("material", "power"), ("material", "chart")),
            f"material.mark_power: S{powers['mark_power']} is more than half of S{powers['power']}, which cuts, and "
            "might cut too: give material.mark_power, a smaller share of full power",
        )
    if resumes and profile.cuts.pierce_pass:
        raise wrong_at(
            _said_at(profile, ("cuts", "pierce_pass")),
            "cuts.pierce_pass: a program that goes on after a stop cannot have a pierce pass, for nobody knows which "
            "holes are there: say pierce_pass: off for the rest",
        )
    if resumes and dialect.comment is None:
        raise wrong_at(
            place,
            f"machine.dialect: '{dialect.name}' knows no comments, in which a program that goes on after a stop tells "
            "what is cut: take another dialect",
        )


def _said_at(profile: Profile, *paths: tuple[str, ...]) -> Place | None:
    """Where the profile's file has the first of these keys that it has, else where one that it is based on has."""
    files = (profile.file, *reversed(profile.read_from))
    return next((place for file in files if file and (place := place_in(file, *paths)) is not None), None)
