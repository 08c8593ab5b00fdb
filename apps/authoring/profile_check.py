"""A profile before there is a nest: checked, or begun as a copy of another whose comments stay."""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.dialects import dialect_misfits, load_dialect
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect
from kerfwise.rules.options.kind import OptionKind, Text, Unfit
from kerfwise.rules.options.option import Members, options_of
from kerfwise.rules.options.yaml_positions import compose, raise_together, with_value
from kerfwise.rules.profile.contradictions import misfits
from kerfwise.rules.profile.load import SHIPPED, load_profile, profile_text, shipped_profiles
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.profile_yaml import Provenance
from kerfwise.rules.profile.sections import SECTIONS
from kerfwise.rules.profile.values import ProfileValues
from kerfwise.rules.registry import RULES

Reason = Callable[[Profile], str | None]
"""Why an option has no effect in a profile, as a clause; None where it has one."""


def expect_plannable(profile: Profile) -> None:
    """Refuse what `solve` would refuse of a profile, whatever the nest.

    Raises InputError if programs of its dialect would not run, options contradict each other, or a rule's model file is
    no model.
    """
    raise_together((*dialect_misfits(profile), *misfits(profile)))
    trusted_dialect(profile)
    _compile_models(profile)


def _compile_models(profile: Profile) -> None:
    """State each rule in a model file on a small nest, so that MiniZinc's compiler reads it."""
    rules = profile.model_rules()
    if not rules:
        return
    from kerfwise.rules.flat.compiler import minizinc_program

    from .trials.trial import trial_nest, trial_of

    minizinc_program()
    plain = replace(
        load_profile(),
        rules=dict(profile.rules),
        further_rules=profile.further_rules,
        own_rules=profile.own_rules,
        models=profile.models,
        python=profile.python,
    )
    for rule in rules:
        trial = trial_of("profile check", trial_nest(1, 5), plain, rule.id)
        if trial is not None:
            list(rule.statements(trial.facts, plain.settings()[rule.id].options))


def notes(profile: Profile) -> Iterator[str]:
    """What a planner would want to know of a profile: groups that hold by their defaults, options without an effect."""
    yield from _groups_by_default(profile)
    yield from _without_effect(profile)


def _groups_by_default(profile: Profile) -> Iterator[str]:
    """Groups that a profile has without a word of what switches them on."""
    named = profile.said_at
    for section in SECTIONS:
        for group in (o for o in options_of(getattr(profile, section)) if isinstance(o.kind, Members)):
            path, owner = f"{section}.{group.key}", getattr(getattr(profile, section), group.name)
            switches = [o for o in options_of(owner) if o.named]
            if path in named and switches and not any(f"{path}.{o.key}" in named for o in switches):
                texts = [f"{o.key}: {o.kind.write(getattr(owner, o.name))}" for o in switches]
                yield f"{named[path]}: {path} is on by its defaults ({', '.join(texts)})"


def _unless(on: Callable[[Profile], object], why: str) -> Reason:
    return lambda profile: None if on(profile) else why


_ONE_TORCH = _unless(lambda p: p.machine.torches.several, "there is one torch (machine.torches.count)")
_FULL_FEED = _unless(lambda p: p.corners.corner_feed < 1, "corners are cut at the full feed (corners.corner_feed: 1)")
_NO_COMMON = _unless(
    lambda p: p.cuts.common.shortest_mm is not None, "no edges are cut once (cuts.common.shortest: off)"
)
_NO_KERF_START = _unless(
    lambda p: p.cuts.common.shortest_mm is not None or p.cuts.in_stretches,
    "no cut begins in an old kerf (cuts.common, cuts.snake and cuts.split are off)",
)
_NO_SNAKE = _unless(lambda p: p.cuts.snake.gap_mm is not None, "no row is cut as a snake (cuts.snake.gap: off)")
_NO_BEVEL = _unless(lambda p: p.cuts.bevel.head is not None, "no head tilts (cuts.bevel.head: off)")
_NO_LEAD = _unless(lambda p: p.leads.lead != "none", "there is no lead-in (leads.lead: none)")
_NO_ACCELERATION = _unless(lambda p: p.time.model == "acceleration", "it is for time.model: acceleration")
_NOT_LOGICAL = _unless(lambda p: p.heat.model == "logical", "it is for heat.model: logical")
_NO_POWER_PRICE = _unless(lambda p: p.prices.kwh, "power has no price (prices.kwh)")
_NOT_WORN = _unless(lambda p: p.prices.consumables.set_price, "a set has no price (prices.consumables.set_price)")
_NO_SHEET_PRICE = _unless(lambda p: p.prices.sheet_kg or p.prices.sheet_each, "the sheet has no price")


def _no_edge(profile: Profile) -> str | None:
    machine, cuts = profile.machine, profile.cuts
    used = profile.leads.edge_start or profile.kerf_starts or cuts.scrap.grid_mm or cuts.scrap.remnant
    if used or machine.process == "oxyfuel" or profile.drawing.scrap_lines == "cut":
        return None
    return "no cut begins at an edge (leads.edge_start, cuts.common and cuts.scrap are off)"


