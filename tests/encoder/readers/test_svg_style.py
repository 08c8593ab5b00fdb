"""Style sheets and attributes of any length are read at once, or refused."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from kerfwise import InputError, Nest, read_nest


def drawing(body: str, folder: Path) -> Nest:
    page = 'xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100"'
    (folder / "parts.svg").write_text(f"<svg {page}>{body}</svg>", encoding="utf-8")
    return read_nest(folder / "parts.svg", sheet_mm=(100, 100))


@pytest.mark.parametrize(
    "sheet", ["a{" * 27_500, "/*" * 27_500, "a" * 300_000, "a{}" * 20_000, "a " * 30_000 + "{}", "{" * 55_000]
)
def test_a_style_sheet_of_nonsense_is_read_at_once(sheet: str, tmp_path: Path) -> None:
    """The library's patterns took minutes over some of these."""
    begun_s = time.process_time()
    drawn = drawing(f"<style>{sheet}</style><rect width='9' height='9'/>", tmp_path)
    assert (len(drawn.parts), time.process_time() - begun_s < 2.0) == (1, True)


def test_a_style_sheet_still_hides_what_it_hides(tmp_path: Path) -> None:
    sheet = "/* a{ */ .seen{} .gone /* x */ {display:none} .b{"
    body = f"<style>{sheet}</style><rect class='gone' width='9' height='9'/><rect class='seen' width='5' height='5'/>"
    (part,) = drawing(body, tmp_path).parts
    assert part.polygon.area == pytest.approx(25)


def test_an_endless_attribute_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="<rect> 'r' cannot be read: its transform has 60000 characters"):
        drawing(f"<rect id='r' transform='{'rotate(1) ' * 6000}' width='9' height='9'/>", tmp_path)
