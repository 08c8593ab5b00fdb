"""The two sides that are asked for: files or plans, profiles, rules on and off, and what is planned now."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Literal

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.given import Given
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.one_rule import with_rule, without_rule
from kerfwise.rules.profile.profile import Profile

from .side import Made, SideAsked

_HOW = (
    "give two plans or programs, or two profiles (-p A -p B, in Python profile and profile_b), or --without RULE, or "
    "--with RULE; one plan or program alone is compared with a new plan"
)
_STRENGTHS: Mapping[str, Literal["hard", "soft"] | None] = {"": None, "hard": "hard", "soft": "soft"}


def expect_two(a: Made | None, b: Made | None, profiles: int, with_: Collection[str], without: Collection[str]) -> None:
    """Refuse what does not say two sides; `profiles` is how many are given.

    Raises
    ------
    InputError
        With what may be given.
    """
    if b is not None and (with_ or without):
        raise InputError("--with and --without (in Python with_ and without) plan B anew: leave B out")
    if a is None and b is not None:
        raise InputError("B is given without A: one plan or program alone is A, compared with a new plan")
    if a is None and profiles < 2 and not (with_ or without):
        raise InputError(f"nothing to compare: {_HOW}")
    if both := [name for name in without if name in {one.partition("=")[0] for one in with_}]:
        raise InputError(f"rule {both[0]} is to be on and off: leave one out")


def pair_of(
    given: tuple[Given, Given],
    a: Made | None,
    b: Made | None,
    with_: Sequence[str],
    without: Sequence[str],
    limits: dict[str, Any],
    relax: bool,
) -> tuple[SideAsked, SideAsked]:
    """Both sides as they are asked for.

    Parameters
    ----------
    given
        The nest by the profile of A and by that of B; the same object where there is one profile.
    a, b
        Plans or programs; what is None is planned within `limits`, see `SideAsked`.
    with_, without
        Rules, such as `t-max` or `hull-before=soft`, that B is planned with and without.

    Raises
    ------
    InputError
        For a rule that there is not, with the nearest name, or a strength that it cannot have.
    """
    changed, changes = _changed(given[1], with_, without)
    by_profile = tuple(f"by profile {one.profile.name}" for one in given)
    new = "a new plan" if a is not None and given[0] is given[1] else by_profile[1]
    return (
        SideAsked(_named(a, by_profile[0]), given[0], a, limits, relax),
        SideAsked(_named(b, changes or new), changed, b, limits, relax),
    )


def _named(made: Made | None, planned: str) -> str:
    """What the user knows a side by; `planned` is that of one that is planned."""
    if made is None:
        return planned
    return "the plan that is given" if isinstance(made, Plan) else str(made)


def _changed(given: Given, with_: Sequence[str], without: Sequence[str]) -> tuple[Given, str]:
    """Nest and profile of B, with rules on and off, and what was changed."""
    profile = given.profile
    for text in with_:
        name, _, strength = text.partition("=")
        if strength not in _STRENGTHS:
            raise InputError(f"--with {text}: a rule is on as hard or soft, such as --with {name}=soft")
        profile = _switched(f"--with {text}", partial(with_rule, profile, name, _STRENGTHS[strength]))
    for name in without:
        profile = _switched(f"--without {name}", partial(without_rule, profile, name))
    told = [*(f"with {text}" for text in with_), *(f"without {name}" for name in without)]
    return replace(given, profile=profile), ", ".join(told)


def _switched(option: str, switch: Callable[[], Profile]) -> Profile:
    try:
        return switch()
    except InputError as error:
        raise InputError(f"{option}: {error.message}") from error
