"""Files that a person names: read up to a size that no good one has, and JSON as strict as the profiles' YAML."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import stat
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from .errors import InputError
from .escape import escape_text
from .nearest_name import unknown

if TYPE_CHECKING:
    from jsonschema import ValidationError


MOST_BYTES = 256_000_000
"""Of nests, plans and programs: those of ten thousand contours have a tenth of it."""
MOST_BYTES_OF_YAML = 1_000_000
"""Of profiles and dialects: shipped ones have a hundredth of it; a megabyte takes seconds to read."""


def read_limited(path: str | Path, most_bytes: int = MOST_BYTES) -> bytes:
    """All bytes of a file. What never ends (a device, a pipe that is fed for ever) is not read to its end.

    Raises InputError if it holds more than `most_bytes`; OSError, ValueError if it cannot be read, or no file can have
    this name.
    """
    expect_readable(path)
    with open(path, "rb") as file:
        data = file.read(most_bytes + 1)
    if len(data) > most_bytes:
        raise InputError(f"holds over {most_bytes // 1_000_000} MB: too large to be what it should be", file=path)
    return data


def read_named(path: str | Path, what: str, most_bytes: int = MOST_BYTES) -> bytes:
    """As `read_limited`; InputError says that `what`, such as "the job file", cannot be read, and why."""
    try:
        return read_limited(path, most_bytes)
    except OSError as error:
        raise InputError(f"cannot read {what}: {error.strerror}", file=path) from None
    except ValueError as error:  # a NUL, or half a character
        raise InputError(f"cannot read {what}: no file can have this name ({error})", file=path) from None


def utf8_text(data: bytes, what: str, file: str | Path | None = None) -> str:
    """The text of a file's bytes, with or without a mark at its beginning; InputError says that it is not `what`."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        wide = data.startswith((b"\xff\xfe", b"\xfe\xff"))
        why = "it is UTF-16: save it as UTF-8" if wide else f"byte {error.start + 1}: {error.reason}"
        raise InputError(f"not {what}: the file is not UTF-8 text ({why})", file=file) from None


_only_within: tuple[str, ...] | None = None


def read_only_within(folders: Sequence[str | Path]) -> None:
    """From now on this process reads files that a person names in these folders only, and regular ones only.

    For a server: what a drawing, a profile or a rule names is another's choice, who must neither be told what other
    files hold, nor have it wait for a pipe.
    """
    global _only_within
    _only_within = tuple(os.path.realpath(folder) for folder in folders)


def expect_readable(path: str | Path) -> None:
    """Make sure that a file may be read in this process; wherever links lead to counts.

    Raises InputError if it lies outside of the folders that may be read, whether it is there or not; if it is no
    regular file.
    """
    if _only_within is None:
        return
    try:
        place = os.path.realpath(path)
        inside = any(os.path.commonpath([place, folder]) == folder for folder in _only_within)
        mode = os.stat(place).st_mode if inside else 0
    except FileNotFoundError:
        return  # whoever reads it says so
    except (OSError, ValueError):
        inside = False
    if not inside:
        hint = "not read: it lies outside of the folder that is served, and those named with --also"
        raise InputError(hint, file=escape_text(str(path)))
    if not stat.S_ISREG(mode):
        raise InputError("not read: it is no file, but a folder, a pipe or a device", file=escape_text(str(path)))


def only_ours(folder: str | Path) -> bool:
    """Whether nobody but this user and root may write into a folder, or put another in its place.

    A group that is this user's alone counts as this user. Always so where there are no owners, as on Windows.
    """
    if not hasattr(os, "getuid"):
        return True
    place = os.path.realpath(folder)
    own = _writable_by_others(os.stat(place))
    above = (os.stat(one) for one in _above(place))
    return not own and all(one.st_mode & stat.S_ISVTX or not _writable_by_others(one) for one in above)


def _above(place: str) -> Iterator[str]:
    while (parent := os.path.dirname(place)) != place:
        yield parent
        place = parent


def _writable_by_others(status: os.stat_result) -> bool:
    if status.st_uid not in (0, os.getuid()) or status.st_mode & stat.S_IWOTH:
        return True
    return bool(status.st_mode & stat.S_IWGRP) and status.st_gid != 0 and not _own_group(status.st_gid)


def _own_group(number: int) -> bool:
    """Whether a group is that of this user alone, as many systems make one for each user."""
    import grp
    import pwd

    try:
        group, user = grp.getgrgid(number), pwd.getpwuid(os.getuid())
    except KeyError:
        return False
    return number == user.pw_gid and group.gr_name == user.pw_name and set(group.gr_mem) <= {user.pw_name}


def is_file(path: str | Path) -> bool:
    """Whether there is a file of that name. It answers for every name; `Path` raises for one that is too long."""
    return os.path.isfile(path)


def is_folder(path: str | Path) -> bool:
    """Whether there is a folder of that name, whatever the name."""
    return os.path.isdir(path)


