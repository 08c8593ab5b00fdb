"""A plan as the control's program: header, then for each cut rapid, torch on, pierce dwell, path, torch off."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import PurePath

import numpy as np
import shapely

from ..encoder.cut import Cut
from ..encoder.errors import InputError
from ..encoder.geometry.curve import Curve
from ..encoder.nest import Nest
from ..models.plan import Plan, PlannedCut
from ..rules.profile import Profile
from .blocks import comment, number, numbered, path_blocks, plain, rapid_block, seconds_text
from .dialects import Dialect, load_dialect
from .toolpath import torch_path

SHA_DIGITS = 12


def write_program(plan: Plan, nest: Nest, profile: Profile) -> str:
    """The program of `plan` in the dialect of the profile's machine.

    Kerf compensation is in the path (the program keeps G40); pierce points, order and directions are the plan's. The
    same plan, nest and profile give the same bytes, and so does the plan once written to a file and read back.

    Raises
    ------
    InputError
        If the plan was made from another nest, or the dialect is unknown or cannot spell the program.
    """
    _same_nest(plan, nest)
    dialect = load_dialect(profile.machine.dialect)
    blocks = [*_header(plan, nest, profile, dialect), *dialect.header]
    for order, planned, edge_start in zip(
        range(1, len(plan.cuts) + 1), plan.cuts, _edge_starts(plan, nest), strict=True
    ):
        blocks += _cut(order, planned, edge_start, nest, profile, dialect)
    blocks += [comment(dialect, "HOME"), rapid_block(profile.machine.home, dialect), *dialect.footer]
    return "\n".join([*numbered(blocks, dialect), ""])


def _same_nest(plan: Plan, nest: Nest) -> None:
    sha = plan.nest.get("sha256", "")
    if sha and nest.sha256 and sha != nest.sha256:
        raise InputError(
            f"the plan was made from another nest: its sha256 begins {sha[:SHA_DIGITS]}, that of {nest.file} "
            f"{nest.sha256[:SHA_DIGITS]}; solve again or give the nest it was made from"
        )
    if unknown := [p.cut.contour for p in plan.cuts if p.cut.contour not in nest.index]:
        raise InputError(f"the plan cuts contours that {nest.file or 'the nest'} does not have", details=tuple(unknown))


def _header(plan: Plan, nest: Nest, profile: Profile, dialect: Dialect) -> Iterator[str]:
    totals, material = plan.totals, profile.material
    yield comment(dialect, f"KERFWISE FOR {plain(dialect.title).upper()}")
    yield comment(dialect, "NEST", PurePath(nest.file).name, f"SHA256 {nest.sha256[:SHA_DIGITS]}")
    yield comment(dialect, "PROFILE", profile.name, f"SHA256 {profile.sha256[:SHA_DIGITS]}")
    thickness, kerf = number(material.thickness_mm, 3), number(material.kerf_mm, 3)
    yield comment(dialect, "MATERIAL", material.name, f"{thickness} MM, KERF {kerf} MM")
    yield comment(dialect, f"CONTOURS {len(plan.cuts)}, PIERCES {totals.pierces}")
    yield comment(dialect, f"CUT {number(totals.cut_mm, 1)} MM, IDLE {number(totals.idle_mm, 1)} MM")
    yield comment(dialect, f"ESTIMATED TIME {seconds_text(totals.time_s)}")
    yield comment(dialect, f"START SIDE {plan.start_side.upper()}")
    for planned in plan.cuts:
        for rule in planned.cut.excused:
            yield comment(dialect, f"EXCUSED {plain(rule)}", planned.cut.contour)
    yield from _relaxed(plan, dialect)


def _relaxed(plan: Plan, dialect: Dialect) -> Iterator[str]:
    """What a planner let go, a number each; contours that have no room go on in another comment of that number."""
    for k, dropped in enumerate((d for d in plan.dropped if d.relaxed), 1):
        head = f"RELAXED {k} {plain(dropped.rule)}"
        room = dialect.max_line - len(dialect.comment.format(text=f"{head} "))
        line = ""
        for name in (plain(contour).replace(" ", "_") for contour in dropped.contours):
            if line and len(line) + 1 + len(name) > room:
                yield comment(dialect, head, line)
                line = ""
            line = f"{line} {name}".lstrip()
        yield comment(dialect, head, line)


def _edge_starts(plan: Plan, nest: Nest) -> list[bool]:
    """Whether each cut comes in from outside the sheet, where there is nothing to pierce."""
    shapely.prepare(nest.sheet.polygon)
    xy = [p.cut.pierce for p in plan.cuts]
    inside = shapely.contains_xy(nest.sheet.polygon, [x for x, _ in xy], [y for _, y in xy])
    return [not bool(i) for i in inside]


def _cut(
    order: int, planned: PlannedCut, edge_start: bool, nest: Nest, profile: Profile, dialect: Dialect
) -> Iterator[str]:
    cut, machine, contour = planned.cut, profile.machine, nest.contour(planned.cut.contour)
    mark = contour.kind == "mark"
    yield comment(
        dialect, f"{'MARK' if mark else 'CUT'} {order}", cut.contour, f"ZONE {cut.zone} {cut.direction.upper()}"
    )
    path = torch_path(contour, _as_filed(cut), profile.material.kerf_mm)
    yield rapid_block(path.point_at(0.0), dialect)
    yield dialect.mark_on if mark else dialect.torch_on
    dwell_s = machine.mark_time_s if mark else machine.pierce_time_s
    if dialect.pierce_dwell == "program" and dwell_s > 0 and not edge_start:
        yield dialect.dwell.format(seconds=number(dwell_s, 3))
    yield from path_blocks(path, machine.mark_feed_mm_s if mark else machine.cut_feed_mm_s, dialect)
    yield dialect.mark_off if mark else dialect.torch_off


def _as_filed(cut: Cut) -> Cut:
    """The cut as a plan file holds it: to 6 decimals."""

    def rounded(lead: Curve | None) -> Curve | None:
        return None if lead is None else Curve(np.round(lead.vertices, 6), lead.closed)

    x, y = cut.pierce
    return replace(cut, pierce=(round(x, 6), round(y, 6)), lead_in=rounded(cut.lead_in), lead_out=rounded(cut.lead_out))
