"""A picture: its bytes, what kind they are, and how a notebook shows them."""

from __future__ import annotations

import base64
import html
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.files import write_files

PictureKind = Literal["svg", "png", "html"]


@dataclass(frozen=True, eq=False, slots=True)
class Picture:
    """A drawing; the last line of a notebook's cell shows it.

    Attributes
    ----------
    content
        The content of its file.
    kind
        svg, png, or html for a page that plays the cuts in order.

    Examples
    --------
    >>> Picture(b"<svg/>", "svg").html()
    '<img style="max-width: 100%" src="data:image/svg+xml;base64,PHN2Zy8+"/>'
    """

    content: bytes
    kind: PictureKind

    def save(self, path: str | Path) -> Path:
        """Write the file, whole or not at all.

        Raises
        ------
        InputError
            If it cannot be written, or its name ends otherwise than in the kind of the picture.
        """
        path = Path(path)
        if path.suffix.lower() != f".{self.kind}":
            raise InputError(f"this picture is of type {self.kind}: the file name must end in .{self.kind}", file=path)
        write_files({path: self.content})
        return path

    def html(self) -> str:
        """The picture as a piece of a web page."""
        if self.kind == "html":
            page = html.escape(self.content.decode("utf-8"))
            return f'<iframe srcdoc="{page}" style="width: 100%; height: 40em; border: 0"></iframe>'
        kind = {"svg": "svg+xml", "png": "png"}[self.kind]
        data = base64.b64encode(self.content).decode("ascii")
        return f'<img style="max-width: 100%" src="data:image/{kind};base64,{data}"/>'

    def _repr_html_(self) -> str:
        return self.html()

    def __repr__(self) -> str:
        return f"<{self.kind} picture, {len(self.content)} bytes>"
