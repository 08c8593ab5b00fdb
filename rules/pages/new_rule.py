"""A new rule's three files, made from templates: the rule, the same in MiniZinc, and its cases."""

from __future__ import annotations

import re
from importlib import resources
from pathlib import Path
from string import Template

from kerfwise.encoder.errors import InputError
from kerfwise.rules.registry import RULES

RESERVED = ("new", "page", "test")
FILES = {
    "rule.py.txt": "rules/catalogue/{module}.py",
    "rule.mzn.txt": "rules/minizinc/rules/{module}.mzn",
    "cases.py.txt": "rules/cases/{module}.py",
}
"""Template → where what is made of it goes in a checkout."""


def is_checkout(root: Path) -> bool:
    """Whether there are the sources of kerfwise, and not a copy that an installation has made of them."""
    return (root / "pyproject.toml").is_file() and (root / "rules/catalogue").is_dir()


def new_rule(name: str, root: Path) -> tuple[Path, ...]:
    """Write the files of a rule called `name` into the checkout at `root`, and say which they are.

    Raises
    ------
    InputError
        If the name is not one, is taken, `root` is no checkout of kerfwise, or one of the files is there already.
    """
    _check_name(name)
    module = name.replace("-", "_")
    paths = {template: root / place.format(module=module) for template, place in FILES.items()}
    for path in paths.values():
        if not is_checkout(root) or not path.parent.is_dir():
            raise InputError(
                f"{root} is no source checkout of kerfwise, where rules are written: go to one, or name it with --into"
            )
        if path.exists():
            raise InputError("the file is there already; choose another name, or remove it", file=path)
    words = {"id": name, "module": module, "class_name": module.title().replace("_", "")}
    folder = resources.files(__package__) / "templates"
    for template, path in paths.items():
        text = Template((folder / template).read_text(encoding="utf-8")).substitute(words)
        path.write_text(text, encoding="utf-8", newline="\n")
    return tuple(paths.values())


def _check_name(name: str) -> None:
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name):
        raise InputError(f"{name!r} is not a name of a rule: expected small letters and digits such as long-parts-last")
    if name in RESERVED:
        raise InputError(f"a rule cannot be called {name!r}: `kerfwise rules {name}` means something else")
    if name in RULES:
        raise InputError(f"there is a rule {name!r} already; see `kerfwise rules {name}`")
