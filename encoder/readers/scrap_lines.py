"""What a drawing holds on layers for lines that cut up scrap: left out, or cut where the planner says so."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise.encoder.nest import Contour, Note, as_scrap

from .drawing import DrawnCurve
from .join import join
from .layers import counted
from .options import ReadOptions


def scrap_of_drawing(pieces: Sequence[DrawnCurve], options: ReadOptions) -> tuple[tuple[Contour, ...], list[Note]]:
    """The scrap lines of a drawing in the order in which they are drawn, and a word on what is left out."""
    if not pieces:
        return (), []
    if options.scrap_lines == "ignore":
        layers = counted(p.layer for p in pieces)
        text = f"left out, as lines that cut up scrap: {layers}; drawing: {{scrap_lines: cut}} has them cut"
        return (), [Note("warning", text)]
    joined = join(pieces, options.join_tolerance_mm)
    notes = [Note("warning", f"the scrap line {p.place} is drawn twice; it is cut once") for p in joined.repeats]
    notes += [Note("warning", f"the scrap line {p.place} has no length: left out") for p in joined.specks]
    if joined.rings:
        text = "left out, as a line that cuts up scrap has two ends, and these close"
        notes.append(Note("warning", f"{text}: {counted(p.layer for p in joined.rings)}"))
    return as_scrap(p.curve for p in joined.chains), notes
