"""Plans that every dialect is tried on: real nests, and nests with what burns can have beside rounds and leads."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import kerfwise
from kerfwise import Nest, Plan, Profile
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.dialects import dialect_names, load_dialect
from kerfwise.rule_kit import circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.sections import Common, Links
from kerfwise.tests.postproc.plans import with_tabs

from .reading import with_dialect

HOME = Path(kerfwise.__file__).parent


@dataclass(frozen=True, eq=False, slots=True)
class Case:
    """A nest, the profile that it is planned by, and the process that its dialects must be for ("" for any)."""

    nest: Nest
    profile: Profile
    process: str = ""

    def plant(self, dialect: str) -> Profile:
        """Its profile with a machine of a dialect; who waits at a pierce stays as it is."""
        made = with_dialect(self.profile, dialect)
        waits = self.profile.machine.pierce_dwell
        return dataclasses.replace(made, machine=dataclasses.replace(made.machine, pierce_dwell=waits))

    @property
    def dialects(self) -> list[str]:
        """The dialects that can spell it."""
        known = [(name, load_dialect(name)) for name in dialect_names()]
        fitting = [(name, one) for name, one in known if not self.process or self.process in one.processes]
        marks = any(contour.kind == "mark" for contour in self.nest.contours)
        return [name for name, one in fitting if one.marks or not marks]


def plates(marked: bool = False) -> Nest:
    """Two rows of four plates, 12 mm apart; two have a hole, and two a mark where they are `marked`."""
    low, high = [], []
    for k in range(4):
        x, y = 112 * k, 40 * marked
        mark = [[(60 + x, y), (90 + x, y), (90 + x, y + 8)]] * (marked and k < 2)
        low.append(part(f"A{k}", rect(40 + x, 30, 100, 80), [circle(90 + x, 70, 15)] * (k % 2), mark))
        high.append(part(f"B{k}", rect(40 + x, 122, 100, 90)))
    return nest(520, 260, *low, *high)


def _example(name: str) -> Case:
    return Case(kerfwise.read_nest(HOME / f"examples/nests/{name}.dxf"), load_profile())


def _plate115() -> Case:
    return Case(read_json(json.dumps(make_sheet(1, 115)).encode(), ReadOptions()), load_profile())


def _links() -> Case:
    base = load_profile()
    return Case(plates(), dataclasses.replace(base, cuts=dataclasses.replace(base.cuts, links=Links(30.0))))


def _tabs() -> Case:
    return Case(plates(), with_tabs("plasma-carbon-steel", slat_pitch_mm=120.0))


def _marks() -> Case:
    return Case(plates(marked=True), load_profile())


def _laser_tabs() -> Case:
    laser = with_tabs("laser-st10kp-2mm", width_mm=0.5, slat_pitch_mm=120.0)
    return Case(read_json((HOME / "docs/tabs.nest.json").read_bytes(), ReadOptions()), laser, "laser")


def _common() -> Case:
    base = load_profile()
    grid = [part(f"C{r}{c}", rect(30 + 61.5 * c, 30 + 51.5 * r, 60, 50)) for r in range(2) for c in range(3)]
    cuts = dataclasses.replace(base.cuts, common=Common(shortest_mm=20.0, good_side="any"))
    machine = dataclasses.replace(base.machine, pierce_dwell="program", pierce_time_s=2.0)
    return Case(nest(260, 180, *grid), dataclasses.replace(base, cuts=cuts, machine=machine))


def _scrap() -> Case:
    profile = load_profile(HOME / "examples/profiles/scrap-grid.yaml")
    return Case(read_json((HOME / "docs/scrap.nest.json").read_bytes(), ReadOptions()), profile)


_MADE = {
    "e1x_6": lambda: _example("e1x_6"),
    "s8877": lambda: _example("s8877"),
    "a made plate of 115 contours": _plate115,
    "plates with links": _links,
    "plates with a tab each": _tabs,
    "plates with marks": _marks,
    "a laser's parts with tabs": _laser_tabs,
    "a skeleton cut up": _scrap,
    "plates with common cuts": _common,
}
NAMES = tuple(_MADE)
SMALL = tuple(name for name in NAMES if "115" not in name)
"""Those that take no time."""


@cache
def case(name: str) -> Case:
    """One of them."""
    return _MADE[name]()


@cache
def planned(name: str, work: float = 0.2) -> Plan:
    """Its plan."""
    made = case(name)
    asked = make_request(facts_of(made.nest, made.profile), made.profile)
    return solve_and_verify(asked, made.profile, options_for(made.nest, made.profile, work=work)).plan
