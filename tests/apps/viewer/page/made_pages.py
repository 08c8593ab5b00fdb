"""Pages that the tests look at: a planned nest with all that a page can hold, large ones, and two compared."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from kerfwise import Nest
from kerfwise.apps.viewer.compare import SideAsked, compare, side_of
from kerfwise.apps.viewer.compare.comparison import compared_data
from kerfwise.apps.viewer.page.page_data import page_bytes, page_data
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.inputs import Inputs, drawn_nest, plant_of
from kerfwise.jobs.request import options_for
from kerfwise.pipeline import plan_nest
from kerfwise.postproc.report import draw
from kerfwise.rule_kit import nest, part, rect
from kerfwise.rules.profile.overrides import without_rule
from kerfwise.tests.postproc.report.plausible import plausible_plan

EXAMPLE = Path(__file__).parents[4] / "examples" / "nests" / "e1x_6.json"
EVIL = "<img src=x onerror='window.evil=1'></script><script>window.evil=1</script>"
_LIMITS = {"work": 0.5, "seed": 1}


def _example(without: str = "") -> Inputs:
    profile = plant_of()
    profile = without_rule(profile, without) if without else profile
    return Inputs(profile.as_cut(drawn_nest(EXAMPLE, profile)), profile)


def planned(folder: Path) -> bytes:
    """Sixteen contours with verdict, reasons, heat and program."""
    given = _example()
    made = plan_nest(given, options_for(given.nest, given.profile, **_LIMITS)).made
    (folder / "e.plan.json").write_text(made.plan.to_json())
    return page_bytes(page_data(given, made.plan, made.verdict, made.program, heat=True))


def compared(folder: Path) -> bytes:
    """The same plan, and one without a rule."""
    a, b = _example(), _example("level-ahead")
    sides = (SideAsked("with", a, None, dict(_LIMITS)), SideAsked("without", b, None, dict(_LIMITS)))
    return page_bytes(compared_data(compare(*(side_of(side) for side in sides))))


def large(contours: int) -> Callable[[Path], bytes]:
    """So many contours in an order that nobody has planned."""

    def made(folder: Path) -> bytes:
        file = folder / f"{contours}.json"
        file.write_text(json.dumps(make_sheet(1, contours)))
        nest = drawn_nest(file, plant_of())
        return draw(nest, plausible_plan(nest), ".html")

    return made


def wicked(folder: Path) -> bytes:
    """A part whose name is a script, in a corner of its sheet."""
    plate = nest(900, 900, part(EVIL, rect(20, 20, 200, 200)))
    return draw(plate, plausible_plan(plate), ".html")


def bare(folder: Path) -> bytes:
    """A nest without a plan."""
    return draw(_nest(), None, ".html")


def _nest() -> Nest:
    return nest(300, 300, part("A", rect(20, 20, 200, 200)))


PAGES: dict[str, Callable[[Path], bytes]] = {
    "16": planned,
    "115": large(115),
    "308": large(308),
    "1000": large(1000),
    "compared": compared,
    "wicked": wicked,
    "bare": bare,
}
