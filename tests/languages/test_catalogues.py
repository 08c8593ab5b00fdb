"""The catalogues are those of the code: every text is translated, names in braces stay, what programs read is fresh."""

from __future__ import annotations

import ast
import io
from collections.abc import Iterator
from typing import Any

import pytest
from babel.messages.catalog import Catalog
from babel.messages.mofile import read_mo

from kerfwise.languages import ENGLISH, LANGUAGES, catalogue, page_texts, texts
from kerfwise.rules.registry import RULES
from kerfwise.tests.tools.catalogues import (
    FOLDER,
    NAMED,
    ROOT,
    compiled,
    kept,
    renewed,
    sentences,
    template,
    wrong_in,
)

OTHERS = pytest.mark.parametrize("language", [name for name in LANGUAGES if name != ENGLISH])
SHAPES = ("apps/viewer/page/page_files/sentences.js", "apps/viewer/serve/hands/messages.js")
ADVICE = "python -m kerfwise.tests.tools.catalogues renews the catalogues and lists what is not translated"


def said(made: Catalog) -> dict[Any, Any]:
    """What is said for each text; a plural by both its forms."""
    pairs = ((m.id if isinstance(m.id, str) else tuple(m.id), m.string) for m in made if m.id)
    return {text: form if isinstance(form, str) else tuple(form or ()) for text, form in pairs}


@OTHERS
def test_every_text_is_translated_with_its_names(language: str) -> None:
    made = renewed(language)
    assert wrong_in(made) == [], ADVICE
    assert said(made) == said(kept(language)), ADVICE


@OTHERS
def test_what_programs_read_is_made_of_the_catalogue(language: str) -> None:
    files = compiled(kept(language))
    assert {name: (FOLDER / name).read_bytes() for name in files if name.endswith(".json")} == {
        name: content for name, content in files.items() if name.endswith(".json")
    }, ADVICE
    mo = said(read_mo(io.BytesIO((FOLDER / f"{language}.mo").read_bytes())))
    assert mo == said(kept(language)), ADVICE


def test_what_is_wrong_in_a_catalogue_is_found() -> None:
    made = Catalog(locale="ru")
    made.add("{n} of {all}", "{n} из {al}")
    made.add("not said", "")
    made.add(("{n} cut", "{n} cuts"), ("{n} рез", "{n} реза"))
    assert len(wrong_in(made)) == 3
    made = Catalog(locale="de")
    made.add("{n} of {all}", "{n} von {all}")
    made.add(("{n} cut", "{n} cuts"), ("ein Schnitt", "{n} Schnitte"))
    assert wrong_in(made) == []


@OTHERS
def test_every_page_says_what_shipped_rules_ask(language: str) -> None:
    said = page_texts()[language]
    assert [name for name, rule in RULES.items() if said.get(rule.sentence, rule.sentence) == rule.sentence] == []


def test_texts_are_collected_from_code_and_frames() -> None:
    found = said(template())
    for text in ("Before and after", "glossary", "filter by name", "nothing proven", "Undo"):
        assert text in found
    assert ("{n} cut", "{n} cuts") in found


def test_sentences_that_the_page_knows_by_their_shape_are_said_by_the_code() -> None:
    """Each piece of them between its names stands in a text of the code: a sentence that was changed there is found."""
    said = "\n".join(_texts_of_code())
    shapes = [text for path in SHAPES for text in sentences(ROOT / path)]
    assert len(shapes) > 90
    pieces = ((text, piece.strip(" ;:,()").removeprefix("more ")) for text in shapes for piece in NAMED.split(text))
    lost = [(text, piece) for text, piece in pieces if len(piece) > 5 and piece not in said]
    assert lost == []


def _texts_of_code() -> Iterator[str]:
    """What Python files say, each text whole, its values as one sign that no sentence has."""
    for folder in ("rules", "jobs", "models", "apps", "encoder"):
        for path in (ROOT / folder).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.JoinedStr):
                    yield "".join(str(one.value) if isinstance(one, ast.Constant) else "\0" for one in node.values)
                elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                    yield node.value
    for path in ROOT.glob("rules/catalogue/*/cases.yaml"):  # whole, where the code puts a sentence together
        yield " ".join(path.read_text(encoding="utf-8").split())


def test_a_page_has_its_own_texts_and_the_viewer_more() -> None:
    page, viewer = page_texts(), page_texts("viewer")
    assert page["de"]["every hard rule holds"] == "jede harte Regel eingehalten"
    assert not set(page["ru"]) & set(viewer["ru"])
    assert "Before and after" not in {**page["de"], **viewer["de"]}
    assert len(page["ru"]["{n} cut"]) == 3


def test_numbers_of_things_follow_the_language() -> None:
    trn = texts("ru").trn
    assert [trn("{n} cut", "{n} cuts", n).format(n=n) for n in (1, 2, 5, 11, 21)] == [
        "1 рез", "2 реза", "5 резов", "11 резов", "21 рез",
    ]  # fmt: skip
    with pytest.raises(KeyError):
        catalogue("fr")
