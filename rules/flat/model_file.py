"""What a rule's model file says of itself: its name, its sentence, its parameters, and where its array stands."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, expect_readable, read_limited, utf8_text
from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.registry import RULES

TYPES = ("int", "bool", "string")
_PARAMETER = re.compile(
    r"^[ \t]*(?P<type>[^\s:;%][^:;%\n]*):\s*(?P<name>[A-Za-z]\w*)\s*;[ \t]*(?:%(?P<help>.*))?$", re.M
)
"""No part of a pattern may take the blanks that another begins with: on thousands of them it would never end."""
_DEFAULT = re.compile(r"^\s*default\s+(?P<value>[^\s:,;][^:,;]*)(?:[:,;]\s*(?P<help>.*))?$")
_TEXT = re.compile(r'"(?:[^"\\\n]|\\[^(\n])*"')
_BARE = re.compile(
    r"^[ \t]*constraint\b(?!\s*(?:assert|trace|redundant_constraint|symmetry_breaking_constraint)\b)", re.M
)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A value that the file declares and does not set: `int: name_least;`, and `% default 3: help` beside it."""

    name: str
    key: str
    type: str
    default: str
    help: str
    line: int


@dataclass(frozen=True, slots=True)
class ModelFile:
    """A rule's model file. `stem` is its name in MiniZinc, `name` that in profiles; `line` is where its array begins.

    `array` is "" for a file that states constraints alone, `says` whether an array of sentences stands beside it.
    `sha256` is that of the content, and of what it includes.
    """

    path: Path
    text: str
    stem: str
    name: str
    sentence: str
    source: str
    array: str
    line: int
    says: bool
    bare: int
    parameters: tuple[Parameter, ...]
    sha256: str

    @property
    def place(self) -> str:
        """File and line, as messages give them."""
        return f"{self.path.name}:{self.line}"


def read_model_file(path: Path) -> ModelFile:
    """Read what a rule's file says of itself; MiniZinc is not asked.

    Raises InputError if it cannot be read, or has neither an array `<name>_holds` nor a constraint.
    """
    if path.suffix != ".mzn":
        raise InputError("expected a MiniZinc file such as plant_rule.mzn", file=path)
    try:
        text = utf8_text(read_limited(path, MOST_BYTES_OF_YAML), "a rule", path)
    except OSError as error:
        raise InputError(f"cannot read the rule: {error.strerror}", file=path) from None
    stem = path.stem.replace("-", "_")
    if not re.fullmatch(r"[A-Za-z]\w*", stem):
        raise InputError(
            f"a rule's file is named as the rule, such as rivets_first.mzn; {escape_text(path.stem)!r} is no name that "
            "MiniZinc can use: letters, digits and _, a letter first",
            file=path,
        )
    sentence, source = _header(text, stem)
    code = without_comments(text)
    array = re.search(rf"\b{stem}_holds\b(?=[^;=]*=)", code)
    bare = _BARE.search(code)
    if array is None and bare is None:
        other = re.search(r"\b(\w+)_holds\b(?=[^;=]*=)", code)
        if other is not None:
            raise InputError(
                f"the array {other[0]} is not named as the file: call it {stem}_holds, or the file {other[1]}.mzn",
                file=path,
                line=_line(code, other.start()),
            )
        raise InputError(
            f"the file states nothing: expected an array `array[int] of var bool: {stem}_holds = [...];`", file=path
        )
    return ModelFile(
        path=path,
        text=text,
        stem=stem,
        name=stem.replace("_", "-"),
        sentence=sentence,
        source=source,
        array=f"{stem}_holds" if array else "",
        line=_line(code, (array or bare).start()),  # type: ignore[union-attr]
        says=re.search(rf"\b{stem}_says\b[^;=]*=", code) is not None,
        bare=0 if bare is None else _line(code, bare.end()),
        parameters=tuple(_parameters(path, text, stem)),
        sha256=_content_digest(path, text),
    )


_OVER = re.compile(r"((?:[A-Za-z]\w*\s*,\s*)*[A-Za-z]\w*)\s+in\s+CONTOUR\b")


def element_contours(file: ModelFile) -> dict[str, str]:
    """Name of a contour in the comprehension of the file's array → an array of its value in each element, as MiniZinc.

    Empty where the array is no single comprehension over contours.

    Examples
    --------
    >>> from pathlib import Path
    >>> text = "array[int] of var bool: a_holds = [before(i, j) | i, j in CONTOUR where i != j];"
    >>> file = ModelFile(Path("a.mzn"), text, "a", "a", "", "", "a_holds", 1, False, 0, (), "")
    >>> element_contours(file)
    {'i': '[i | i, j in CONTOUR where i != j]', 'j': '[j | i, j in CONTOUR where i != j]'}
    """
    code = without_comments(file.text)
    begin = re.search(rf"\b{file.array}\b[^;=]*=\s*\[", code) if file.array else None
    if begin is None:
        return {}
    bars, depth, k, closed = [], 1, begin.end(), begin.end()
    while k < len(code) and depth:
        if (text := _TEXT.match(code, k)) is not None:
            k = text.end()
            continue
        depth += (code[k] in "([{") - (code[k] in ")]}")
        if code[k] == "|" and depth == 1:
            bars.append(k)
        closed, k = k, k + 1
    if depth or len(bars) != 1 or not re.match(r"\]\s*(;|\Z)", code[closed:]):
        return {}
    tail = code[bars[0] + 1 : closed].strip()
    over = _OVER.findall(re.split(r"\bwhere\b", tail)[0])
    names = [name.strip() for of in over for name in of.split(",")]
    return {name: f"[{name} | {tail}]" for name in names}


