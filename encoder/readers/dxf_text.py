"""Writing and points of a DXF file as strokes, with the height, width, slant, direction and place of the entity."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from ezdxf.entities.attrib import AttDef, Attrib
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.mtext import MText
from ezdxf.entities.point import Point
from ezdxf.entities.text import Text
from ezdxf.enums import TextEntityAlignment
from ezdxf.fonts.font_face import FontFace
from ezdxf.lldxf.const import DXFError
from ezdxf.math import OCS, Matrix44, Vec3
from ezdxf.render.abstract_mtext_renderer import AbstractMTextRenderer
from ezdxf.tools import text_layout
from ezdxf.tools.text import MTextContext, estimate_mtext_extents, unified_alignment

from kerfwise.arrays import Floats

from .drawing import FOREIGN_ERRORS
from .lettering import DESCENDER, Lettering, is_of_symbols, lacking, lettering, width_of

DXF_ERRORS: tuple[type[Exception], ...] = (*FOREIGN_ERRORS, DXFError, text_layout.LayoutError)
"""What the DXF library may raise when it is fed a broken file."""

FAR = 1e12
"""No text stands so far out, in any unit."""

CONSTANT = 2
"""The bit in the flags of an ATTDEF that says that every insertion of its block shows it."""
_BACKWARDS, _UPSIDE_DOWN = 2, 4
_SHARES = {0: 0.0, 1: DESCENDER, 2: -0.5, 3: -1.0, 4: (DESCENDER - 1) / 2}
"""How far up a line of writing moves, in heights of a capital, for each of the library's vertical alignments."""


@dataclass(frozen=True, slots=True)
class Written:
    """What an entity writes: its text, its strokes (n, 2) in units of the drawing, and how tall its capitals are.

    `trouble` says why it cannot be engraved, "" where it can; there are no strokes then.
    """

    text: str
    strokes: tuple[Floats, ...]
    at: tuple[float, float]
    height: float
    trouble: str = ""


def is_written(entity: DXFEntity) -> bool:
    """Whether this is writing that is shown: a definition of an attribute is, where it is constant."""
    if isinstance(entity, AttDef):
        return bool(int(entity.dxf.get("flags", 0)) & CONSTANT) and not entity.is_invisible
    return isinstance(entity, Text | MText)


def written(entity: DXFEntity) -> Written:
    """What an entity of writing says, as strokes."""
    try:
        if isinstance(entity, Attrib | AttDef) and entity.has_embedded_mtext_entity:
            entity = entity.virtual_mtext_entity()
        drawn = _paragraphs(entity) if isinstance(entity, MText) else _line(entity)
    except DXF_ERRORS as error:
        raw = str(entity.text if isinstance(entity, MText) else entity.dxf.get("text", ""))
        at = Vec3(entity.dxf.get("insert", (0, 0, 0)))
        return Written(raw, (), (at.x, at.y), 0.0, f"its formatting cannot be read ({error})")
    if drawn.trouble or all((np.abs(stroke) < FAR).all() for stroke in drawn.strokes):  # no number is not less
        return drawn
    return Written(drawn.text, (), drawn.at, drawn.height, "it lies nowhere near anything, or its height is no number")


def middle_of_point(point: Point) -> tuple[float, float]:
    """Where a POINT is, in units of the drawing."""
    location = Vec3(point.dxf.location)
    return location.x, location.y


def plain_text(entity: Text | MText) -> str:
    """What an entity says, without the signs that set it."""
    return _plain(str(entity.plain_text())).strip()


def name_of(name: str) -> str:
    """A name or a text as its author wrote it: `\\U+XXXX` decoded, and UTF-8 that was read as another code page.

    Examples
    --------
    >>> name_of("\\\\U+0433\\\\U+0440\\\\U+0430\\\\U+0432"), name_of("GravÃ­r"), name_of("Konturteil Ä")
    ('грав', 'Gravír', 'Konturteil Ä')
    """
    decoded = _ENCODED.sub(_decoded, name)
    if decoded.isascii():
        return decoded
    for page in ("cp1252", "latin-1", "cp1250", "cp1251"):
        try:
            again = decoded.encode(page, "surrogateescape").decode("utf-8")
        except UnicodeError:
            continue
        return again
    return decoded.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


