"""The picture of a plan of many contours, drawn in a process of its own while the program is written and judged.

What takes long of a picture needs the nest and the cuts alone; what the check has to say of the rules stands in its
header. So all but that is drawn meanwhile. The process sets out before there is a plan, and finds out what it needs of
the nest. Whatever goes wrong in it, there is no picture from it, and it is drawn where it is asked for.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from dataclasses import replace

from kerfwise.app_modules import app_module
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.process_beside import Beside, Hear
from kerfwise.models.jit import machine_cores
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import VerifiedPlan
from kerfwise.postproc.report import PAGE, draw

FROM_CONTOURS = 300
"""With fewer, drawing takes less than a process needs to set out. A first plan of 300 contours with its picture takes
this process 2.8 processor s in place of 3.2, one of 1000 5.2 in place of 5.8; the other takes 0.8 and 1.3 s."""
LEAST_CORES = 2
"""With one, two processes take as long as one after the other."""
BEHIND = 10
"""By how much the picture stands behind the program, which somebody waits for at a machine, as systems count it."""


def is_worth_a_process(nest: Nest) -> bool:
    """Whether what takes as long as a picture of the nest is quicker in a process beside this one."""
    return len(nest.contours) >= FROM_CONTOURS and len(machine_cores()) >= LEAST_CORES


class DrawnBeside(Beside):
    """A picture of a plan that is going to be made and judged; its process begins and ends with the context.

    Of what was found out about the `nest` nothing is handed on to a process that sets out from nothing. `suffix`: of
    the picture: ".svg", ".png" or ".pdf"; of anything else, or None, there is no drawing. `home`: where the torch
    starts and ends, mm.
    """

    def __init__(self, nest: Nest, suffix: str | None, home: Point) -> None:
        super().__init__(_draw, nest, suffix, home)
        drawing = suffix is not None and suffix.lower() != PAGE
        self.pays = drawing and is_worth_a_process(nest)
        self._plan: Plan | None = None

    def begin(self, plan: Plan) -> None:
        """Draw a plan whose rules have not been judged yet."""
        if self.tell(plan):
            self._plan = plan

    def end(self, plan: Plan) -> bytes | None:
        """The content of its file, as soon as it is there; None where there is none: of another plan, say."""
        if self._plan is None or plan.cuts is not self._plan.cuts or not self.tell(plan.rules):
            return None
        picture: bytes | None = self.answer()
        return picture


def _draw(hear: Hear, nest: Nest, suffix: str, home: Point) -> Iterator[bytes]:
    """What the process does, where cores are left."""
    with contextlib.suppress(AttributeError):
        os.nice(BEHIND)
    from kerfwise.postproc.report.picture import prepare, sketch
    from kerfwise.postproc.report.plot import render_picture

    prepare(nest, home)
    plan: Plan = hear()
    almost = sketch(nest, plan, home)
    yield render_picture(almost.scene(replace(plan, rules=hear())), suffix)


# The picture of a plan that has just been made: a page with all that is known of it, or a drawing.


def planned_picture(inputs: Inputs, verified: VerifiedPlan, suffix: str, beside: DrawnBeside) -> bytes:
    """The content of a picture's file, of the type that its suffix says, the one that was drawn beside if there is one.

    Raises InputError if it is none of a picture.
    """
    if suffix.lower() == PAGE:
        page = app_module("viewer.page.page_data")
        content: bytes = page.page_bytes(page.page_data(inputs, verified.plan, verified.verdict, verified.program))
        return content
    if (picture := beside.end(verified.plan)) is not None:
        return picture
    return draw(inputs.nest, verified.plan, suffix, inputs.profile.home_on(inputs.nest))
