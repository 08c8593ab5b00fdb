"""Tells in words what differs between what is kept of a case and what it means now."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator
from typing import Any


def changes(kept: dict[str, Any], now: dict[str, Any]) -> list[str]:
    """What changed, a line each; none if both mean the same."""
    return [] if kept == now else list(_differ("", kept, now))


def _differ(at: str, old: Any, new: Any) -> Iterator[str]:
    """The differences of two values at a place."""
    if old == new:
        return
    if isinstance(old, dict) and isinstance(new, dict):
        yield from _mappings(at, old, new)
    elif isinstance(old, list) and isinstance(new, list):
        if _all_have(old, "contour") and _all_have(new, "contour"):
            yield from _cuts(at, old, new)
        elif _all_have(old, "run", "edit") and _all_have(new, "run", "edit"):
            yield from _steps(old, new)
        elif len(old) == len(new):
            for place, (one, other) in enumerate(zip(old, new, strict=True)):
                yield from _differ(f"{at}[{place}]", one, other)
        else:
            yield f"{at}: {len(old)} entries, now {len(new)}"
    else:
        yield f"{at}: {_told(old, new)}"


def _mappings(at: str, old: dict[str, Any], new: dict[str, Any]) -> Iterator[str]:
    if at.split(" ")[-1] == "rules" and all(isinstance(rules, list) for rules in [*old.values(), *new.values()]):
        old, new = _by_rule(old), _by_rule(new)
    for key in old:
        here = f"{at} {key}".strip()
        if key not in new:
            yield f"{here}: is not there any more, was {_short(old[key])}"
        elif key == "digest":
            if old[key] != new[key]:
                yield f"{at}: what it holds has changed (digest)"
        else:
            yield from _differ(here, old[key], new[key])
    for key in new:
        if key not in old:
            yield f"{f'{at} {key}'.strip()}: is new, {_short(new[key])}"


def _steps(old: list[Any], new: list[Any]) -> Iterator[str]:
    if [_title(s) for s in old] != [_title(s) for s in new]:
        yield "the case has other steps: " + "; ".join(_title(s) for s in new)
        return
    for one, other in zip(old, new, strict=True):
        for line in _differ("", one, other):
            yield f"`{_title(one)}`: {line}"


def _cuts(at: str, old: list[dict[str, Any]], new: list[dict[str, Any]]) -> Iterator[str]:
    """The differences of two lists of cuts: contours, order, then each cut by itself."""
    was, now = _by_contour(old), _by_contour(new)
    for contour in was:
        if contour not in now:
            yield f"{at}: {contour} is not cut any more (was cut {was[contour][0]})"
    for contour in now:
        if contour not in was:
            yield f"{at}: {contour} is new, cut {now[contour][0]}"
    both = [[c for c in rows if c in was and c in now] for rows in (was, now)]
    same: set[str] = set()
    for block in difflib.SequenceMatcher(None, *both, autojunk=False).get_matching_blocks():
        same.update(both[0][block.a : block.a + block.size])
    for contour in both[1]:
        if contour not in same:
            yield f"{at}: {contour} is cut {now[contour][0]} now, was cut {was[contour][0]}"
    shifts: list[tuple[int, str, float]] = []
    for contour in both[0]:
        (place, one), (_, other) = was[contour], now[contour]
        for key in dict.fromkeys((*one, *other)):
            if key == "order" or one.get(key) == other.get(key):
                continue
            if key in ("start_s", "end_s") and key in one and key in other:
                shifts.append((place, contour, other[key] - one[key]))
            else:
                yield f"{at}: {contour} (cut {place}) {key} {_told(one.get(key), other.get(key))}"
    if shifts:
        place, contour, by = shifts[0]
        cuts = len({c for _, c, _ in shifts})
        yield f"{at}: times of {cuts} cuts, from {contour} (cut {place}) on, there by {by:+.3f} s"


def _told(old: Any, new: Any) -> str:
    """How a value changed: by how much, or how far a point moved."""
    if _number(old) and _number(new):
        return f"{_short(old)} → {_short(new)} ({new - old:+.6g})"
    if _point(old) and _point(new):
        return f"moved by {math.dist(old[:2], new[:2]):.3f} mm, ({_xy(old)}) → ({_xy(new)})"
    if _path(old) and _path(new):
        if len(old) != len(new):
            return f"has {len(new)} points, had {len(old)}"
        return f"moved by up to {max(math.dist(a[:2], b[:2]) for a, b in zip(old, new, strict=True)):.3f} mm"
    return f"{_short(old)} → {_short(new)}"


def _by_contour(rows: list[dict[str, Any]]) -> dict[str, tuple[int, dict[str, Any]]]:
    """Rows by contour, with the place of each; a contour's second row has a name of its own."""
    found: dict[str, tuple[int, dict[str, Any]]] = {}
    for place, row in enumerate(rows, 1):
        name = row["contour"]
        while name in found:
            name += " again"
        found[name] = row.get("order", place), row
    return found


def _by_rule(verdicts: dict[str, list[str]]) -> dict[str, str]:
    """What is said of each rule."""
    return {rule: said for said, rules in verdicts.items() for rule in rules}


def _title(step: dict[str, Any]) -> str:
    return str(step.get("run") or f"edit {step.get('edit')}")


def _all_have(rows: list[Any], *keys: str) -> bool:
    return bool(rows) and all(isinstance(row, dict) and any(key in row for key in keys) for row in rows)


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _point(value: Any) -> bool:
    return isinstance(value, list) and len(value) in (2, 3) and all(map(_number, value))


def _path(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(map(_point, value))


def _xy(point: list[float]) -> str:
    return f"{point[0]}, {point[1]}"


def _short(value: Any) -> str:
    text = str(value)
    return text if len(text) <= 100 else f"{text[:97]}…"
