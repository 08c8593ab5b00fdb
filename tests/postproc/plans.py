"""A small plate and a plan for it made by hand: `from kerfwise.tests.postproc.plans import …`."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

import shapely

from kerfwise import Nest, Plan, Profile
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.models.plan.plan import PlannedCut, SolveReport, Totals
from kerfwise.rule_kit import Contour, Curve, Cut, Direction, RuleSetting, Strength, circle, nest, part, rect
from kerfwise.rules.catalogue.cut_direction import CutDirectionOptions
from kerfwise.rules.catalogue.hold_small_parts import HoldSmallPartsOptions
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.sections import Machine, default_settings

KERF_MM = 1.5
QUARTER = math.tan(math.pi / 8)


def plate() -> Nest:
    """Five parts: A with a hole and a mark, a frame B with a disc C (and its hole) in it, D with arcs, E an L."""
    d = [(330, 60), (390, 60, QUARTER), (410, 80), (410, 140), (350, 140, -QUARTER), (330, 120)]
    e = [(440, 20), (540, 20), (540, 60), (480, 60), (480, 160), (440, 160)]
    return dataclasses.replace(
        nest(
            600,
            200,
            part("A", rect(20, 20, 100, 120), [circle(70, 90, 15)], [[(30, 40), (110, 40, 0.2), (110, 50)]]),
            part("B", rect(140, 20, 170, 160), [rect(155, 35, 140, 130)]),
            part("C", circle(225, 100, 50), [circle(225, 100, 12)]),
            part("D", d),
            part("E", e),
        ),
        file="plate.json",
        sha256="5eed" * 16,
    )


def profile(**changes: object) -> Profile:
    """The default rules, with outer contours cut clockwise and holes counter-clockwise, as plasma asks.

    The plans made here by hand have neither rigidity nor heat nor tipped parts in mind: those rules are off. Programs
    wait for the pierce themselves.
    """
    rules = default_settings()
    for name in ("heat-lag", "no-narrow-strips", "no-tip-travel", "part-rigidity"):
        rules[name] = RuleSetting("off", None, rules[name].options)
    rules["cut-direction"] = RuleSetting("hard", None, CutDirectionOptions(outer="cw", hole="ccw"))
    machine = Machine(pierce_dwell="program")
    return dataclasses.replace(Profile("test", machine=machine, rules=rules, sha256="c0de" * 16), **changes)


def with_tabs(name: str, strength: Strength = "hard", **options: Any) -> Profile:
    """A shipped profile with the rule hold-small-parts, and these of its options."""
    base = load_profile(name)
    tabs = RuleSetting(strength, None, HoldSmallPartsOptions(**options))
    return dataclasses.replace(base, rules=dict(base.rules) | {"hold-small-parts": tabs})


def cut_of(
    contour: Contour, along: float, direction: Direction, zone: int = 1, kerf_mm: float = KERF_MM, lead_mm: float = 4.0
) -> Cut:
    """A cut that joins `along` (0…1) of the way round, by a straight lead, and leaves by a short slanting one."""
    curve = contour.curve
    if contour.kind == "mark":
        line = curve if direction == "ccw" else curve.reversed()
        x, y = line.point_at(0.0)
        return Cut(contour.id, (x, y), direction, (x, y), None, Curve(line.vertices[-1:], closed=False), zone)
    s_mm = along * curve.length_mm
    (x, y), (tx, ty) = curve.point_at(s_mm), curve.tangent_at(s_mm)
    waste = 1.0 if (contour.kind == "outer") == curve.is_ccw else -1.0
    nx, ny = ty * waste, -tx * waste

    def off(outwards_mm: float, along_mm: float = 0.0) -> tuple[float, float]:
        return x + nx * outwards_mm + tx * along_mm, y + ny * outwards_mm + ty * along_mm

    join, pierce = off(kerf_mm / 2), off(kerf_mm / 2 + lead_mm)
    lead_in = Curve.of([pierce, join], closed=False)
    lead_out = Curve.of([join, off(kerf_mm / 2 + 0.6, 0.8)], closed=False)
    return Cut(contour.id, (x, y), direction, pierce, lead_in, lead_out, zone)


ORDER: Sequence[tuple[str, float, Direction, int]] = (
    ("A.mark1", 0.0, "ccw", 1),
    ("A.hole1", 0.3, "ccw", 1),
    ("A.outer", 0.1, "cw", 1),
    ("C.hole1", 0.6, "ccw", 1),
    ("C.outer", 0.2, "cw", 1),
    ("B.hole1", 0.1, "ccw", 1),
    ("B.outer", 0.4, "cw", 1),
    ("D.outer", 0.5, "cw", 2),
    ("E.outer", 0.45, "cw", 2),
)


def good_cuts(plate: Nest, kerf_mm: float = KERF_MM) -> list[Cut]:
    """Cuts of the plate that keep every rule."""
    return [cut_of(plate.contour(name), along, way, zone, kerf_mm) for name, along, way, zone in ORDER]


def plan_of(nest: Nest, cuts: Sequence[Cut], profile: Profile) -> Plan:
    """The plan of these cuts, with lengths, times and totals as they are."""
    machine, kerf_mm = profile.machine, profile.material.kerf_mm
    home = profile.home_on(nest)
    at, now_s, planned = home, 0.0, []
    idle = 0.0
    for cut in cuts:
        contour = nest.contour(cut.contour)
        mark = contour.kind == "mark"
        length = _ring(contour, kerf_mm).length_mm + sum(c.length_mm for c in (cut.lead_in, cut.lead_out) if c)
        travel = math.dist(at, cut.pierce)
        start_s = now_s + travel / machine.travel_mm_s
        feed, wait = (
            (machine.mark_feed_mm_s, machine.mark_time_s) if mark else (machine.cut_feed_mm_s, machine.pierce_time_s)
        )
        wait = 0.0 if cut.linked else wait
        now_s, at, idle = start_s + wait + length / feed, cut.end, idle + travel
        timed = dataclasses.replace(cut, start_s=start_s, end_s=now_s)
        planned.append(PlannedCut(timed, contour.part, contour.kind, length))
    back = math.dist(at, home)
    stock = nest.sheet.polygon
    pierces = sum(
        p.kind != "mark" and not p.cut.linked and stock.contains(shapely.Point(p.cut.pierce)) for p in planned
    )
    cut_mm = sum(p.length_mm for p in planned)
    return Plan(
        {"file": nest.file, "sha256": nest.sha256},
        {"name": profile.name, "sha256": profile.sha256},
        "left",
        "offcut",
        tuple(planned),
        Totals(cut_mm, idle + back, pierces, now_s + back / machine.travel_mm_s, 0.0),
        SolveReport("by hand", "feasible", idle + back, None, None, 0.0, 0),
    )


def _ring(contour: Contour, kerf_mm: float) -> Curve:
    if contour.kind == "mark" or kerf_mm == 0:
        return contour.curve
    return offset_curve(contour.curve, kerf_mm / 2 if contour.kind == "outer" else -kerf_mm / 2)