def is_there(path: str | Path) -> bool:
    """Whether there is anything of that name, whatever the name."""
    return os.path.exists(path)


# Files kept between runs that cannot hurt: what is broken, foreign or out of date is never used.
#
# In front stands what a file was made by (32 bytes), then the sum of the rest (32 bytes). A file is there whole or
# not at all, however many runs write it at once.

DIGEST_BYTES = 32


class DamagedFile(Exception):
    """A kept file does not hold what was written."""


def read_sealed(path: Path, made_by: bytes) -> bytes | None:
    """What a file holds; None where it is not there, cannot be read, or was made by something else.

    `made_by` is a digest of 32 bytes. Raises DamagedFile if the file is cut short or changed.

    Examples
    --------
    >>> import tempfile
    >>> place, maker = Path(tempfile.mkdtemp(), "kept"), hashlib.sha256(b"me").digest()
    >>> write_sealed(place, maker, b"text")
    >>> read_sealed(place, maker)
    b'text'
    """
    try:
        data = path.read_bytes()
    except OSError:
        return None
    maker, total, content = data[:DIGEST_BYTES], data[DIGEST_BYTES : 2 * DIGEST_BYTES], data[2 * DIGEST_BYTES :]
    if len(total) == DIGEST_BYTES and maker != made_by:
        return None
    if hashlib.sha256(content).digest() != total:
        raise DamagedFile(path)
    return content


def write_sealed(path: Path, made_by: bytes, content: bytes) -> None:
    """Keep content in a file, in place of what is there.

    Raises OSError if it cannot be written; nothing is left of it then.
    """
    handle, beside = tempfile.mkstemp(prefix=".", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(made_by + hashlib.sha256(content).digest() + content)
        os.chmod(beside, 0o644)
        os.replace(beside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(beside)
        raise


# JSON as strict as the profiles' YAML: a key given twice is refused with both places, and foreign text is shown.

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}\[\],:]', re.DOTALL)


class _Twice(Exception):
    """A key is given twice."""


def strict_json(text: str) -> Any:
    """The value of a JSON text, `NaN` and the like as texts, every text in it in one line (see `escape_text`).

    Raises InputError if an object has a key twice: with the line and column of the second, and those of the first in
    words; ValueError as `json.loads` does, and for brackets in brackets, thousands deep.

    Examples
    --------
    >>> strict_json('{"id": "A", "outer": [NaN]}')
    {'id': 'A', 'outer': ['NaN']}
    >>> strict_json('{"id": "A",\\n "id": "B"}')
    Traceback (most recent call last):
    kerfwise.encoder.errors.InputError: 2:2: the key 'id' is given twice, first in line 1, column 2: leave one of them
    """
    try:
        value = json.loads(text, parse_constant=str, object_pairs_hook=_object)
        return _shown(value)
    except _Twice:
        raise _refusal(text) from None
    except RecursionError:
        raise ValueError("brackets in brackets, thousands deep") from None


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result = dict(pairs)
    if len(result) < len(pairs):
        raise _Twice
    return {escape_text(key): _shown(value) for key, value in pairs}


def _shown(value: Any) -> Any:
    """Texts in one line; lists of texts as well, objects are seen to already."""
    if isinstance(value, str):
        return escape_text(value)
    if isinstance(value, list) and any(isinstance(member, str | list) for member in value):
        return [_shown(member) for member in value]
    return value


def _refusal(text: str) -> InputError:
    for key, first, again in _keys_twice(text):
        line, column = _place(text, first)
        message = f"the key '{key}' is given twice, first in line {line}, column {column}: leave one of them"
        at = _place(text, again)
        return InputError(message, line=at[0], column=at[1])
    return InputError("a key is given twice: leave one of them")


def _keys_twice(text: str) -> Iterator[tuple[str, int, int]]:
    """Keys that an object has twice, and where they begin: counted in characters from 0."""
    seen: list[dict[str, int] | None] = []
    last: re.Match[str] | None = None
    for token in _TOKEN.finditer(text):
        sign = token.group()
        if sign in "{[":
            seen.append({} if sign == "{" else None)
        elif sign in "}]" and seen:
            seen.pop()
        elif sign == ":" and last is not None and seen and (keys := seen[-1]) is not None:
            key = json.loads(last.group())
            if keys.setdefault(key, last.start()) != last.start():
                yield key, keys[key], last.start()
        last = token if sign.startswith('"') else None


def _place(text: str, at: int) -> tuple[int, int]:
    before = text[:at]
    return before.count("\n") + 1, at - (before.rfind("\n") + 1) + 1


# What a JSON Schema has against a value, in the words of the file's author.

NAMES = {
    "object": "an object",
    "array": "a list",
    "string": "a text",
    "number": "a number",
    "integer": "a whole number",
    "boolean": "true or false",
}