_ENCODED = re.compile(r"\\U\+([0-9a-fA-F]{4})|\\M\+([1-5])([0-9a-fA-F]{4})")
_PAGES = {"1": "cp932", "2": "cp950", "3": "cp949", "4": "johab", "5": "cp936"}


def _decoded(found: re.Match[str]) -> str:
    if found[1]:
        sign = chr(int(found[1], 16))
        return found[0] if "\ud800" <= sign <= "\udfff" else sign  # half a letter is none
    try:
        return bytes.fromhex(found[3]).decode(_PAGES[found[2]])
    except UnicodeError:
        return found[0]


_NUMBERED = re.compile(r"%%(\d{3})")


def _plain(text: str) -> str:
    """The text with letters for their numbers, as in %%065."""
    return name_of(_NUMBERED.sub(lambda found: chr(int(found[1])), text))


def _line(entity: Any) -> Written:
    """TEXT, ATTRIB and a constant ATTDEF: one line."""
    dxf, text = entity.dxf, _plain(entity.plain_text()).rstrip("\n")
    align, start, end = entity.get_placement()
    height, slant = float(dxf.height), math.radians(float(dxf.oblique))
    wide = (float(dxf.width) or 1.0) * height
    at = OCS(dxf.extrusion).to_wcs(start)
    trouble = _trouble(text, _font_of(entity), height)
    if trouble:
        return Written(text, (), (at.x, at.y), height, trouble)
    letters, angle = lettering(text), math.radians(float(dxf.rotation))
    h_align, v_align = unified_alignment(entity)
    if align in (TextEntityAlignment.FIT, TextEntityAlignment.ALIGNED) and end is not None and letters.width:
        h_align, v_align, angle = 0, 0, (end - start).angle
        stretch = (end - start).magnitude / (letters.width * wide)
        wide, height = wide * stretch, height * (stretch if align is TextEntityAlignment.ALIGNED else 1.0)
    left = -letters.width * wide * (0.0, 0.5, 1.0)[h_align]
    backwards = -1.0 if int(dxf.text_generation_flag) & _BACKWARDS else 1.0
    upside_down = -1.0 if int(dxf.text_generation_flag) & _UPSIDE_DOWN else 1.0
    matrix = (
        _sheared(wide, height, slant)
        @ Matrix44.translate(left, _SHARES[v_align] * height, 0)
        @ Matrix44.scale(backwards, upside_down, 1)
        @ Matrix44.z_rotate(angle)
        @ Matrix44.translate(*start)
        @ _to_world(OCS(dxf.extrusion))
    )
    return Written(text, tuple(_placed(letters.strokes, matrix)), (at.x, at.y), height)


def _to_world(ocs: OCS) -> Matrix44:
    return ocs.matrix if ocs.transform else Matrix44()


def _sheared(wide: float, height: float, slant: float) -> Matrix44:
    """From letters of height 1 to these sizes, slanted by so many radians."""
    sheared = math.tan(max(min(slant, 1.48), -1.48)) * height
    return Matrix44((wide, 0, 0, 0), (sheared, height, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))


def _placed(strokes: Iterable[Floats], matrix: Matrix44) -> list[Floats]:
    return [
        np.array([(v.x, v.y) for v in matrix.transform_vertices([Vec3(x, y) for x, y in stroke])]) for stroke in strokes
    ]


def _trouble(text: str, font: str, height: float) -> str:
    """Why a text cannot be engraved; "" where it can."""
    if not height > 0:
        return "it has no height"
    if is_of_symbols(font):
        return f"its font {font} shows signs in the place of letters"
    if lacks := lettering(text.replace("\n", " ")).lacks:
        return lacking(lacks)
    return ""


def _font_of(entity: DXFEntity) -> str:
    """The font that the style of an entity names, "" where it names none."""
    name = str(entity.dxf.get("style", "")) if entity.dxf.is_supported("style") else ""
    styles = None if entity.doc is None else entity.doc.styles
    if styles is None or not styles.has_entry(name):
        return ""
    style = styles.get(name)
    return str(style.get_extended_font_data()[0] or style.dxf.get("font", ""))