def _no_links(profile: Profile) -> str | None:
    why = profile.no_links()
    return f"the torch stays on nowhere: {why}" if why and profile.cuts.links.longest_mm > 0 else None


WITHOUT_EFFECT: dict[str, Reason] = {
    "machine.torches.spacing": _ONE_TORCH,
    "machine.torches.axis": _ONE_TORCH,
    "machine.torches.up_to": _ONE_TORCH,
    "machine.kerf_start": _NO_KERF_START,
    "machine.edge_preheat": _no_edge,
    "leads.lead_in": _NO_LEAD,
    "leads.lead_in_min": _NO_LEAD,
    "leads.lead_out_length": _unless(
        lambda p: p.leads.lead_out != "none", "there is no lead-out (leads.lead_out: none)"
    ),
    "corners.corner_angle": _FULL_FEED,
    "corners.corner_reach": _FULL_FEED,
    "cuts.links.longest": _no_links,
    "cuts.common.gap_tolerance": _NO_COMMON,
    "cuts.common.good_side": _NO_COMMON,
    "cuts.common.accept_loss": _NO_COMMON,
    "cuts.snake.parts": _NO_SNAKE,
    "cuts.split.shared_last": _unless(lambda p: p.cuts.split.last_mm, "nothing is cut last (cuts.split.last: off)"),
    "cuts.snake.rows": _NO_SNAKE,
    **dict.fromkeys(
        (f"cuts.bevel.{key}" for key in ("tilt", "turn", "most_turn", "kerfs", "corner", "run", "lies_still")),
        _NO_BEVEL,
    ),
    **dict.fromkeys(
        ("cuts.bevel.apart", "cuts.bevel.left"),
        _unless(lambda p: p.cuts.bevel.head == "block", "no block of torches cuts bevels (cuts.bevel.head)"),
    ),
    "small_holes.full_feed_hole": _unless(
        lambda p: p.small_holes.small_hole_feed < 1,
        "small holes are cut at the full feed (small_holes.small_hole_feed: 1)",
    ),
    "small_holes.spot_size": _unless(lambda p: p.small_holes.under == "spot", "no hole is spotted (small_holes.under)"),
    "time.acceleration": _NO_ACCELERATION,
    "time.corner_deviation": _NO_ACCELERATION,
    "time.feed_by_blocks": _unless(lambda p: p.time.model == "blocks", "it is for time.model: blocks"),
    "heat.logical_conduction": _NOT_LOGICAL,
    "heat.logical_retention": _NOT_LOGICAL,
    "heat.logical_step": _NOT_LOGICAL,
    "prices.torch_kw": _NO_POWER_PRICE,
    "prices.standby_kw": _NO_POWER_PRICE,
    "prices.consumables.pierces": _NOT_WORN,
    "prices.consumables.torch_hours": _NOT_WORN,
    "prices.remnant_share": _NO_SHEET_PRICE,
}
"""Options that another one switches off."""


def _without_effect(profile: Profile) -> Iterator[str]:
    """A sentence for each option that a profile gives and that changes nothing, with its place."""
    sources = Provenance(profile)
    for key, reason in WITHOUT_EFFECT.items():
        if _said(profile, key) and (why := reason(profile)):
            yield f"{sources.of(key)}: {key} has no effect: {why}"
    for name, setting in profile.rules.items():
        set_keys = [f"rules.{name}.{o.key}" for o in options_of(setting.options)] if setting.strength == "off" else []
        set_keys = [key for key in set_keys if _said(profile, key)]
        if set_keys and not _counts_though_off(profile, name):
            strengths = " or ".join(s for s in profile.known_rules()[name].strengths if s != "off")
            listed = ", ".join(key.rpartition(".")[2] for key in set_keys)
            yield (
                f"{sources.of(set_keys[0])}: rules.{name} is off, and without it its options ({listed}) have no "
                f"effect: give its strength too ({strengths})"
            )


def _said(profile: Profile, key: str) -> bool:
    """Whether a file of the plant gives a key; what shipped profiles have is no mistake of theirs."""
    return not profile.said_at.get(key, SHIPPED).startswith(SHIPPED)


def _counts_though_off(profile: Profile, name: str) -> bool:
    """Whether other rules, the leads or the facts take something from the options of a rule that is off."""
    if name not in RULES or profile.known_rules()[name].shares:
        return name in RULES
    bare = replace(profile.rules[name], options=RULES[name].Options())
    without = replace(profile, rules={**profile.rules, name: bare})
    return (
        profile.lead_options() != without.lead_options()
        or profile.fact_options() != without.fact_options()
        or profile.settings() != without.settings()
    )


