"""The rows of a list of parts, and of the command line: what they may say."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.nesting.wanted import GRAINS, QUARTERS, Grain
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Choice, Flag, Number, Text
from kerfwise.rules.options.yaml_positions import Place

from .turns import Turns

MOST = 100_000


@dataclass(frozen=True, slots=True)
class PartRow:
    """A file of parts, and how often each part in it is wanted."""

    part: str = field(default="", metadata=option(Text(), "file of the part: DXF, SVG or JSON, from the list's folder"))
    quantity: int = field(default=1, metadata=option(Number(1, MOST, whole=True), "how many are wanted"))
    priority: int = field(
        default=1, metadata=option(Number(1, 50, whole=True), "parts of lower numbers are placed first")
    )
    order: str = field(default="", metadata=option(Text(), "the order that it is for"))
    rotations: tuple[float, ...] = field(default=QUARTERS, metadata=option(Turns(), "how it may be turned"))
    grain: Grain | None = field(
        default=None,
        metadata=option(Choice(("none", *GRAINS), none="none"), "how its x axis lies to the sheet's, because of grain"),
    )
    mirror: bool = field(default=False, metadata=option(Flag(), "whether it may be turned over"))
    place: Place | None = None


@dataclass(frozen=True, slots=True)
class SheetRow:
    """A sheet by its size, or by a file, and how many there are."""

    size: str = field(default="", metadata=option(Text(), "width x height in mm, such as 3000x1500"))
    file: str = field(default="", metadata=option(Text(), "file of the sheet, from the list's folder"))
    stock: int | None = field(default=None, metadata=option(Number(1, MOST, whole=True), "how many there are"))
    price: float | None = field(default=None, metadata=option(Number(0), "price of one"))
    remnant: bool = field(default=False, metadata=option(Flag(), "whether it is a remnant, which is used first"))
    place: Place | None = None
