"""Message catalogues: texts are collected from the code, the translations kept, and what programs read is made anew.

Usage: python -m kerfwise.tests.tools.catalogues

A text stands in the code in English, as `tr("…")` or `trn("one", "many", n)`, and in the page's frame as it is; the
sentences of shipped rules are texts, too, and those that the page knows by their shape (`sentence` in `sentences.js`).
What has no translation yet is listed: write it into `languages/XX.po`, with an editor of catalogues or by hand, and run
this again. Beside each catalogue stand its compiled forms: `XX.mo` for Python, and as JSON the texts of every page
(`XX.page.json`) and those of the viewer besides (`XX.viewer.json`).
"""

from __future__ import annotations

import io
import json
import re
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

from babel.messages.catalog import Catalog, Message
from babel.messages.extract import extract
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po

from kerfwise.languages import ENGLISH, LANGUAGES
from kerfwise.postproc import report
from kerfwise.rules.registry import RULES

ROOT = Path(report.__file__).parents[2]
FOLDER = ROOT / "languages"
PAGE, HANDS, SENTENCES = "apps/viewer/page/page_files", "apps/viewer/serve/hands", "rules/catalogue"
PYTHON = (
    "apps/work_sheets/work_sheet.py",
    "apps/work_sheets/sheet_parts.py",
    "postproc/report/legend.py",
    "apps/work_sheets/paper.py",
)
KEYWORDS: dict[str, Any] = {"tr": None, "trn": (1, 2)}
OPTIONS = {"parse_template_string": True}
_SILENT = (["style"], ["script"], ["title"])
NAMED = re.compile(r"\{\w*\}")


class _Frame(HTMLParser):
    """The texts of a frame: what stands between its tags, and what some attributes say."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self._inside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what its attributes say."""
        self._inside.append(tag)
        self.found += [value for name, value in attrs if name in ("title", "aria-label", "placeholder") and value]

    def handle_data(self, data: str) -> None:
        """Note a text that has letters."""
        bare = data.strip()
        if re.search(r"[A-Za-z]{2}", bare) and "@" not in bare and self._inside[-1:] not in _SILENT:
            self.found.append(bare)


def template() -> Catalog:
    """All texts of the code, each with the files that say it."""
    made = Catalog(project="kerfwise")
    for name, text in _said():
        made.add(text, locations=[(name, 0)])
    return made


def _said() -> Iterator[tuple[str, str | tuple[str, str]]]:
    for folder in (PAGE, HANDS):
        for path in sorted((ROOT / folder).iterdir()):
            name = f"{folder}/{path.name}"
            if path.suffix == ".js" and path.name != "say.js":
                yield from ((name, text) for text in (*_of_code(path, "javascript"), *sentences(path)))
            elif path.suffix == ".html":
                frame = _Frame()
                frame.feed(path.read_text(encoding="utf-8"))
                yield from ((name, text) for text in dict.fromkeys(frame.found))
    for name in PYTHON:
        yield from ((name, text) for text in _of_code(ROOT / name, "python"))
    yield from ((f"{SENTENCES}/{name}", rule.sentence) for name, rule in RULES.items())


def sentences(path: Path) -> list[str]:
    """The sentences of the server that a module lets the page translate: `sentence("…", "…");`."""
    calls = re.findall(r"^sentence\(\n(.*?)^\);", path.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    return [text for call in calls for text in re.findall(r'^  "(.*)",$', call, re.MULTILINE)]


def _of_code(path: Path, kind: str) -> Iterator[str | tuple[str, str]]:
    with path.open("rb") as file:
        for _, text, _, _ in extract(kind, file, KEYWORDS, options=OPTIONS):
            yield text if isinstance(text, str) else (text[0], text[1])


def kept(language: str) -> Catalog:
    """The catalogue of a language as it is."""
    path = FOLDER / f"{language}.po"
    if not path.exists():
        return Catalog(locale=language, project="kerfwise")
    with path.open("rb") as file:
        return read_po(file, locale=language)


def renewed(language: str) -> Catalog:
    """The catalogue with all texts of the code, and none that is said no more."""
    made = kept(language)
    made.update(template(), no_fuzzy_matching=True)
    made.obsolete.clear()
    return made


def compiled(made: Catalog) -> dict[str, bytes]:
    """The files that are made of a catalogue, by name; the same texts give the same bytes."""
    language = str(made.locale)
    made.creation_date = made.revision_date = datetime(2026, 1, 1, tzinfo=UTC)
    po, mo = io.BytesIO(), io.BytesIO()
    write_po(po, made, width=120, sort_output=True)
    write_mo(mo, made)
    whole = [message for message in made if message.id and _whole(message)]
    page = {_key(m): m.string for m in whole if any(_in(m, PAGE, SENTENCES))}
    viewer = {_key(m): m.string for m in whole if any(_in(m, HANDS)) and _key(m) not in page}
    return {
        f"{language}.po": po.getvalue(),
        f"{language}.mo": mo.getvalue(),
        f"{language}.page.json": _json(page),
        f"{language}.viewer.json": _json(viewer),
    }


def _whole(message: Message) -> bool:
    return all(message.string) if isinstance(message.string, tuple | list) else bool(message.string)


def _key(message: Message) -> str:
    return message.id if isinstance(message.id, str) else message.id[0]


def _in(message: Message, *folders: str) -> Iterator[bool]:
    return (name.startswith(folders) for name, _ in message.locations)


def _json(texts: dict[str, Any]) -> bytes:
    return (json.dumps(texts, ensure_ascii=False, indent=0, sort_keys=True) + "\n").encode()


def wrong_in(made: Catalog) -> list[str]:
    """What a catalogue lacks: texts without a translation, and those whose `{names}` are others than in English."""
    wrong = []
    for message in made:
        if not message.id:
            continue
        forms = message.string if isinstance(message.string, tuple | list) else (message.string,)
        wanted = set(NAMED.findall(message.id if isinstance(message.id, str) else message.id[1]))
        if not all(forms) or (isinstance(message.id, tuple) and len(forms) != made.num_plurals):
            wrong.append(f"{made.locale}: not translated: {message.id!r}")
        for form in filter(None, forms):
            left = set(NAMED.findall(form)) ^ wanted
            if left - ({"{n}"} if isinstance(message.id, tuple) else set()):
                wrong.append(f"{made.locale}: {message.id!r}: {form!r} has other names in braces")
    return wrong


def main() -> int:
    """Renew all catalogues; 1 where one lacks something."""
    wrong = []
    for language in LANGUAGES:
        if language == ENGLISH:
            continue
        made = renewed(language)
        for name, content in compiled(made).items():
            (FOLDER / name).write_bytes(content)
        wrong += wrong_in(made)
    print("\n".join(wrong) or "every text is translated")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
