"""The picture of a plan of many contours, drawn in a process of its own while the program is written and judged.

What takes long of a picture needs the nest and the cuts alone; what the check has to say of the rules stands in its
header. So all but that is drawn meanwhile. The process sets out before there is a plan, and finds out what it needs of
the nest. Whatever goes wrong in it, there is no picture from it, and it is drawn where it is asked for.
"""

from __future__ import annotations

import contextlib
import pickle
import signal
import threading
from dataclasses import replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from types import TracebackType
from typing import Self

from kerfwise.app_modules import app_module
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.process_pool import ENDED_S, end_with_parent, start_quietly
from kerfwise.models.jit import machine_cores
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import VerifiedPlan
from kerfwise.postproc.report import PAGE, draw

FROM_CONTOURS = 300
"""With fewer, drawing takes less than a process needs to set out. A first plan of 300 contours with its picture takes
this process 2.8 processor s in place of 3.2, one of 1000 5.2 in place of 5.8; the other takes 0.8 and 1.3 s."""
LEAST_CORES = 2
"""With one, two processes take as long as one after the other."""


class DrawnBeside:
    """A picture of a plan that is going to be made and judged; its process begins and ends with the context.

    Where it does not pay, nothing is drawn beside: see `pays`. `nest`: what is drawn; of what was found out about it
    nothing is handed on. `suffix`: of the picture: ".svg", ".png" or ".pdf"; of anything else, or None, there is no
    drawing. `home`: where the torch starts and ends, mm.
    """

    def __init__(self, nest: Nest, suffix: str | None, home: Point) -> None:
        self._given = _pickled((nest, suffix, home)) if self.pays(nest, suffix) else b""
        self._process: SpawnProcess | None = None
        self._way: Connection | None = None
        self._plan: Plan | None = None
        self._sent: threading.Thread | None = None

    @property
    def draws(self) -> bool:
        """Whether a plan that it is told of is drawn beside, as far as is known before there is one."""
        return bool(self._given)

    @staticmethod
    def pays(nest: Nest, suffix: str | None) -> bool:
        """Whether it is quicker than to draw afterwards."""
        drawing = suffix is not None and suffix.lower() != PAGE
        return drawing and len(nest.contours) >= FROM_CONTOURS and len(machine_cores()) >= LEAST_CORES

    def begin(self, plan: Plan) -> None:
        """Draw a plan whose rules have not been judged yet."""
        if self._way is None or not (handed_on := _pickled(plan)):
            return
        self._plan = plan
        self._sent = self._send(handed_on)

    def _send(self, data: bytes) -> threading.Thread:
        """Hand something on as soon as the process takes it, after what was handed on before."""

        def send(way: Connection, before: threading.Thread | None) -> None:
            if before is not None:
                before.join()
            with contextlib.suppress(OSError):
                way.send_bytes(data)

        sending = threading.Thread(target=send, args=(self._way, self._sent), daemon=True)
        sending.start()
        return sending

    def end(self, plan: Plan) -> bytes | None:
        """The content of its file, as soon as it is there; None where there is none: of another plan, say."""
        if self._plan is None or self._way is None or self._sent is None or plan.cuts is not self._plan.cuts:
            return None
        self._sent.join()
        if not (rules := _pickled(plan.rules)):
            return None
        try:
            self._way.send_bytes(rules)
            return self._way.recv_bytes()
        except (EOFError, OSError):
            return None

    def __enter__(self) -> Self:
        """Have the process set out; a large nest is measured and planned meanwhile."""
        if self._given:
            with contextlib.suppress(OSError):  # no process can be started: it is drawn afterwards
                way, there = (context := get_context("spawn")).Pipe()
                self._process = context.Process(target=_draw, args=(there,), daemon=True)
                start_quietly(self._process)
                there.close()
                self._way = way
                self._sent = self._send(self._given)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the process, whatever it is at."""
        if self._process is not None and self._process.pid is not None:
            self._process.terminate()
            self._process.join(ENDED_S)
        if self._way is not None:
            self._way.close()


def _pickled(value: object) -> bytes:
    """What a process is handed on; empty where something in it cannot be."""
    try:
        return pickle.dumps(value)
    except (pickle.PicklingError, AttributeError, TypeError, RecursionError):
        return b""


def _draw(way: Connection) -> None:
    """What the process does; where it cannot, it says nothing."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches every process; only the first one answers
    threading.Thread(target=end_with_parent, daemon=True).start()
    with contextlib.suppress(Exception):
        from kerfwise.postproc.report.picture import prepare, sketch
        from kerfwise.postproc.report.plot import render_picture

        nest, suffix, home = pickle.loads(way.recv_bytes())
        prepare(nest, home)
        plan: Plan = pickle.loads(way.recv_bytes())
        almost = sketch(nest, plan, home)
        way.send_bytes(render_picture(almost.scene(replace(plan, rules=pickle.loads(way.recv_bytes()))), suffix))


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
