"""What a DXF file shows and kerfwise does not read: writing, dimensions, fillings, points, what nobody knows."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass, field

from ezdxf.entities.dxfentity import DXFEntity, DXFTagStorage
from ezdxf.entities.mtext import MText
from ezdxf.entities.text import Text

from kerfwise.encoder.nest import Note

from .dxf_text import name_of
from .layers import Layers, counted
from .writing import writing_note

WRITING = frozenset(("TEXT", "MTEXT", "RTEXT", "ATTRIB", "ARCALIGNEDTEXT"))
NO_LINES = WRITING | frozenset(
    (
        *("ATTDEF", "SHAPE", "TOLERANCE", "ACAD_TABLE", "POINT", "RAY", "XLINE", "VIEWPORT"),
        *("DIMENSION", "ARC_DIMENSION", "LARGE_RADIAL_DIMENSION", "LEADER", "MLEADER", "MULTILEADER"),
        *("HATCH", "MPOLYGON", "SOLID", "TRACE", "WIPEOUT", "IMAGE", "OLE2FRAME", "PDFUNDERLAY"),
    )
)
"""Types of entity that are no lines one could cut along."""


@dataclass(slots=True)
class Unread:
    """What was passed over on the way.

    `types` counts by entity type and layer, `hidden_layers` by layer; `writing` are the texts on each layer;
    `flattened` counts blocks whose height was scaled by 0.
    """

    types: Counter[tuple[str, str]] = field(default_factory=Counter)
    hidden_layers: Counter[str] = field(default_factory=Counter)
    writing: defaultdict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    flattened: int = 0

    def add(self, entity: DXFEntity, layer: str) -> None:
        """Count an entity that is not read."""
        if entity.dxftype() in WRITING:
            self.writing[layer].append(_text(entity))
        else:
            self.types[entity.dxftype(), layer] += 1

    def hidden(self, entity: DXFEntity, layer: str) -> None:
        """Count an entity that is not shown, if it could have been cut."""
        if entity.dxftype() not in NO_LINES:
            self.hidden_layers[layer] += 1

    def notes(self, layers: Layers) -> list[Note]:
        """A word on each, but not on what is no line on layers that are left out anyway."""
        notes = []
        seen = Counter[str]()
        for (kind, layer), count in self.types.items():
            if kind not in NO_LINES or layers.use([layer]).purpose != "ignore":
                seen[kind] += count
        if seen:
            listed = ", ".join(f"{n} {kind}" for kind, n in sorted(seen.items()))
            text = f"left out, as they are not lines one can cut: {listed}; explode them in CAD if they are to be cut"
            notes.append(Note("warning", text))
        notes += [
            writing_note(texts, layer, purpose)
            for layer, texts in sorted(self.writing.items())
            if (purpose := layers.use([layer]).purpose) != "ignore"
        ]
        if self.flattened:
            blocks = f"{self.flattened} blocks are" if self.flattened > 1 else "1 block is"
            notes.append(Note("warning", f"{blocks} inserted with a height scale of 0: read as flat"))
        if self.hidden_layers:
            hidden = counted(self.hidden_layers.elements())
            notes.append(Note("warning", f"left out, as they are invisible or their layer is off or frozen: {hidden}"))
        return notes


def layer_of(entity: DXFEntity) -> str:
    """The layer of an entity, also of a type that nobody knows, as its author wrote it."""
    if isinstance(entity, DXFTagStorage):
        return name_of(next((str(tag.value) for part in entity.xtags.subclasses for tag in part if tag.code == 8), "0"))
    return name_of(str(entity.dxf.get("layer", "0"))) if entity.dxf.is_supported("layer") else "0"


def _text(entity: DXFEntity) -> str:
    if isinstance(entity, MText | Text):
        return str(entity.plain_text())
    return ""
