"""Which text is the source of each rule: `kerfwise rules --texts`, and the end of docs/rules.md."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule

HEAD = """\
## Which text counts

A rule may stand in several texts. This is which of them engines obey, and which one the check judges by.

- **A shipped rule** is stated by its Python, in `rules/catalogue`, for every engine but `minizinc`. So nobody needs
  MiniZinc who has no model files. Its file in `rules/minizinc/rules` is the same rule by other means, for the engine
  `minizinc` and for rule authors to read and to copy. The check judges by neither: it measures, by `violations()`. All
  three have to admit the same plans: `kerfwise rules test NAME` compares them on every plan of small nests, and
  `python -m kerfwise.benchmarks.flattened` compares the statements of both texts [one by one](flattened.md).
- **A plant's file in MiniZinc** is one text for all: engines obey what it states, and the check judges by it, over
  facts that it measures itself. That holds for a new rule, and for a file in the place of a shipped rule: only the
  strength, the options and the ways to cut of that one stay.
- **A plant's rule in Python** has two halves, as shipped rules do, and no text in MiniZinc.

No shipped rule could do with fewer texts. Without its Python every plan would need MiniZinc; without its file the
engine `minizinc`, which is there to doubt the others, would have nothing of its own to go by.

| rule | source of what it states | the same in MiniZinc | may a plant's file take its place |
|---|---|---|---|"""


def texts_page() -> str:
    """Which of its texts is a rule's source, and whose place a file may take, in Markdown."""
    return "\n".join([HEAD, *_rows()]) + "\n"


def place_of_file(rule: Rule[Any]) -> str:
    """Whether a plant's file may take the place of a shipped rule, as a sentence."""
    if rule.takes_no_file:
        return f"No file of a plant takes its place: {rule.takes_no_file}."
    return f"A plant's file `{rule_file(rule.id).name}` may take its place."


def _rows() -> Iterator[str]:
    for name, rule in RULES.items():
        file = rule_file(name)
        twin = f"`{file.name}`" if file.exists() else "none"
        place = f"no: {rule.takes_no_file}" if rule.takes_no_file else "yes"
        yield f"| `{name}` | `{name.replace('-', '_')}.py` | {twin} | {place} |"
