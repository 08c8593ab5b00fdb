"""From what a program burns back to cuts of the nest's contours."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, zip_longest

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut, CutSequence, Pierce, Side
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.torch_path import TabOptions
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.rules.judging.pierces import starts_in_older_kerfs
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.profile.values import ProfileValues

from .coverage import shared_cuts
from .cut_from_burn import SplitBurn, cut_from_burn, split_burns
from .matching import Match, Matcher, extend_to_tabs, with_tabs
from .plan_conformance import PlanClaims
from .plan_runs import burnt_before as burnt_by
from .plan_runs import read_resumed
from .result import ids_by_name, normalize_name
from .torch_run import TorchRun, every_line_of, in_steps_of, tolerance_mm

_CUT = re.compile(
    r"(?P<does>CUT|MARK) (?P<number>\d+) (?P<contour>.+?) ZONE (?P<zone>\d+)\b(?: (?P<direction>C?CW)\b)?",
    re.IGNORECASE,
)
_SIDE = re.compile(r"START SIDE (LEFT|RIGHT|BOTTOM|TOP)", re.IGNORECASE)
_EXCUSED = re.compile(r"EXCUSED (?P<rule>[a-z0-9-]+) (?P<contour>.+)", re.IGNORECASE)
_SIDES: Mapping[str, Side] = {"LEFT": "left", "RIGHT": "right", "BOTTOM": "bottom", "TOP": "top"}


@dataclass(frozen=True, eq=False, slots=True)
class Rebuilt:
    """The cuts of a program that match contours, all its torch-on paths, and what is wrong with them.

    Of a program that goes on after a stop the cuts made before, as it tells them, come first.
    """

    cuts: CutSequence
    runs: tuple[TorchRun, ...]
    violations: tuple[Violation, ...]
    warnings: tuple[str, ...]
    broken_off: Cut | None = None


def rebuild(
    nest: Nest,
    program: NcProgram,
    kerf_mm: float,
    home: Point,
    planned: PlanClaims | None = None,
    tabs_asked: TabOptions | None = None,
    in_passes: bool = False,
) -> Rebuilt:
    """Match every torch-on path of a program with a contour of the nest.

    Zones, the start side and excuses come from comments such as `CUT 12 P3.hole1 ZONE 2`, `START SIDE LEFT` and
    `EXCUSED part-rigidity P1.outer`, where there are any, and so does what was cut before the program began (see
    `resumed`); which contour is cut, its entry, direction and leads come
    from geometry alone. What the comments do not say the plan does, where there is one. Where `tabs_asked` are at the
    end of cuts, a cut that stops short of its begin has a tab there. Where holes are pierced `in_passes`, a burn that
    does not move is one.
    """
    with in_steps_of(program.step_mm):
        return _rebuilt(nest, program, kerf_mm, home, planned, tabs_asked, in_passes)


def _widths_asked(nest: Nest, contour: Contour, options: TabOptions | None) -> list[float]:
    """The widths that tabs on a contour are asked for, mm."""
    part = next((part for part in nest.parts if part.id == contour.part), None)
    if options is None or part is None:
        return []
    return [options.width_mm, *(tab.width_mm for tab in options.drawn(part) if tab.width_mm)]


def _rebuilt(
    nest: Nest,
    program: NcProgram,
    kerf_mm: float,
    home: Point,
    planned: PlanClaims | None,
    tabs_asked: TabOptions | None,
    in_passes: bool,
) -> Rebuilt:
    matcher = Matcher(nest, kerf_mm)
    holes = {(burn.line, burn.torch): burn for burn in program.burns if in_passes and burn.pierces_only}
    program = replace(program, burns=tuple(burn for burn in program.burns if (burn.line, burn.torch) not in holes))
    burns = (
        program.burns if tabs_asked is None or not tabs_asked.at_end else extend_to_tabs(program.burns, nest, matcher)
    )
    drawn = every_line_of([burn.path for burn in burns])
    paths = [line or shapely.LineString([burn.path.end] * 2) for burn, line in zip(burns, drawn, strict=True)]
    told = [_CUT.search(burn.comment) if burn.torch == 1 else None for burn in burns]
    ids = ids_by_name(nest, program.comments)
    names = [ids.get(normalize_name(words["contour"])) if words else None for words in told]
    if planned is not None:
        names = [name or guess for name, guess in zip_longest(names, planned.names_of_burns())][: len(burns)]
    named = [None if name is None else nest.index.get(name) for name in names]
    matches = matcher.match(paths, [burn.tool != 0 for burn in burns], named)
    before = read_resumed(nest, program.comments)
    made_before = before.cuts or (() if planned is None else planned.cuts[: planned.cuts.made])
    begun: list[tuple[int, Cut]] = list(before.begun)
    if planned is not None and not before.cuts:
        begun = [row for row in planned.cuts.begun if row[0] <= planned.cuts.made]
    burnt_before = burnt_by(nest, made_before, kerf_mm, begun)
    several = shared_cuts(nest, burns, paths, matches, matcher.rings, kerf_mm, burnt_before)
    zones = _zones(program.comments, ids) if several or any(burn.torch > 1 for burn in burns) else {}
    excused = _excused(program, ids)
    cuts: list[Cut] = list(made_before)
    count = len(cuts)
    lines = [0] * count
    runs: list[TorchRun] = []
    violations: list[Violation] = list(before.violations)
    warnings: list[str] = []
    pierces: list[Pierce] = []
    taken = _taken_apart(nest, burns, paths, matches, several, kerf_mm)
    for k, (burn, path, words, name, match) in enumerate(zip(burns, paths, told, named, matches, strict=True)):
        pierces += _pierced(holes, len(cuts) + 1, burn.line)
        if k in several:
            if not any(piece.out for piece in several[k]):
                begun += [(len(cuts) + 1, replace(cut, torch=burn.torch)) for cut in several[k][0].begun]
            for piece in several[k]:
                position = 0
                if piece.out:
                    name_of = piece.contour.id
                    zone = zones.get(name_of, 0)
                    cuts.append(replace(piece.cut, excused=excused[name_of], zone=zone, torch=burn.torch))
                    lines.append(burn.line)
                    position = len(cuts)
                runs.append(replace(piece.run, position=position))
            continue
        if match is None:
            runs.append(TorchRun(0, f"line {burn.line}", None, None, path, None, burn.tool != 0))
            violations.append(_stray(burn, path))
            continue
        contour = nest.contours[match.contour]
        zone = int(words["zone"]) if words else zones.get(contour.id, 0) if burn.torch > 1 else 0
        cut, run, wrong = cut_from_burn(burn, taken[k], contour, match, kerf_mm, zone, len(cuts) + 1)
        if burn.unlit:
            cut, run, more = with_tabs(cut, run, burn, kerf_mm, _widths_asked(nest, contour, tabs_asked))
            wrong = [*wrong, *more]
        warnings += wrong_comment(burn, words, None if name is None else nest.contours[name].id, cut, len(cuts) + 1)
        cuts.append(replace(cut, excused=excused[contour.id], torch=burn.torch))
        lines.append(burn.line)
        runs.append(run)
        violations += wrong
    pierces += _pierced(holes, len(cuts) + 1)
    side = next((_SIDES[found[1].upper()] for found in map(_SIDE.search, program.comments) if found), None)
    sequence = CutSequence(_together(cuts, lines), side, home, made=count, begun=tuple(begun))
    sequence = replace(sequence, pierces=holes_with_contours(pierces, sequence.cuts)) if pierces else sequence
    sequence = sequence if planned is None else planned.completed(sequence)
    return Rebuilt(sequence, tuple(runs), tuple(violations), tuple(warnings), before.broken_off)


def wrong_comment(burn: Burn, words: re.Match[str] | None, named: str | None, cut: Cut, number: int) -> Iterator[str]:
    """What the comment before a burn says otherwise than it is: what is cut, whether that marks, its number and way.

    `named` is the contour that the comment names, None where the nest has no such one.
    """
    if words is None:
        return
    line, does = f"line {burn.line}", "cut" if burn.tool == 0 else "marked"
    if named != cut.contour:
        said = named or f"{words['contour']}, which the nest does not have"
        yield f"{line}: the comment names {said}, but {cut.contour} is {does}"
    if (words["does"].upper() == "CUT") != (burn.tool == 0):
        yield f"{line}: the comment says {words['does'].upper()}, but {cut.contour} is {does}"
    if int(words["number"]) != number:
        yield f"{line}: the comment says number {words['number']}, but {cut.contour} is number {number}"
    if words["direction"] and words["direction"].lower() != cut.direction:
        yield f"{line}: the comment says {words['direction'].upper()}, but {cut.contour} is {does} {cut.direction}"


def _taken_apart(
    nest: Nest,
    burns: Sequence[Burn],
    paths: Sequence[shapely.LineString],
    matches: Sequence[Match | None],
    several: Collection[int],
    kerf_mm: float,
) -> dict[int, SplitBurn]:
    """The paths of burns that match one contour each, by number, taken apart."""
    matched = {k: match for k, match in enumerate(matches) if match is not None and k not in several}
    contours = [nest.contours[match.contour] for match in matched.values()]
    taken = split_burns(
        [burns[k] for k in matched], [paths[k] for k in matched], contours, list(matched.values()), kerf_mm
    )
    return dict(zip(matched, taken, strict=True))


def _together(cuts: Sequence[Cut], lines: Sequence[int]) -> tuple[Cut, ...]:
    """The cuts of further torches, each with the one that the first torch makes meanwhile: it begins in its line."""
    first: dict[int, str] = {}
    for cut, line in zip(cuts, lines, strict=True):
        if cut.torch == 1:
            first.setdefault(line, cut.contour)
    return tuple(
        cut if cut.torch == 1 else replace(cut, together=first.get(line, ""))
        for cut, line in zip(cuts, lines, strict=True)
    )


def _pierced(holes: dict[tuple[int, int], Burn], before: int, line: int | None = None) -> list[Pierce]:
    """The holes before a line of the program, taken out of those that are left, as pierced before that cut.

    `holes` are by line and torch.
    """
    due = [holes.pop(at) for at in sorted(holes) if line is None or at[0] < line]
    return [Pierce("", burn.start, before, burn.start_s, burn.end_s) for burn in due]


def _zones(comments: Iterable[str], ids: Mapping[str, str]) -> dict[str, int]:
    """Contour id → the zone that a comment gives it."""
    matches = filter(None, map(_CUT.search, comments))
    return {
        name: int(words["zone"]) for words in matches if (name := ids.get(normalize_name(words["contour"]))) is not None
    }


def _excused(program: NcProgram, ids: Mapping[str, str]) -> Mapping[str, tuple[str, ...]]:
    """Contour id → rules that the program's comments excuse it from; `ids` are by folded name."""
    rules_of: dict[str, tuple[str, ...]] = defaultdict(tuple)
    for found in map(_EXCUSED.fullmatch, program.comments):
        if found and (name := ids.get(normalize_name(found["contour"]))) is not None:
            rules_of[name] += (found["rule"].lower(),)
    return rules_of


