"""A new rule's files, made from templates: three in a checkout of kerfwise, or one of a plant's own, with its cases."""

from __future__ import annotations

import contextlib
from importlib import resources
from pathlib import Path
from string import Template

from kerfwise.encoder.contents import is_file, is_folder, is_there
from kerfwise.encoder.errors import InputError
from kerfwise.rules.outside.names import wrong_name
from kerfwise.rules.registry import RULES

FILES = {
    "rule.py.txt": "rules/catalogue/{module}.py",
    "rule.mzn.txt": "rules/minizinc/rules/{module}.mzn",
    "cases.py.txt": "rules/cases/{module}.py",
}
"""Template → where what is made of it goes in a checkout."""
OF_A_PLANT = {"python": ("outside.py.txt", ".py"), "mzn": ("outside.mzn.txt", ".mzn")}
"""Language → the template of a rule of a plant's own, and the file's ending."""


def is_checkout(root: Path) -> bool:
    """Whether there are the sources of kerfwise, and not a copy that an installation has made of them."""
    return is_file(root / "pyproject.toml") and is_folder(root / "rules/catalogue")


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
        if not is_checkout(root) or not is_folder(path.parent):
            raise InputError(
                f"{root} is no source checkout of kerfwise: say --python or --mzn for a rule of your own in any "
                "folder, or name the checkout with --into"
            )
        if is_there(path):
            raise InputError("the file is there already; choose another name, or remove it", file=path)
    try:
        for template, path in paths.items():
            _write(template, path, name)
    except OSError as error:
        for made in paths.values():
            with contextlib.suppress(OSError):
                made.unlink()
        raise InputError(f"cannot write: {error.strerror}", file=path) from None
    return tuple(paths.values())


def new_outside_rule(name: str, language: str, folder: Path) -> Path:
    """Write a rule of a plant's own called `name`, with its cases, as one file in a folder; the file.

    Raises
    ------
    InputError
        If the name is not one or is taken, the file is there already, or nothing can be written there.
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
