"""How an entity of a DXF file looks: its colour and its line type, its own or those of its layer."""

from __future__ import annotations

from ezdxf.colors import aci2rgb
from ezdxf.document import Drawing as Document
from ezdxf.entities.dxfgfx import DXFGraphic

from .dxf_text import name_of

NAMES = {1: "red", 2: "yellow", 3: "green", 4: "cyan", 5: "blue", 6: "magenta", 7: "white", 8: "grey"}
"""The colours that CAD programs number first; 7 is drawn white on black and black on white."""
BY_BLOCK, BY_LAYER = 0, 256
CONTINUOUS = ("", "continuous", "bylayer", "byblock")


class Looks:
    """Colours and line types of a document's entities."""

    def __init__(self, document: Document) -> None:
        rows = [(name_of(str(x.dxf.name)).lower(), x) for x in document.layers]
        self._colours = {name: _named(abs(int(x.dxf.get("color", 7)))) for name, x in rows}
        self._linetypes = {name: str(x.dxf.get("linetype", "Continuous")) for name, x in rows}

    def colour(self, entity: DXFGraphic) -> str:
        """The name of a colour, #rrggbb where it has none; "" where its block says it."""
        if entity.dxf.hasattr("true_color"):
            return f"#{int(entity.dxf.true_color) & 0xFFFFFF:06x}"
        number = int(entity.dxf.get("color", BY_LAYER)) if entity.dxf.is_supported("color") else BY_LAYER
        if number == BY_LAYER:
            return self._colours.get(_layer(entity), "white")
        return "" if number == BY_BLOCK else _named(abs(number))

    def linetype(self, entity: DXFGraphic) -> str:
        """The name of a line type, "" where lines are drawn through."""
        own = str(entity.dxf.get("linetype", "BYLAYER")) if entity.dxf.is_supported("linetype") else "BYLAYER"
        kind = self._linetypes.get(_layer(entity), "") if own.lower() == "bylayer" else own
        return "" if kind.lower() in CONTINUOUS else kind


def _layer(entity: DXFGraphic) -> str:
    return name_of(str(entity.dxf.get("layer", "0"))).lower()


def _named(number: int) -> str:
    if number in NAMES:
        return NAMES[number]
    return "#{:02x}{:02x}{:02x}".format(*aci2rgb(number)) if 0 < number < BY_LAYER else "white"