def states(file: ModelFile, array: str) -> bool:
    """Whether the file defines an array of that name."""
    return re.search(rf"\b{array}\b[^;=]*=", without_comments(file.text)) is not None


def _header(text: str, stem: str) -> tuple[str, str]:
    """The sentence and the source: the first two lines of comment, before anything else; both may be missing."""
    lines = []
    for line in text.lstrip("\ufeff").splitlines():
        if not line.startswith("%") or line.strip("% \t") == "":
            break
        lines.append(line.strip("% \t"))
    sentence = lines[0] if lines else ""
    name, colon, rest = sentence.partition(":")
    if colon and name.replace("-", "_").replace(" ", "_").lower() == stem.lower():
        sentence = rest.strip()
    sentence = sentence[:1].upper() + sentence[1:]
    return escape_text(sentence or f"The rule in {stem}.mzn holds."), escape_text(
        lines[1] if len(lines) > 1 else "the plant"
    )


_FITS = {"int": r"-?\d+", "bool": "true|false", "string": r'"[^"\\\n]*"'}


def _parameters(path: Path, text: str, stem: str) -> Iterator[Parameter]:
    """The parameters of a file; in the place of a shipped rule those that the shipped text does not declare itself."""
    shipped = set(re.findall(rf"\b{stem}_\w+", shipped_text(stem.replace("_", "-")) or ""))
    for match in _PARAMETER.finditer(text):
        kind, name, line = match["type"].strip(), match["name"], _line(text, match.start("name"))
        if kind not in TYPES or not name.startswith(f"{stem}_") or name in shipped:
            continue
        default = _DEFAULT.match((match["help"] or "").strip())
        if default is None or not re.fullmatch(_FITS[kind], default["value"].strip()):
            example = {"int": "3", "bool": "true", "string": '"A"'}[kind]
            raise InputError(
                f"the parameter {name} has no default: write it beside, as in `{kind}: {name};  % default {example}: "
                "what it is`; the profile sets another under rules",
                file=path,
                line=line,
            )
        key = name.removeprefix(f"{stem}_")
        yield Parameter(name, key, kind, default["value"].strip(), (default["help"] or "").strip(), line)


def shipped_text(rule_id: str) -> str | None:
    """The model file of a shipped rule; None where no shipped rule of that name has one."""
    if rule_id not in RULES:
        return None
    file = rule_file(rule_id)
    return file.read_text(encoding="utf-8") if file.is_file() else None


def without_comments(text: str) -> str:
    """The text with comments blanked, so that every character keeps its place."""
    pattern = r'"(?:[^"\\\n]|\\.)*"|%[^\n]*|/\*.*?\*/'

    def blanked(match: re.Match[str]) -> str:
        return match[0] if match[0].startswith('"') else re.sub(r"[^\n]", " ", match[0])

    return re.sub(pattern, blanked, text, flags=re.S)


def _line(text: str, at: int) -> int:
    return text.count("\n", 0, at) + 1


def whole_text(file: ModelFile) -> str:
    """The text of the file and of what it includes beside it, without comments and sentences: what it names, it needs.

    Texts that hold expressions stay.
    """
    return "".join(_TEXT.sub('""', without_comments(text)) for text in files_read(file).values())


def files_read(file: ModelFile) -> dict[Path, str]:
    """The text of the file, and of the files beside it that it includes, as they are now."""
    return _with_includes(file.path)


def _with_includes(file: Path) -> dict[Path, str]:
    found: dict[Path, str] = {}
    waiting = [file.resolve()]
    for path in waiting:
        expect_readable(path)
        try:
            found[path] = path.read_text(encoding="utf-8-sig", errors="replace")
        except OSError:  # MiniZinc says what is wrong with it
            continue
        for name in re.findall(r'\binclude\s*"([^"]+)"', without_comments(found[path])):
            beside = (path.parent / name).resolve()
            if beside.is_file() and beside not in waiting:
                waiting.append(beside)
    return found


def _content_digest(path: Path, text: str) -> str:
    """The sha256 of a file's text, and of what it includes beside it, if anything."""
    others = [beside for other, beside in _with_includes(path).items() if other != path.resolve()]
    return hashlib.sha256("\0".join([text, *others]).encode()).hexdigest()
