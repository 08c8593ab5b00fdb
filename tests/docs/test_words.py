"""Pages, messages and docstrings are in plain English, and use one word for one thing."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import kerfwise

ROOT = Path(kerfwise.__file__).resolve().parent
PACKAGE = ("encoder", "rules", "models", "postproc", "jobs", "apps", "commands")
INSTEAD = {
    r"lest": "so that … not",
    r"foret(ell|ells|old)": "predict",
    r"speaks? of": "is about",
    r"of use": "useful",
    r"by then": "already, or before it",
    r"shall": "must, or should",
    r"lawless": "unlawful",
    r"(whence|thence|whereof|thereof|hitherto|heretofore|henceforth|nought|betimes|whilst)": "a word of today",
    r"lets? (it|them|these|those|exactly these|\w+ pairs)? ?go": "relax (docs/glossary.md)",
    r"(metal|slug|waste) (that|which) has (just )?dropped": "fallen out (docs/glossary.md)",
}
"""What is not said, and what is said instead."""
ANY = re.compile(rf"\b({'|'.join(INSTEAD)})\b", re.IGNORECASE)


def texts() -> Iterator[tuple[str, str]]:
    """Every page, and every string of the package, docstrings included, each with its place."""
    for page in [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]:
        yield str(page.relative_to(ROOT)), page.read_text(encoding="utf-8")
    for module in (path for folder in PACKAGE for path in (ROOT / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield f"{module.relative_to(ROOT)}:{node.lineno}", node.value


def found(text: str) -> list[str]:
    """The words of a text that are not said, each with what to say instead."""
    flat = " ".join(text.split())
    if not ANY.search(flat):
        return []
    hits = ((re.search(rf"\b{words}\b", flat, re.IGNORECASE), better) for words, better in INSTEAD.items())
    return [f"'{hit[0]}': say {better}" for hit, better in hits if hit]


@pytest.mark.slow
def test_no_page_and_no_message_strains() -> None:
    wrong = [f"{place}: {what}" for place, text in texts() for what in found(text)]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    "text",
    ["Off, lest it run.", "what these prices\nforetell", "`--relax` lets\nthese go", "over metal that has dropped"],
)
def test_a_strained_sentence_is_found(text: str) -> None:
    assert len(found(text)) == 1


def test_a_plain_sentence_passes() -> None:
    assert found("An order that is dropped lets the others hold. At least 5 mm; let the torch go home.") == []


def test_the_glossary_has_the_words_for_where_a_rule_does_not_hold() -> None:
    page = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
    section = page[page.index("## Where a rule does not hold") :]
    for word in ("exempt", "excuse", "dropped", "relaxed"):
        assert f"\n| {word} |" in section
    for word in ("broken", "excused", "exception", "gives way", "left out", "unpriced"):
        assert f"*{word}*" in section.replace("\n", " ")