def _stray(burn: Burn, path: shapely.LineString) -> Violation:
    x0, y0, x1, y1 = path.bounds
    place = f"X {x0:.1f} to {x1:.1f}, Y {y0:.1f} to {y1:.1f}"
    torch = "" if burn.torch == 1 else f"torch {burn.torch} "
    return Violation(
        "every-contour-once", (), f"line {burn.line}: {torch}burns along no contour of the nest, at {place}"
    )


# Pierce passes: each cut begins at a hole pierced before, in the pass of its zone, and no hole is left over.

_RULE = "pierce-pass"


def holes_with_contours(pierces: Sequence[Pierce], cuts: Sequence[Cut]) -> tuple[Pierce, ...]:
    """The holes, each with the contour of the cut after it that begins there; of several the first."""
    told, taken = [], set[int]()
    for pierce, near in zip(pierces, _near([p.at for p in pierces], [cut.pierce for cut in cuts]), strict=True):
        later = (k for k in near if k >= pierce.before - 1 and k not in taken and not cuts[k].linked)
        found = next(later, None)
        taken |= set() if found is None else {found}
        told.append(replace(pierce, contour="" if found is None else cuts[found].contour))
    return tuple(told)


def pierce_pass_violations(nest: Nest, cuts: CutSequence, profile: ProfileValues) -> Iterator[Violation]:
    """What is wrong with the passes that the profile asks for: holes missing, left over, late, or in no metal."""
    passes = list(_passes(nest, cuts, profile))
    holes, left = cuts.pierces, dict.fromkeys(range(len(cuts.pierces)))
    at_cut = _near([cut.pierce for cut in cuts], [hole.at for hole in holes])
    for begins, group in passes:
        first = group[0]
        for k in group:
            cut = cuts[k - 1]
            number = next((h for h in at_cut[k - 1] if h in left), None)
            if number is None:
                text = f"cut {k} of {cut.contour} begins at {_at(cut.pierce)}, where no hole was pierced before"
                yield Violation(_RULE, (cut.contour,), text, (k,))
                continue
            del left[number]
            own = holes[number]
            if own.contour not in ("", cut.contour):
                text = f"cut {k} of {cut.contour} begins at the hole at {_at(own.at)}, said to be of {own.contour}"
                yield Violation(_RULE, (cut.contour,), text, (k,))
            if own.before > first:
                text = f"the hole of {cut.contour} (cut {k}) is pierced after cut {first}, the first of its pass"
                yield Violation(_RULE, (cut.contour,), text, (k,))
            elif own.before < begins:
                text = f"the hole of {cut.contour} (cut {k}) is pierced before cut {own.before}, with another zone"
                yield Violation(_RULE, (cut.contour,), text, (k,))
    for hole in (holes[h] for h in left):
        yield Violation(_RULE, (), f"no cut begins at the hole that is pierced at {_at(hole.at)}", (hole.before,))
    yield from _pierced_outside_metal(nest, cuts)


