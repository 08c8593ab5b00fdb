"""The letters that text is engraved with."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kerfwise.encoder.readers.lettering import NEWSTROKE, lettering


@pytest.mark.parametrize(
    "text",
    [
        "árvíztűrő tükörfúrógép ÁRVÍZTŰRŐ",
        "Größe Übermaß Ä",
        "Съешь ещё этих мягких французских булок",
        "№ 5 Ωμ½ žščřť łąę",
    ],
)
def test_the_font_has_the_letters_of_shops(text: str) -> None:
    assert lettering(text).lacks == ""
    bare = lettering(text.replace("ű", "u").replace("Ü", "U").replace("ё", "е").replace("ž", "z"))
    assert len(bare.strokes) < len(lettering(text).strokes)  # an accent is strokes of its own


def test_the_font_says_whose_it_is() -> None:
    head = NEWSTROKE.read_text("ascii").splitlines()[0]
    assert "Vladimir Uryvaev" in head
    assert "CC0" in head


def test_a_stroke_closes_where_it_ends_where_it_begins() -> None:
    [ring] = lettering("O").strokes
    assert (ring[0] == ring[-1]).all()
    assert np.ptp(ring[:, 1]) == pytest.approx(1.0)
    assert math.isclose(lettering("HH").width, 2 * 19 / 21)
