"""How a nest file was understood: units, sheet, what each layer is taken for, and what was left out or repaired."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

GIVEN = "as given"
"""How it is said that somebody has stated the sheet's size; where it lies may still be nobody's word."""

DONE = {
    "cut": "cut",
    "mark": "marked",
    "ignore": "left out",
    "sheet": "the sheet",
    "scrap": "scrap lines",
    "bridge": "bridges",
    "tab": "tabs",
}
"""What becomes of the lines of each purpose, in a word or two."""


class Stock(Protocol):
    """A `Sheet`, as far as it is looked at here; nests come after their readings."""

    @property
    def bounds(self) -> tuple[float, float, float, float]: ...

    @property
    def stated(self) -> bool: ...


class Said(Protocol):
    """A `Note`, likewise."""

    @property
    def severity(self) -> str: ...

    @property
    def text(self) -> str: ...


@dataclass(frozen=True, slots=True)
class Taken:
    """Lines of one layer that look alike, what they are taken for, and why: `count` of them; or its texts or points."""

    layer: str
    purpose: str
    because: str
    count: int
    colour: str = ""
    linetype: str = ""
    what: str = "line"

    def told(self) -> str:
        """The line of a reading.

        Examples
        --------
        >>> Taken("GRAVUR", "mark", "by its name", 2, "red").told()
        "layer 'GRAVUR', red: marked, by its name (2 lines)"
        """
        look = "".join(f", {word}" for word in (self.colour, self.linetype) if word)
        lines = f"1 {self.what}" if self.count == 1 else f"{self.count} {self.what}s"
        return f"layer '{self.layer}'{look}: {DONE[self.purpose]}, {self.because} ({lines})"


@dataclass(frozen=True, slots=True)
class Writing:
    """What is engraved as letters, or a point where `text` is "": where it was drawn and how tall its capitals are, mm.

    `marks` are the contours of its strokes.
    """

    text: str
    layer: str
    at: tuple[float, float]
    height_mm: float
    marks: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """The same as data."""
        x, y = (round(c, 4) for c in self.at)
        size = round(self.height_mm, 4)
        return {"text": self.text, "layer": self.layer, "at": [x, y], "height": size, "marks": list(self.marks)}


@dataclass(frozen=True, slots=True)
class Reading:
    """What was understood of a nest file.

    `units_because` and `sheet_because` say why. `taken` has a row for each layer, and for colours and line types where
    those differ. `left_out` and `repaired` are sentences. `answers` are the questions that were answered, by whom.
    `writings` are the texts and the points that are engraved.
    """

    units: str
    units_because: str
    sheet: str
    sheet_because: str
    assumed: bool
    taken: tuple[Taken, ...] = ()
    left_out: tuple[str, ...] = ()
    repaired: tuple[str, ...] = ()
    answers: Mapping[str, str] = field(default_factory=dict)
    writings: tuple[Writing, ...] = ()

    def lines(self) -> list[str]:
        """The whole reading, a line for each thing."""
        texts = [f"units: {self.units}: {self.units_because}", f"sheet: {self.sheet_told}"]
        texts += [row.told() for row in self.taken]
        texts += [f"answered: {question}={choice}" for question, choice in self.answers.items()]
        return [
            *texts,
            *(f"left out: {text}" for text in self.left_out),
            *(f"repaired: {text}" for text in self.repaired),
        ]

    @property
    def sheet_told(self) -> str:
        """The sheet and why, *assumed* where nobody stated it."""
        return f"{self.sheet}{', assumed' if self.assumed else ''}: {self.sheet_because}"

    def short(self) -> str:
        """The same in one line, for the head of a program and the end of a command."""
        rows: dict[str, Counter[str]] = {}
        for row in self.taken:
            what = "" if row.what == "line" else f" {row.what}s"
            rows.setdefault(f"{DONE[row.purpose]}{what}", Counter())[row.layer] += row.count
        parts = [f"{done}: {_layers(layers)}" for done, layers in rows.items()]
        sheet = f"sheet {self.sheet}{' assumed' if self.assumed else ''}"
        return "; ".join([f"read in {self.units}", sheet, *parts])

    def as_json(self) -> dict[str, Any]:
        """The reading as data."""
        return {
            "units": {"name": self.units, "because": self.units_because},
            "sheet": {"size": self.sheet, "because": self.sheet_because, "assumed": self.assumed},
            "layers": [
                {"layer": r.layer, "colour": r.colour, "linetype": r.linetype, "taken_for": r.purpose,
                 "because": r.because, f"{r.what}s": r.count}
                for r in self.taken
            ],
            "left_out": list(self.left_out),
            "repaired": list(self.repaired),
            "answers": dict(self.answers),
            "engraved": [writing.as_json() for writing in self.writings],
        }  # fmt: skip


def _layers(count: Counter[str], most: int = 4) -> str:
    shown = [f"'{layer}' ({count[layer]})" for layer in sorted(count)[:most]]
    return ", ".join([*shown, *([f"and {len(count) - most} more layers"] if len(count) > most else [])])


def size_of_sheet(sheet: Stock) -> str:
    """Width and height of a sheet, as they are said.

    Examples
    --------
    >>> from kerfwise.encoder.nest import Sheet
    >>> size_of_sheet(Sheet.rectangle(3000, 1500))
    '3000 × 1500 mm'
    """
    x0, y0, x1, y1 = sheet.bounds
    return f"{round(x1 - x0, 3):g} × {round(y1 - y0, 3):g} mm"


def reading_of(
    units: tuple[str, str],
    sheet: Stock,
    sheet_because: str,
    taken: Iterable[Taken],
    notes: Iterable[Said],
    answers: Mapping[str, str],
    writings: tuple[Writing, ...] = (),
) -> Reading:
    """The reading of a nest, from what its reader found; notes on lines that are left out or mended are its own."""
    noted = list(notes)
    left = [
        note.text.removeprefix("left out, ") for note in noted if note.severity == "warning" and "left out" in note.text
    ]
    mended = [note.text for note in noted if note.severity == "repaired"]
    return Reading(
        *units,
        size_of_sheet(sheet),
        sheet_because,
        not sheet.stated and not sheet_because.startswith(GIVEN),
        tuple(taken),
        tuple(left),
        tuple(mended),
        dict(answers),
        writings,
    )
