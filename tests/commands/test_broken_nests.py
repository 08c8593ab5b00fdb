"""A nest that cannot be cut: overlaps are told whatever lies in what, and a picture shows them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import strategies as st

from kerfwise.tests.commands.run_cli import kerfwise

SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="400mm" height="400mm" viewBox="0 0 400 400">{}</svg>'
THREE = [(70, 20, 70, 80), (90, 80, 20, 70), (80, 60, 90, 60)]
tens = st.integers(1, 9).map(lambda k: 10 * k)


def test_a_drawing_of_three_is_told_and_drawn(tmp_path: Path) -> None:
    drawn = "".join(
        f'<rect x="{x + k}" y="{400 - y - k - h}" width="{w}" height="{h}"/>' for k, (x, y, w, h) in enumerate(THREE)
    )
    nest = tmp_path / "three.svg"
    nest.write_text(SVG.format(drawn))
    asked = kerfwise("facts", nest)
    assert (asked.code, "--answer overlap=refuse " in asked.err) == (3, True)
    ended = kerfwise("facts", nest, "--answer", "overlap=refuse")
    assert ended.code == 2, ended.err
    assert "overlap" in ended.err or "reaches out of" in ended.err
    for suffix in ("svg", "png", "html"):
        picture = tmp_path / f"picture.{suffix}"
        ended = kerfwise("plot", nest, "-o", picture, "--answer", "overlap=refuse")
        assert (ended.code, ended.err.startswith(f"warning: {nest}: the nest cannot be cut as it is drawn")) == (
            0,
            True,
        )
        assert picture.stat().st_size > 1000
    text = (tmp_path / "picture.svg").read_text(encoding="utf-8")
    assert "cannot be cut as it is drawn" in text
    assert "P1.outer" in text


BROKEN = {
    "its loop without its hole": [[20, 20], [120, 120], [120, 20], [20, 120]],
    "encloses nothing": [[20, 20], [120, 20], [20, 20.0001]],
    "off the sheet": [[20, 20], [520, 20], [520, 120], [20, 120]],
    "over its hole": [[20, 20], [60, 20], [60, 60], [20, 60]],
}


@pytest.mark.parametrize("what", BROKEN)
def test_every_kind_of_wrong_is_drawn(what: str, tmp_path: Path) -> None:
    part = {"id": "A", "outer": BROKEN[what], "holes": [[[50, 30], [70, 30], [70, 50], [50, 50]]]}
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 400, "height": 200}, "parts": [part]}
    (tmp_path / "broken.json").write_text(json.dumps(nest))
    answered = ("--answer", "crossing=largest") if "loop" in what else ()
    assert kerfwise("facts", tmp_path / "broken.json", *answered).code == 2
    for suffix in ("svg", "png"):
        picture = tmp_path / f"picture.{suffix}"
        ended = kerfwise("plot", tmp_path / "broken.json", "-o", picture, *answered)
        assert ended.code == 0, ended.err
        assert "warning: " in ended.err
        assert picture.exists()
