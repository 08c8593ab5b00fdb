"""Whoever reads the page with other means finds all of it: axe in each state, contrast in both looks, single keys."""

from __future__ import annotations

import re
from typing import Any

import pytest

from kerfwise.languages import texts
from kerfwise.rules.registry import RULES
from kerfwise.tests.apps.viewer.page.conftest import Open
from kerfwise.tests.apps.viewer.page.seen import Seen
from kerfwise.tests.tools.amount import few, rows
from kerfwise.tests.tools.axe import findings

pytestmark = [pytest.mark.slow, pytest.mark.browser]

LOOKS = pytest.mark.parametrize(
    ("scheme", "by_hand"), rows([("light", False), ("dark", True), ("dark", False), ("light", True)])
)


def dressed(seen: Seen, by_hand: bool) -> None:
    """Give the page the other look by its button."""
    if by_hand:
        seen.page.click("#look")


@pytest.mark.parametrize("wide", few([1400, 390, 1024]))
@LOOKS
def test_axe_finds_nothing_in_any_state(look: Open, wide: int, scheme: str, by_hand: bool) -> None:
    seen = look("16", wide, scheme)
    dressed(seen, by_hand)
    found = {"page": findings(seen.page)}
    seen.page.keyboard.press("n")
    for tab in seen.page.locator("#tabs [role=tab]:visible").all():
        tab.click()
        found[tab.inner_text()] = findings(seen.page)
    seen.page.fill("#search", "part")
    found["search"] = findings(seen.page)
    seen.page.evaluate("document.activeElement.blur()")
    seen.page.click("#heat")
    found["heat"] = findings(seen.page)
    for button in ("keys-button", "words-button"):
        seen.page.click(f"#{button}")
        found[button] = findings(seen.page)
        seen.page.keyboard.press("Escape")
    assert {state: said for state, said in found.items() if said} == {}


@pytest.mark.parametrize("name", ["bare", "compared"])
def test_axe_finds_nothing_without_a_plan_and_with_two(look: Open, name: str) -> None:
    assert findings(look(name).page) == []


@LOOKS
def test_what_is_written_on_the_drawing_stands_out(look: Open, scheme: str, by_hand: bool) -> None:
    """Inks of texts and thin lines on every ground that they lie on: 4.5 to 1 for texts, 3 to 1 for lines."""
    seen = look("bare", 1400, scheme)
    dressed(seen, by_hand)
    palette = seen.page.evaluate("(({ ink, zones }) => ({ ink, zones }))(window.kerfwise.stages[0].palette)")
    ink, grounds = palette["ink"], [*palette["zones"], palette["ink"]["part"], palette["ink"]["sheet"]]
    low = [
        (name, ground, round(contrast(ink[name], ground), 2))
        for names, least in ((("text",), 4.5), (("outer", "hole", "mark", "slit", "scrap", "pierce", "unkept"), 3.0))
        for name in names
        for ground in grounds
        if contrast(ink[name], ground) < least
    ]
    assert low == []
    assert seen.page.evaluate("getComputedStyle(document.documentElement).colorScheme") == (
        "light dark" if not by_hand else {"light": "dark", "dark": "light"}[scheme]
    )


def contrast(one: str, other: str) -> float:
    """By WCAG 2: 1 for the same colour, 21 for black on white."""
    low, high = sorted(map(_luminance, (one, other)))
    return (high + 0.05) / (low + 0.05)


def _luminance(colour: str) -> float:
    channels = [int(channel) / 255 for channel in re.findall(r"\d+", colour)]
    red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def test_contrast_is_that_of_the_standard() -> None:
    assert contrast("rgb(0, 0, 0)", "rgb(255, 255, 255)") == pytest.approx(21)
    assert contrast("rgb(119, 119, 119)", "rgb(255, 255, 255)") == pytest.approx(4.48, abs=0.01)


def test_single_keys_can_be_switched_off(look: Open) -> None:
    """WCAG 2.1.4: then they work on a drawing that has the focus only."""
    seen = look("16")
    seen.page.keyboard.press("n")
    assert seen.chosen
    seen.page.keyboard.press("Escape")
    seen.page.keyboard.press("?")
    seen.page.uncheck("#single-keys")
    seen.page.keyboard.press("Escape")
    seen.page.evaluate("document.activeElement.blur()")
    seen.page.keyboard.press("n")
    assert seen.chosen == ""
    seen.page.focus("#stages canvas")
    seen.page.keyboard.press("n")
    assert seen.chosen


def test_without_javascript_there_is_a_picture(look: Open, page_file: Any, browser: Any) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(page_file("16").as_uri())
    picture = page.locator("noscript img, body > img")
    assert picture.first.bounding_box()["width"] > 100
    assert "every hard rule holds" in page.locator("body").inner_text()
    context.close()


@pytest.mark.parametrize(
    ("language", "said"),
    rows([("de-DE", "jede harte Regel"), ("ru-RU", "жёсткие правила"), ("es-ES", "reglas estrictas")]),
)
def test_it_speaks_the_browsers_language(page_file: Any, browser: Any, language: str, said: str) -> None:
    context = browser.new_context(locale=language, viewport={"width": 1400, "height": 900})
    page = context.new_page()
    page.goto(page_file("16").as_uri())
    page.wait_for_selector("[data-ready=yes]", state="attached")
    assert said in page.locator("#verdict").inner_text()
    assert page.locator("html").get_attribute("lang") == language[:2]
    page.click("#tab-rules")
    sentence = texts(language[:2]).tr(RULES["inner-before-outer"].sentence)
    assert page.locator("[data-rule=inner-before-outer] button").get_attribute("title") == sentence
    page.select_option("#language", "en")
    page.wait_for_selector("html[lang=en][data-ready=yes]", state="attached")
    assert page.locator("#verdict").inner_text().endswith("every hard rule holds")
    context.close()