def schema_message(error: ValidationError) -> str:
    """The schema's complaint about one value, in the file's own terms."""
    value, bound = _short(error.instance), error.validator_value
    match error.validator:
        case "required":
            return error.message.replace(" is a required property", " missing")
        case "oneOf":
            return "expected either 'width' and 'height', or 'outline'"
        case "additionalProperties":
            return "; ".join(unknown("key", key, _schema(error)["properties"]) for key in unknown_keys(error))
        case "pattern":
            return f"{value} given, expected {_schema(error).get('description', bound)}"
        case "const":
            return f"{value} given, expected {bound!r}"
        case "enum" if isinstance(bound, list):
            return f"{value} given, expected one of {', '.join(bound)}"
        case "type":
            return f"{value} given, expected {_types(bound)}"
        case "minItems" | "minLength" if not error.instance:
            return "nothing in it"
        case "minItems" | "maxItems" if isinstance(error.instance, list):
            words = {"minItems": "at least", "maxItems": "at most"}
            return f"a list of {len(error.instance)} given, expected {words[error.validator]} {bound}"
        case "minimum" | "maximum" | "exclusiveMinimum":
            words = {"minimum": "at least", "maximum": "at most", "exclusiveMinimum": "over"}
            return f"{value} given, expected {words[error.validator]} {bound}"
    return error.message


def unknown_keys(error: ValidationError) -> list[str]:
    """The keys of an object that its schema does not have."""
    if error.validator != "additionalProperties":
        return []
    given: Any = error.instance
    return [key for key in given if key not in _schema(error)["properties"]]


def _schema(error: ValidationError) -> Mapping[str, Any]:
    return error.schema if isinstance(error.schema, dict) else {}


def _types(bound: object) -> str:
    words = [bound] if isinstance(bound, str) else bound if isinstance(bound, list) else []
    return " or ".join(NAMES.get(word, "null") for word in words)


def _short(value: object) -> str:
    names: Mapping[type, str] = {dict: "an object", list: "a list"}
    if isinstance(value, list) and len(value) <= 3 and not any(isinstance(x, list | dict) for x in value):
        return json.dumps(value)
    text = names.get(type(value)) or json.dumps(value)
    return text if len(text) <= 40 else text[:37] + "…"


# Where in a JSON text a value stands, for messages.

JsonPath = Sequence[str | int]
_ONE_OF = {"holes": "hole", "marks": "mark", "scrap": "scrap line", "tabs": "tab", "bridges": "bridge"}


def places(text: str, paths: Sequence[JsonPath]) -> list[tuple[int | None, int | None]]:
    """Line and column, counted from 1, of the values that paths of keys and indices lead to.

    JSON is YAML, and a YAML parser keeps the positions. (None, None) where the text is one it does not follow.

    Examples
    --------
    >>> places('{"parts": [\\n  {"id": "A"},\\n  {"id": 7}]}', [["parts", 1, "id"]])
    [(3, 10)]
    """
    if not paths:
        return []
    try:
        root = yaml.compose(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except (yaml.YAMLError, RecursionError):
        root = None
    return [_json_place(root, path) for path in paths]


def _json_place(node: yaml.Node | None, path: JsonPath) -> tuple[int | None, int | None]:
    if node is None:
        return None, None
    for step in path:
        if isinstance(node, yaml.MappingNode):
            node = next((value for key, value in node.value if key.value == step), node)
        elif isinstance(node, yaml.SequenceNode) and isinstance(step, int) and step < len(node.value):
            node = node.value[step]
    return node.start_mark.line + 1, node.start_mark.column + 1


def spoken(path: JsonPath, part_ids: Sequence[object]) -> str:
    """A path in words: "part 'P3', hole 2, vertex 5".

    Examples
    --------
    >>> spoken(["parts", 2, "holes", 1, 4, 0], ["P1", "P2", "P3"])
    "part 'P3', hole 2, vertex 5, x"
    """
    words, steps = [], list(path)
    if len(steps) > 1 and steps[0] == "parts" and isinstance(steps[1], int):
        name = part_ids[steps[1]] if steps[1] < len(part_ids) else None
        words.append(f"part '{name}'" if isinstance(name, str) and name else f"part number {steps[1] + 1}")
        steps = steps[2:]
    elif steps and steps[0] == "sheet":
        words.append("the sheet")
        steps = steps[1:]
    if len(steps) > 1 and steps[0] in _ONE_OF and isinstance(steps[1], int):
        words.append(f"{_ONE_OF[str(steps[0])]} {steps[1] + 1}")
        steps = steps[2:]
    elif steps:
        words.append(f"{steps[0]}")
        steps = steps[1:]
    if steps and steps[0] in ("at", "width", "parts", "from", "to"):
        return ", ".join([*words, str(steps[0])])
    if steps and isinstance(steps[0], int):
        words.append(f"vertex {steps[0] + 1}")
        steps = steps[1:]
    if steps and isinstance(steps[0], int):
        words.append(("x", "y", "bulge")[min(steps[0], 2)])
    return ", ".join(words) or "the file"
