"""The pictures of the rules in the docs are those of their cases, and one sees what is wrong and what is right."""

from __future__ import annotations

import re

import numpy as np
import pytest

from kerfwise.postproc.check.torch_run import SENTENCES
from kerfwise.postproc.report.rule_pictures import case_picture, rule_panels
from kerfwise.rules.case import wrong_and_right
from kerfwise.rules.registry import RULES
from kerfwise.rules.run_cases import cases_of
from kerfwise.tests.docs.rule_pictures import FOLDER, pictures
from kerfwise.tests.docs.test_safety_page import _NAME, promises

_LAYER = re.compile(r'<g id="([a-z]+)-1">\n(.*?)</g>\n(?=<g id|</svg>)', re.DOTALL)


def layers(rule: str) -> tuple[dict[str, str], dict[str, str]]:
    """The layers of the two pictures of a rule, wrong and right, as SVG."""
    panels = rule_panels(cases_of(rule))
    wrong, right = (dict(_LAYER.findall(case_picture([panels[word]]))) for word in ("wrong", "right"))
    return wrong, right


def first_points(svg: str) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    path = re.findall(r'd="M([^"Z]*)', svg)[0]
    return np.array([[float(v) for v in point.split(",")] for point in path.split()])


def test_the_pictures_are_current() -> None:
    again = "run python -m kerfwise.tests.docs.rule_pictures"
    made = pictures()
    assert sorted(FOLDER.glob("*/picture.svg")) == sorted(made), again
    for path, text in made.items():
        assert path.read_text(encoding="utf-8") == text, f"{path.parent.name}: {again}"


@pytest.mark.parametrize("rule", RULES)
def test_wrong_and_right_differ_by_more_than_red(rule: str) -> None:
    wrong, right = layers(rule)
    assert "sheet" in wrong
    told = ("texts", "contours", "numbers")
    lines = [{name: svg for name, svg in drawn.items() if name not in told} for drawn in (wrong, right)]
    numbers = [re.findall(r"<circle[^>]*>", drawn["numbers"]) for drawn in (wrong, right)]
    nests = {id(case.nest) for case in wrong_and_right(cases_of(rule)) if case}
    assert lines[0] != lines[1] or numbers[0] != numbers[1] or len(nests) == 2


def test_directions_are_drawn_as_they_are_cut() -> None:
    for drawn, up in zip(layers("cut-direction"), (False, True), strict=True):
        # The square enters at its lower left corner: clockwise it is left upwards, the other way round to the right.
        heads = [first_points(svg) for svg in re.findall(r'<path[^>]*data-cut="3"/>', drawn["directions"])]
        tip, across, _, other = heads[0]
        dx, dy = tip - (across + other) / 2
        assert (dy < -1 and abs(dx) < 0.1) if up else (dx > 1 and abs(dy) < 0.1)


def test_start_side_tails_tabs_and_heat_are_drawn() -> None:
    wrong, right = layers("start-side")
    assert first_points(wrong["side"])[0][0] < 20 < 400 < first_points(right["side"])[0][0]
    wrong, right = layers("hold-small-parts")
    assert "<path" not in wrong["tabs"]
    assert "<path" in right["tabs"]
    assert "<path" in right["leads"]
    wrong, right = layers("t-max")
    assert ">131 °C<" in wrong["heat"]
    assert ">90 °C<" in right["heat"]


def test_every_rule_is_one_that_the_check_judges() -> None:
    rules = {name for _, _, names, _ in promises() for name in _NAME.findall(names)}
    assert rules <= {*SENTENCES, *RULES}
    assert all(_NAME.findall(names) for _, _, names, _ in promises())
