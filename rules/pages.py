"""The pages of the rules, made from the rules themselves, and the files that a new rule starts from."""

from __future__ import annotations

import contextlib
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import is_file, is_folder, is_there
from kerfwise.encoder.nearest_name import unknown
from kerfwise.rules.flat.model_file import shipped_text
from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.outside.plugin_classes import wrong_name

from .registry import RULES
from .rule import Rule, Strength

if TYPE_CHECKING:
    from kerfwise.rules.profile.active_rules import ActiveRules


# The pages of the rules, made from the rules themselves: `python -m kerfwise.rules.pages > docs/rules.md`.


def _relaxing_order() -> str:
    softest, *others = sorted((rule for rule in RULES.values() if rule.gives_way), key=lambda rule: -rule.gives_way)
    return ", then ".join([f"`{softest.id}` gives way first", *(f"`{rule.id}`" for rule in others)])


INTRODUCTION = f"""\
# Rules

Made from the rules' own docstrings by `python -m kerfwise.rules.pages > docs/rules.md`.

A profile makes each rule `hard`, `soft` (breaking it once costs its weight, in idle travel) or `off`, and sets its
options. Where hard order rules contradict each other or a lock, {_relaxing_order()};
every order that is dropped is listed in the plan with the cycle it closes, or with the locked position that leaves no
room for it. All others must hold, or there is no plan.
"""


@dataclass(frozen=True, slots=True)
class RuleRow:
    """One rule as a profile has it."""

    id: str
    strength: Strength
    weight: float | None
    sentence: str
    source: str
    from_where: str = ""


def rule_table(profile: ActiveRules) -> list[RuleRow]:
    """Every rule with the strength that the profile gives it: the catalogue by id, then those from outside and its own.

    `from_where` names the file or the package that has brought a rule.
    """
    own = {rule.id: rule for rule in profile.own_rules}
    return [
        RuleRow(name, setting.strength, setting.weight, rule.sentence, rule.source, _from_where(rule))
        for name, rule in profile.rulebook().items()
        for setting in (own[name] if name in own else profile.rules[name],)
    ]


def _from_where(rule: Rule[Any]) -> str:
    if not rule.brought:
        return ""
    replaces = rule.stands_in is not None and rule.stands_in.in_place_of_shipped
    return f" ({rule.brought}{', in place of the shipped rule' if replaces else ''})"


def rule_page(id: str, known: Mapping[str, Rule[Any]] = RULES) -> str:
    """The page of one rule, in Markdown; `known` are the rules that there are.

    Raises InputError if there is no rule of that id, with the nearest.

    Examples
    --------
    >>> print(rule_page("hull-before").splitlines()[0])
    # hull-before
    """
    if id not in known:
        raise InputError(unknown("rule", id, known))
    rule = known[id]
    default = f"soft, {LENGTH.write(rule.default_weight)}" if rule.default == "soft" else rule.default
    lines = [
        f"# {rule.id}",
        "",
        rule.page(),
        "",
        "## Settings",
        "",
        f"Strength: {' or '.join(rule.strengths)} (default {default}). Source: {rule.source.rstrip('.')}.",
    ]
    if rule.brought:
        lines[-1] += f" Brought by {rule.brought}."
    else:
        lines += ["", place_of_file(rule)]
    return "\n".join([*lines, *_options(rule)]) + "\n"


def _options(rule: Rule[Any]) -> list[str]:
    options = options_of(rule.Options)
    if not options:
        return []
    rows = [f"| `{o.key}` | `{o.kind.write(o.default)}` | {o.help} | {o.kind.expected()} |" for o in options]
    return ["", "| option | default | what | values |", "|---|---|---|---|", *rows]


def all_pages() -> str:
    """The whole catalogue as one Markdown document: a table, then every page."""
    rows = [f"| [{name}](#{name}) | {rule.default} | {rule.sentence} |" for name, rule in RULES.items()]
    table = "\n".join(["| rule | default | what it asks |", "|---|---|---|", *rows])
    pages = [_with_picture(name, re.sub("^#", "##", rule_page(name), flags=re.MULTILINE)) for name in RULES]
    return "\n".join([INTRODUCTION, table, "", *pages, texts_page()])


def _with_picture(name: str, page: str) -> str:
    """The page with its picture above the settings."""
    picture = f"../rules/catalogue/{name.replace('-', '_')}/picture.svg"
    return page.replace("\n### Settings\n", f"\n![{name}, wrong and right]({picture})\n\n### Settings\n", 1)


# Which text is the source of each rule: `kerfwise rules --texts`, and the end of docs/rules.md.