def _passes(nest: Nest, cuts: CutSequence, profile: ProfileValues) -> Iterator[tuple[int, list[int]]]:
    """The first position of each zone, and those of its cuts that begin at holes. Without zones all are of one.

    What is linked, marked, or cuts up the skeleton pierces nothing; nor does what begins off the sheet, or in the kerf
    of an older cut.
    """
    in_kerfs = starts_in_older_kerfs(nest, cuts, profile.material.kerf_mm) if profile.common_options() else ()
    sheet = shapely.buffer(shapely.make_valid(nest.sheet.polygon), -tolerance_mm())
    rows = [(k, cut) for k, cut in enumerate(cuts, 1) if k > cuts.made]
    whole = profile.cuts.pierce_pass == "sheet"
    for _, group in groupby(rows, key=lambda row: 0 if whole else row[1].zone):
        zone = list(group)
        pierced = [
            k
            for k, cut in zone
            if not cut.linked
            and k not in in_kerfs
            and (cut.contour not in nest.index or nest.contour(cut.contour).shapes_part)
            and shapely.contains_xy(sheet, *cut.pierce)
        ]
        if pierced:
            yield zone[0][0], pierced


def _pierced_outside_metal(nest: Nest, cuts: CutSequence) -> Iterator[Violation]:
    """Holes that are pierced in a piece that was cut out before: the inside of a contour that is out."""
    if not cuts.pierces:
        return
    rings = [
        (k, contour)
        for k, cut in enumerate(cuts, 1)
        if cut.contour in nest.index and (contour := nest.contour(cut.contour)).encloses
    ]
    points = shapely.points(np.array([hole.at for hole in cuts.pierces]))
    tree = shapely.STRtree([contour.polygon for _, contour in rings])
    for h, r in sorted(zip(*(row.tolist() for row in tree.query(points, "within")), strict=True)):
        hole, (k, contour) = cuts.pierces[h], rings[r]
        if k < hole.before:
            text = f"the hole at {_at(hole.at)} is pierced in {contour.id}, which is cut out as cut {k}"
            yield Violation(_RULE, (contour.id,), text, (k,))


def _near(points: Sequence[Point], others: Sequence[Point]) -> list[list[int]]:
    """For each point the numbers of those others that are at the same place, in order."""
    found: list[list[int]] = [[] for _ in points]
    if points and others:
        tree = shapely.STRtree(shapely.points(np.array(others)))
        rows, near = tree.query(shapely.points(np.array(points)), "dwithin", distance=tolerance_mm())
        for k, other in sorted(zip(rows.tolist(), near.tolist(), strict=True)):
            found[k].append(other)
    return found


def _at(point: tuple[float, float]) -> str:
    return f"({point[0]:z.2f}, {point[1]:z.2f})"
