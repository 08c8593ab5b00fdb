"""One message for all contours that cannot be cut, grouped by the one option that frees them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.listed import listed
from kerfwise.encoder.nest import Nest

from .candidate import LeadOptions
from .no_room import ALONE, WITHOUT_ROOM, Reason, reasons
from .remedies import ORDER, Key, Remedies, Remedy
from .surroundings import Surroundings
from .tried import TriedLeads

MOST_GROUPS = 8
"""With more groups than this, contours that the same options free at different values are taken together."""

_NAMED = 3


@dataclass(frozen=True, slots=True)
class _Alike:
    """Contours with the same cause that the same options free."""

    contours: tuple[int, ...]
    remedies: tuple[Remedy, ...]


def refusal(nest: Nest, tried: TriedLeads, around: Surroundings, options: LeadOptions) -> InputError:
    """The error that tells of every contour at fault, a line a group, and first which option frees all of them."""
    why = reasons(tried, around, options)
    remedies = Remedies(nest, tried, why, around, options)
    of_each = remedies.of_each()
    message = cannot_be_cut(len(why))
    groups = _groups(why, of_each, remedies)
    if len(why) > 1:
        for_all = [remedy for remedy in _common(list(of_each.values())) if remedies.frees_nest(remedy)]
        if for_all:
            message += f"; {_either(for_all)} frees all of them"
        elif len(groups) > 1:
            message += "; no single option frees all of them"
    return InputError(message, file=nest.file or None, details=tuple(_line(nest, group, why) for group in groups))


def cannot_be_cut(count: int) -> str:
    """The beginning of the message for so many contours."""
    contours = "a contour" if count == 1 else f"{count} contours"
    return f"{contours} of the nest cannot be cut as the options ask"


def _common(rows: Sequence[Sequence[Remedy]]) -> list[Remedy]:
    """Of every option that is a remedy of all contours the value that would free all."""
    found = [_hardest(key, [remedy for row in rows for remedy in row if remedy.key == key]) for key in ORDER]
    return [remedy for remedy in found if remedy and all(any(r.key == remedy.key for r in row) for row in rows)]


def _hardest(key: Key, remedies: Sequence[Remedy]) -> Remedy | None:
    """The one of several values of an option that frees what all of them do: the smallest; to skip rather than spot."""
    if key == "under":
        values = {remedy.value for remedy in remedies}
        return Remedy(key, "skip" if "skip" in values else "spot") if values else None
    return min(remedies, key=lambda remedy: remedy.value, default=None)


def _groups(why: Mapping[int, Reason], of_each: Mapping[int, tuple[Remedy, ...]], remedies: Remedies) -> list[_Alike]:
    """Contours with the same cause and remedies, the largest group first."""
    exact: dict[tuple[str, tuple[Remedy, ...]], list[int]] = {}
    for k in sorted(why):
        alone = why[k].text if why[k].cause in ALONE else why[k].cause
        exact.setdefault((alone, of_each[k]), []).append(k)
    groups = [_Alike(tuple(contours), of) for (_, of), contours in exact.items()]
    if len(groups) > MOST_GROUPS:
        alike: dict[tuple[str, tuple[Key, ...]], list[int]] = {}
        for (text, of), contours in exact.items():
            cause = text if why[contours[0]].cause == "narrow" else why[contours[0]].cause
            alike.setdefault((cause, tuple(remedy.key for remedy in of)), []).extend(contours)
        groups = []
        for (_, keys), contours in alike.items():
            listed = [_hardest(key, [r for k in contours for r in of_each[k] if r.key == key]) for key in keys]
            holds = (r for r in listed if r is not None and len(remedies.freed(r, contours)) == len(contours))
            groups.append(_Alike(tuple(sorted(contours)), tuple(holds)))
    return sorted(groups, key=lambda group: (-len(group.contours), group.contours))


def _line(nest: Nest, group: _Alike, why: Mapping[int, Reason]) -> str:
    """One group: how many and which, what frees them, and why not as it is."""
    first = why[group.contours[0]]
    one = len(group.contours) == 1
    frees = "" if first.cause not in WITHOUT_ROOM else f"{'it needs' if one else 'they need'} more room in the nest"
    if group.remedies:
        frees = f"{_either(group.remedies)} frees {'it' if one else 'them'}"
    if one:
        return "; ".join(text for text in (first.text, frees) if text)
    kinds = {nest.contours[k].kind for k in group.contours}
    named = [nest.contours[k].id for k in group.contours]
    what = f"{len(named)} {'holes' if kinds == {'hole'} else 'contours'} ({listed(named, _NAMED)})"
    return f"{what}: {'; '.join(text for text in (frees, f'such as {first.text}') if text)}"


def _either(remedies: Sequence[Remedy]) -> str:
    return ", or ".join(remedy.text for remedy in remedies)