HEAD = """\
## Which text counts

A rule may stand in several texts. This is which of them engines obey, and which one the check judges by.

- **A shipped rule** is stated by its Python, in `rules/catalogue`, for every engine but `minizinc`. So nobody needs
  MiniZinc who has no model files. The file in its folder is the same rule by other means, for the engine
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
        yield f"| `{name}` | `{name.replace('-', '_')}/__init__.py` | {twin} | {place} |"


# A new rule's files, made from templates: three in a checkout of kerfwise, or one of a plant's own, with its cases.

FILES = {
    "rule.py.txt": "rules/catalogue/{module}/__init__.py",
    "rule.mzn.txt": "rules/catalogue/{module}/{module}.mzn",
    "cases.yaml.txt": "rules/catalogue/{module}/cases.yaml",
}
"""Template → where what is made of it goes in a checkout."""
OF_A_PLANT = {"python": ("outside.py.txt", ".py"), "mzn": ("outside.mzn.txt", ".mzn")}
"""Language → the template of a rule of a plant's own, and the file's ending."""


def is_checkout(root: Path) -> bool:
    """Whether there are the sources of kerfwise, and not a copy that an installation has made of them."""
    return is_file(root / "pyproject.toml") and is_folder(root / "rules/catalogue")


def new_rule(name: str, root: Path) -> tuple[Path, ...]:
    """Write the files of a rule called `name` into the checkout at `root`, and say which they are.

    Raises InputError if the name is not one, is taken, `root` is no checkout of kerfwise, or one of the files is there
    already.
    """
    _check_name(name)
    module = name.replace("-", "_")
    paths = {template: root / place.format(module=module) for template, place in FILES.items()}
    for path in paths.values():
        if not is_checkout(root):
            raise InputError(
                f"{root} is no source checkout of kerfwise: say --python or --mzn for a rule of your own in any "
                "folder, or name the checkout with --into"
            )
        if is_there(path):
            raise InputError("the file is there already; choose another name, or remove it", file=path)
    try:
        path.parent.mkdir(exist_ok=True)
        for template, path in paths.items():
            _write(template, path, name)
        _add_package(root / "pyproject.toml", module)
    except OSError as error:
        for file in paths.values():
            with contextlib.suppress(OSError):
                file.unlink()
        with contextlib.suppress(OSError):
            path.parent.rmdir()
        raise InputError(f"cannot write: {error.strerror}", file=path) from None
    return tuple(paths.values())


def _add_package(pyproject: Path, module: str) -> None:
    """List the folder of a new rule among the packages of a wheel."""
    above = '    "kerfwise.rules.catalogue",\n'
    text = pyproject.read_text(encoding="utf-8")
    pyproject.write_text(
        text.replace(above, f'{above}    "kerfwise.rules.catalogue.{module}",\n', 1), encoding="utf-8", newline="\n"
    )


def new_outside_rule(name: str, language: str, folder: Path) -> Path:
    """Write a rule of a plant's own called `name`, with its cases, as one file in a folder; the file.

    Raises InputError if the name is not one or is taken, the file is there already, or nothing can be written there.
    """
    _check_name(name)
    template, ending = OF_A_PLANT[language]
    path = folder / f"{name.replace('-', '_')}{ending}"
    if is_there(path):
        raise InputError("the file is there already; choose another name, or remove it", file=path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _write(template, path, name)
    except (OSError, ValueError) as error:  # ValueError: a NUL, or half a character
        words = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"cannot write here: {words}", file=path) from None
    return path


def copied_rule(name: str, like: str, folder: Path) -> Path:
    """Write the MiniZinc text of a shipped rule as the file of a rule `name` in a folder; the file.

    Under the shipped rule's own name it takes its place, and reads what kerfwise gives that rule. Under another it is a
    rule beside it, where it needs no more than the facts. Raises InputError if no shipped rule is called so (the
    nearest is named), it has no such text, takes no file in its place, or its text reads what only that rule is given;
    or the file is there already, or cannot be written.
    """
    if like not in RULES:
        raise InputError(unknown("shipped rule", like, RULES))
    text = shipped_text(like)
    if text is None or RULES[like].takes_no_file:
        why = RULES[like].takes_no_file or "it is not stated over facts"
        raise InputError(f"rule {like} has no text in MiniZinc to copy: {why}")
    stem, shipped = name.replace("-", "_"), like.replace("-", "_")
    if name != like:
        _check_name(name)
        names = re.findall(rf"^[^%\n]*?:\s*({shipped}_\w+)\s*;", text, re.M)
        if names:
            raise InputError(
                f"the text of {like} reads {', '.join(names)}, which only that rule is given: copy it under its own "
                f"name, `kerfwise rules new {like} --like {like}`, and change it there"
            )
        text = re.sub(rf"\b{shipped}_", f"{stem}_", text)
        text = re.sub(rf"^% {like}:", f"% {name}:", text)
    path = folder / f"{stem}.mzn"
    if is_there(path):
        raise InputError("the file is there already; choose another name, or remove it", file=path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")
    except (OSError, ValueError) as error:
        words = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"cannot write here: {words}", file=path) from None
    return path


def _write(template: str, path: Path, name: str) -> None:
    module = name.replace("-", "_")
    words = {"id": name, "module": module, "class_name": module.title().replace("_", "")}
    folder = resources.files(__package__) / "templates"
    text = Template((folder / template).read_text(encoding="utf-8")).substitute(words)
    path.write_text(text, encoding="utf-8", newline="\n")


def _check_name(name: str) -> None:
    if wrong := wrong_name(name):
        raise InputError(wrong)
    if name in RULES:
        raise InputError(f"there is a rule {name!r} already; see `kerfwise rules {name}`")


if __name__ == "__main__":
    sys.stdout.write(all_pages())
