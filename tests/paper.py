"""PDF files read back by pdfium: their texts, their size, and how they look."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pypdfium2


class Page:
    """One page: its texts, its size in points, and its picture."""

    def __init__(self, page: pypdfium2.PdfPage) -> None:
        self.text: str = page.get_textpage().get_text_range().replace("\r\n", "\n")
        self.size: tuple[float, float] = page.get_size()
        self._page = page

    def picture(self, dpi: int) -> npt.NDArray[np.uint8]:
        """Rows of pixels, each red, green, blue."""
        return np.asarray(self._page.render(scale=dpi / 72).to_pil().convert("RGB"))

    def box(self, text: str) -> tuple[float, float, float, float]:
        """Left, bottom, right and top of the first place where a text stands, in points from the lower left."""
        page = self._page.get_textpage()
        found = page.search(text).get_next()
        assert found is not None, f"{text!r} is not on the page"
        boxes = np.array([page.get_charbox(found[0] + k) for k in range(found[1])])
        left, bottom = boxes[:, :2].min(axis=0)
        right, top = boxes[:, 2:].max(axis=0)
        return float(left), float(bottom), float(right), float(top)


def pages_of(made: str | Path | bytes) -> list[Page]:
    """The pages of a PDF, given as a file or as its bytes."""
    return [Page(page) for page in pypdfium2.PdfDocument(made)]
