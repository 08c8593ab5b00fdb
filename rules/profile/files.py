"""Where profiles stand: those that come with kerfwise, by name, and others in files; their bytes and their text."""

from __future__ import annotations

from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from kerfwise.encoder.contents import MOST_BYTES_OF_YAML, contents, is_there
from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.suggest import nearest, unknown


def shipped_profiles() -> dict[str, Traversable]:
    """Name → file of the profiles that come with kerfwise, sorted."""
    folder = resources.files(__package__) / "shipped"
    found = {f.name.removesuffix(".yaml"): f for f in folder.iterdir() if f.name.endswith(".yaml")}
    return dict(sorted(found.items()))


def profile_text(name_or_path: str | Path) -> str:
    """The text of the shipped profile of that name, or of the one in that file, comments and all.

    Raises
    ------
    InputError
        If there is none, or it is not UTF-8.
    """
    file, _, content = content_of(str(name_or_path), Path())
    return decoded(content, file)


def decoded(content: bytes, file: str) -> str:
    """The text of a profile's bytes; an InputError if they are not UTF-8."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"not a profile: the file is not UTF-8 text ({error.reason})", file=file) from None


def _meant(path: Path) -> str:
    """A hint at the file beside it that is called nearly so; "" where there is none."""
    try:
        beside = [file.name for file in path.parent.iterdir() if file.suffix in (".yaml", ".yml")]
    except OSError:
        return ""
    guess = None if path.name in beside else nearest(path.name, sorted(beside))
    return f"; did you mean {guess!r}?" if guess else ""


def content_of(name: str, folder: Path) -> tuple[str, str, bytes]:
    """File name, place and bytes of a profile given by shipped name or path."""
    shipped = shipped_profiles()
    if name in shipped:
        return f"kerfwise/rules/profile/shipped/{name}.yaml", str(shipped[name]), shipped[name].read_bytes()
    path = folder / name
    try:
        return str(path), str(path), contents(path, MOST_BYTES_OF_YAML)
    except ValueError as error:  # a NUL, or half a character
        raise InputError(f"cannot read the profile: no file can have this name ({error})", file=path) from None
    except OSError as error:
        if path.suffix or len(Path(name).parts) > 1:
            raise InputError(f"cannot read the profile: {error.strerror}{_meant(path)}", file=path) from None
        beside = Path(f"{path}.yaml")
        hint = f"; there is a file {beside.name}: give its ending too" if is_there(beside) else ""
        raise InputError(unknown("profile", name, shipped) + hint) from None