def checked(name: str, trust: bool = False) -> Profile:
    """The profile of that name or path, once all of it is known to do.

    Raises InputError if it is wrong anywhere, or nothing could be planned with it: with its place.
    """
    profile = load_profile(name, trust=trust)
    try:
        expect_plannable(profile)
    except InputError as error:
        if error.file is not None:
            raise
        raise InputError(error.message, file=profile.file or None, details=error.details) from None
    return profile


_NAME = re.compile(r"[^\W_][\w.-]{0,60}")
_EDITOR = re.compile(r"^# yaml-language-server:.*\n", re.MULTILINE)
_ASKED = (
    ("machine", "dialect"),
    ("machine", "cut_feed"),
    ("machine", "travel"),
    ("machine", "pierce_time"),
    ("machine", "home"),
    ("material", "name"),
    ("material", "thickness"),
    ("material", "kerf"),
)
"""What differs from plant to plant, and cannot be guessed."""

Key = tuple[str, str]


@dataclass(frozen=True, slots=True)
class Question:
    """One key of a profile that a person is asked for: what it is, and the answer that stands if none is given."""

    key: Key
    text: str
    default: str
    kind: OptionKind
    process: str

    def answered(self, text: str) -> str:
        """The answer as it is written. Raises InputError if the key cannot have it: with what was expected."""
        node = compose(text, "")
        if node is None:
            raise InputError(f"expected {self.kind.expected()}")
        try:
            value = self.kind.read(node)
        except Unfit as error:
            raise InputError(str(error)) from None
        if self.key == ("machine", "dialect"):
            dialect = load_dialect(str(value))
            if self.process not in dialect.processes:
                raise InputError(
                    f"{value} is for {', '.join(dialect.processes)}, and this machine cuts by {self.process}"
                )
        return text.strip()


def questions(like: ProfileValues) -> Iterator[Question]:
    """What is asked of a new profile, with the answers of the one that it is like."""
    for section, key in _ASKED:
        option = next(o for o in options_of(SECTIONS[section]) if o.key == key)
        value = getattr(getattr(like, section), option.name)
        yield Question((section, key), option.help, option.kind.write(value), option.kind, like.machine.process)


def new_profile_text(name: str, like: str, answers: Mapping[Key, str] | None = None, folder: Path | None = None) -> str:
    """The text of the profile `like` under another name, with other values where there are answers.

    What it is based on is named as seen from `folder`, where the text will stand; without one it stands beside `like`.
    Raises InputError for a name that no profile can have or a shipped one has, and where `like` cannot be read.

    Examples
    --------
    >>> text = new_profile_text("shop", "water-jet", {("material", "kerf"): "0.9 mm"})
    >>> [row.split("#")[0].strip() for row in text.splitlines() if row.strip().startswith(("name: shop", "kerf"))]
    ['name: shop', 'kerf: 0.9 mm']
    """
    if not _NAME.fullmatch(name):
        raise InputError(f"{name!r} cannot be a profile's name: expected letters, digits, dots and dashes")
    if name in shipped_profiles():
        raise InputError(f"{name} is the name of a profile that comes with kerfwise: choose another")
    text = with_value(_EDITOR.sub("", profile_text(like)), ["name"], name)
    if folder is not None and like not in shipped_profiles():
        text = _based_as_before(text, Path(like), folder)
    for key, value in (answers or {}).items():
        text = with_value(text, key, value)
    return f"# Begun as a copy of {Path(like).name}. Change what differs; `kerfwise profile check` reads it.\n{text}"


def _based_as_before(text: str, like: Path, folder: Path) -> str:
    """The text of a profile from another folder, based on the same file; who reads it finds what is wrong with that."""
    root = compose(text, "")
    entries = root.value if isinstance(root, yaml.MappingNode) else ()
    base = next((value.value for key, value in entries if key.value == "based_on"), None)
    if not isinstance(base, str) or not base or base in shipped_profiles() or Path(base).is_absolute():
        return text
    there, here = os.path.realpath((like.parent / base).parent), os.path.realpath(folder)
    if here == os.path.realpath(like.parent):
        return text
    with contextlib.suppress(ValueError):  # no way from one drive to another
        there = os.path.relpath(there, here)
    return with_value(text, ["based_on"], Text().write((Path(there) / Path(base).name).as_posix()))


def expect_usable(text: str, path: Path, trust: bool = False) -> ProfileValues:
    """The profile that a text will be at a path; files that it names are looked for from there.

    Raises InputError if it cannot be used there: with what is wrong.
    """
    handle, name = tempfile.mkstemp(prefix=".kerfwise-", suffix=".yaml", dir=path.parent)
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
        profile = load_profile(name, trust=trust)
        trusted_dialect(profile)
    except InputError as error:
        there = error.file is not None and Path(error.file) == Path(name)
        place = {"line": error.line, "column": error.column} if there else {}
        shown_file = path if there or error.file is None else error.file
        details = tuple(line.replace(name, str(path)) for line in error.details)
        message = f"nothing is written, for this profile could not be used: {error.message}"
        raise InputError(message, file=shown_file, details=details, **place) from error
    finally:
        os.unlink(name)
    return profile