# MTEXT: paragraphs, laid out by the DXF library with our letters' widths.

NO_BREAK = 3.0
"""A text of no width of its own is given so many times the width that the library takes it to have: it never wraps."""


def _paragraphs(entity: MText) -> Written:
    text, height = _plain(str(entity.plain_text())), float(entity.dxf.char_height)
    at = (float(entity.dxf.insert.x), float(entity.dxf.insert.y))
    setter = _Setter(_font_of(entity))
    if trouble := _trouble(text, setter.font, height):
        return Written(text, (), at, height, trouble)
    source = entity
    if float(entity.dxf.get("width", 0.0)) < 1e-6 and not entity.has_columns:
        source = entity.copy()
        source.dxf.width = NO_BREAK * (estimate_mtext_extents(entity)[0] + height)
    layout = setter.layout_engine(source)
    layout.place(align=text_layout.LayoutAlignment(int(entity.dxf.attachment_point)))
    layout.render(entity.ucs().matrix)
    if setter.trouble:
        return Written(text, (), at, height, setter.trouble)
    return Written(text, tuple(setter.strokes), at, height)


class _Setter(AbstractMTextRenderer):
    """Takes the words that the library has laid out; `strokes` are all of them, `trouble` why there are none."""

    def __init__(self, font: str) -> None:
        super().__init__()
        self.font, self.strokes, self.trouble = font, list[Floats](), ""

    def word(self, text: str, ctx: MTextContext) -> text_layout.ContentCell:
        """One word of one look."""
        text = _plain(text)
        if not self.trouble:
            self.trouble = _trouble(text, str(ctx.font_face.family), 1.0)
        letters = lettering(text)
        wide, height, slant = ctx.cap_height * ctx.width_factor, ctx.cap_height, math.radians(ctx.oblique)
        return text_layout.Text(
            width=letters.width * wide,
            height=height,
            valign=text_layout.CellAlignment(ctx.align),
            stroke=self.get_stroke(ctx),
            renderer=_Strokes(self.strokes, letters, _sheared(wide, height, slant)),
        )

    def fraction(self, data: tuple[str, str, str], ctx: MTextContext) -> text_layout.ContentCell:
        """Two texts, one over the other, with or without a line."""
        upper, lower, kind = data
        if not kind:
            return self.word(upper, ctx)
        return text_layout.Fraction(
            top=self.word(upper, ctx),
            bottom=self.word(lower, ctx),
            stacking=self.get_stacking(kind),
            renderer=_Strokes(self.strokes, Lettering(0.0, ()), Matrix44()),
        )

    def space_width(self, ctx: MTextContext) -> float:
        """How wide a space is."""
        return width_of(" ") * float(ctx.cap_height * ctx.width_factor)

    def get_font_face(self, mtext: MText) -> FontFace:
        """The font of a text, where no word of it names another."""
        return FontFace(family=self.font)

    def make_bg_renderer(self, mtext: MText) -> text_layout.ContentRenderer:
        """Frames and backgrounds are not engraved."""
        return text_layout.DoNothingRenderer()


class _Strokes(text_layout.ContentRenderer):
    """Puts the strokes of a word, and lines under it, where the library says."""

    def __init__(self, strokes: list[Floats], letters: Lettering, size: Matrix44) -> None:
        self.strokes, self.made, self.size = strokes, letters, size

    def render(self, left: float, bottom: float, right: float, top: float, m: Matrix44 | None = None) -> None:
        """The word, from its lower left corner on."""
        self.strokes += _placed(self.made.strokes, self.size @ Matrix44.translate(left, bottom, 0) @ (m or Matrix44()))

    def line(self, x1: float, y1: float, x2: float, y2: float, m: Matrix44 | None = None) -> None:
        """A line under, over or through a word, or of a fraction."""
        self.strokes += _placed([np.array([(x1, y1), (x2, y2)])], m or Matrix44())


def cross(x: float, y: float, across: float) -> Sequence[tuple[float, float]]:
    """A punch mark in one stroke: along x, then along y, `across` from end to end."""
    arm = across / 2
    return [(x - arm, y), (x + arm, y), (x, y), (x, y + arm), (x, y - arm)]
