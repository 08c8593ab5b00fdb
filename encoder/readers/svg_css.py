"""Style sheets of SVG files: which rules a shape falls under, and what it is styled by in the end."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from kerfwise.encoder.errors import InputError

_PART = re.compile(
    r"(?P<name>\*|[\w-]+)|#(?P<id>[\w-]+)|\.(?P<cls>[\w-]+)"
    r"|\[\s*(?P<attr>[\w:-]+)\s*(?:(?P<op>[~^$*|]?=)\s*[\"']?(?P<value>[^\]\"']*)[\"']?\s*)?\]"
    r"|:(?P<pseudo>[\w-]+)(?:\((?P<arg>[^()]*)\))?"
)
_NEVER = frozenset({"hover", "active", "focus", "visited", "target", "focus-visible", "focus-within"})
"""States of a page that somebody is looking at: no drawing is in one."""


@dataclass(frozen=True, slots=True)
class _Rule:
    """One selector with what it says: simple selectors from left to right, each with the sign before it."""

    chain: tuple[tuple[str, str], ...]
    says: Mapping[str, tuple[str, bool]]
    weight: tuple[int, int, int]


def styled(root: Element) -> None:
    """Give every element, in its `style`, all that the style sheets and its own style say of it.

    Raises InputError for a selector that is not known: what it selects may be what is hidden.
    """
    sheets = [element for element in root.iter() if tag_of(element) == "style"]
    rules = [rule for sheet in sheets if _applies(sheet) for rule in _rules("".join(sheet.itertext()))]
    for sheet in sheets:
        sheet.text = ""
        sheet[:] = []
    if not rules:
        return
    parents = {child: parent for parent in root.iter() for child in parent}
    for element in root.iter():
        if not isinstance(element.tag, str):
            continue
        found: dict[str, tuple[str, tuple[int, ...]]] = {}
        applied = [(rule.says, rule.weight) for rule in rules if _matches(element, rule.chain, parents)]
        for order, (says, weight) in enumerate([*applied, (declarations(element.get("style", "")), (1000, 0, 0))]):
            for name, (value, important) in says.items():
                rank = (int(important), *weight, order)
                if name not in found or rank >= found[name][1]:
                    found[name] = value, rank
        if found:
            with_style(element, {name: value for name, (value, _) in found.items()})


def _applies(sheet: Element) -> bool:
    """Whether a style sheet is one of CSS that holds for screens."""
    return sheet.get("type", "").strip().lower() in ("", "text/css") and _on_screens(sheet.get("media", ""))


_KNOWN_FEATURES = {
    "prefers-color-scheme": "light", "prefers-reduced-motion": "no-preference", "prefers-contrast": "no-preference",
    "forced-colors": "none", "scripting": "none", "update": "fast", "color": "", "monochrome": "0", "grid": "0",
}  # fmt: skip
"""What a screen is that nobody has set up: whether it is wide, or has a mouse, is not known."""


def _on_screens(media: str) -> bool:
    """Whether a list of media queries holds for a plain screen.

    Raises InputError for one of which that depends on the screen, such as on how wide it is.

    Examples
    --------
    >>> [_on_screens(one) for one in ("", "print", "not print", "print, screen and (color)")]
    [True, False, True, True]
    >>> _on_screens("(prefers-color-scheme: dark)"), _on_screens("not all and (prefers-color-scheme: dark)")
    (False, True)
    """
    return not media.strip() or any(_one_on_screens(query.strip().lower(), media) for query in media.split(","))


def _one_on_screens(query: str, media: str) -> bool:
    found = re.fullmatch(r"(?:(not|only)\s+)?(?:([a-z][a-z-]*)(?:\s+and\s+|$))?((?:\([^()]*\)(?:\s+and\s+|$))*)", query)
    if found is None:
        raise _unknown(f"@media {media.strip()}")
    holds = found[2] in (None, "all", "screen")
    for feature in re.findall(r"\(([^()]*)\)", found[3]) if holds else ():
        name, _, value = (word.strip() for word in feature.partition(":"))
        if name not in _KNOWN_FEATURES:
            raise _unknown(f"@media {media.strip()}")
        known = _KNOWN_FEATURES[name]
        holds = holds and (known == value if value else known not in ("none", "0", "no-preference"))
    return holds is not (found[1] == "not")


def declarations(text: str) -> dict[str, tuple[str, bool]]:
    """What a style says: property → value, and whether it is important.

    Examples
    --------
    >>> declarations("fill: none; display:none !important")
    {'fill': ('none', False), 'display': ('none', True)}
    """
    found = {}
    for one in re.sub(r"/\*.*?(\*/|$)", " ", text, flags=re.DOTALL).split(";"):
        name, colon, value = (word.strip() for word in one.partition(":"))
        if colon and name:
            plain = re.sub(r"\s*!\s*important\s*$", "", value, flags=re.IGNORECASE)
            found[name if name.startswith("--") else name.lower()] = plain, plain != value
    return found


def with_style(element: Element, style: Mapping[str, str]) -> None:
    """Write the style of an element."""
    element.set("style", ";".join(f"{name}:{value}" for name, value in style.items()))


def properties(element: Element) -> dict[str, str]:
    """What an element says of itself: its attributes, and its style, which goes before them."""
    own = {name: value for name, value in element.items() if "}" not in name}
    return own | {name: value for name, (value, _) in declarations(element.get("style", "")).items()}


XLINK = "{http://www.w3.org/1999/xlink}href"


def href_of(element: Element) -> str:
    """What an element refers to; "" where it refers to nothing."""
    return (element.get("href") or element.get(XLINK) or "").strip()


def called(element: Element) -> str:
    """An element by its kind and its id, for messages."""
    name = f" '{element.get('id')}'" if element.get("id") else ""
    return f"the <{tag_of(element)}>{name}"


def tag_of(element: Element) -> str:
    """The name of an element without its name space; "" for a comment."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""


def _rules(text: str) -> Iterator[_Rule]:
    for selectors, says in _blocks(plain_rules(_screen_only(text))):
        for selector in _each_of(selectors):
            if selector.strip():
                chain = tuple(_chain(selector.strip()))
                yield _Rule(chain, declarations(says), _weight([part for _, part in chain]))


def _each_of(selectors: str) -> list[str]:
    """The selectors of a list, split at commas that stand in no brackets."""
    return re.split(r",(?![^(\[]*[)\]])", selectors)


_NO_RULES = ("@font", "@keyframes", "@-", "@page", "@property", "@counter", "@color", "@view")
"""How blocks begin that say nothing of what is shown of a drawing that stands still."""


def _screen_only(text: str) -> str:
    """A sheet without what holds on paper only; rules for screens are taken out of their block.

    Raises InputError for a block of which it is not known when it holds.
    """
    kept, at = "", 0
    while (found := re.compile(r"@[\w-]+").search(text, at)) is not None:
        kept += text[at : found.start()]
        opens, semicolon = text.find("{", found.end()), text.find(";", found.end())
        if opens < 0 or 0 <= semicolon < opens:
            at = semicolon + 1 if semicolon >= 0 else len(text)
            continue
        depth, end = 1, opens + 1
        while depth and end < len(text):
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        kind, query = found[0].lower(), text[found.end() : opens].lower()
        if kind == "@media":
            holds = _on_screens(query)
        elif kind == "@supports":
            holds = re.search(r"\bnot\b", query) is None  # viewers know what drawings use
        elif kind.startswith(_NO_RULES):
            holds = False
        else:
            raise _unknown(f"{kind}{query}".strip())
        if holds:
            kept += _screen_only(text[opens + 1 : end - 1])
        at = end
    return kept + text[at:]


def _blocks(text: str) -> Iterator[tuple[str, str]]:
    for block in text.split("}"):
        selectors, brace, says = block.partition("{")
        if brace:
            yield selectors, says


def _chain(selector: str) -> Iterator[tuple[str, str]]:
    """Simple selectors with the sign that joins each to the one before: a blank, >, + or ~."""
    words = re.findall(r"\s*([>+~])\s*|(\s+)|((?:\[[^\]]*\]|\([^)]*\)|[^\s>+~\[(])+)", selector)
    joined = ""
    for sign, blank, simple in words:
        if simple:
            yield joined or " ", simple
            joined = ""
        else:
            joined = sign or joined or (blank[:1] and " ")


def _weight(parts: Sequence[str]) -> tuple[int, int, int]:
    found = [match for part in parts for match in _PART.finditer(part) if match["pseudo"] != "where"]
    ids = sum(match["id"] is not None for match in found)
    names = sum(match["name"] is not None and match["name"] != "*" for match in found)
    return ids, len(found) - ids - names - sum(match["name"] == "*" for match in found), names


def _matches(element: Element, chain: Sequence[tuple[str, str]], parents: Mapping[Element, Element]) -> bool:
    sign, simple = chain[-1]
    if not _is(element, simple, parents):
        return False
    if len(chain) == 1:
        return True
    before = chain[:-1]
    parent = parents.get(element)
    if sign == ">":
        return parent is not None and _matches(parent, before, parents)
    if sign in "+~":
        older = [] if parent is None else list(parent)[: list(parent).index(element)]
        return any(_matches(one, before, parents) for one in (older[-1:] if sign == "+" else older))
    while parent is not None:
        if _matches(parent, before, parents):
            return True
        parent = parents.get(parent)
    return False


def _is(element: Element, simple: str, parents: Mapping[Element, Element]) -> bool:
    at = 0
    while at < len(simple):
        found = _PART.match(simple, at)
        if found is None or found.end() == at:
            raise _unknown(simple)
        at = found.end()
        if not _has(element, found, simple, parents):
            return False
    return True


def _has(element: Element, part: re.Match[str], simple: str, parents: Mapping[Element, Element]) -> bool:
    if part["name"] is not None:
        return part["name"] in ("*", tag_of(element))
    if part["id"] is not None:
        return element.get("id") == part["id"]
    if part["cls"] is not None:
        return part["cls"] in element.get("class", "").split()
    if part["attr"] is not None:
        return _has_attribute(element, part["attr"], part["op"], part["value"] or "")
    pseudo, arg = part["pseudo"], part["arg"]
    if pseudo in _NEVER:
        return False
    if pseudo in ("not", "is", "where") and arg:
        return any(_is(element, one.strip(), parents) for one in _each_of(arg)) is (pseudo != "not")
    parent = parents.get(element)
    if pseudo == "root":
        return parent is None
    others = [element] if parent is None else [e for e in parent if isinstance(e.tag, str)]
    if pseudo.endswith("of-type"):
        others = [e for e in others if tag_of(e) == tag_of(element)]
    place, count = others.index(element) + 1, len(others)
    kind = pseudo.removesuffix("-of-type").removesuffix("-child")
    if kind == "first":
        return place == 1
    if kind == "last":
        return place == count
    if kind == "only":
        return count == 1
    if kind in ("nth", "nth-last") and arg:
        return _is_nth(place if kind == "nth" else count - place + 1, arg, simple)
    raise _unknown(simple)


def _is_nth(place: int, text: str, simple: str) -> bool:
    plain = text.replace(" ", "").lower()
    plain = {"odd": "2n+1", "even": "2n"}.get(plain, plain)
    found = re.fullmatch(r"(?:([+-]?\d*)n)?([+-]?\d+)?", plain)
    if found is None:
        raise _unknown(simple)
    step = 0 if found[1] is None else int(found[1] + "1" if found[1] in ("", "+", "-") else found[1])
    off = place - int(found[2] or 0)
    return off == 0 if step == 0 else off % step == 0 and off // step >= 0


def _has_attribute(element: Element, name: str, op: str | None, value: str) -> bool:
    attribute = next((v for k, v in element.attrib.items() if k.rpartition("}")[2] == name.rpartition(":")[2]), None)
    if attribute is None or op is None:
        return attribute is not None
    return {
        "=": attribute == value,
        "~=": value in attribute.split(),
        "^=": value != "" and attribute.startswith(value),
        "$=": value != "" and attribute.endswith(value),
        "*=": value != "" and value in attribute,
        "|=": attribute == value or attribute.startswith(f"{value}-"),
    }[op]


def _unknown(simple: str) -> InputError:
    what = "block" if simple.startswith("@") else "rule" if "{" in simple else "selector"
    return InputError(
        f"the style sheet's {what} {simple!r} is not known, so that it is not clear what is shown; save the drawing "
        "as plain SVG, with styles on each shape"
    )


# Style sheets of SVG files, put so that the library's patterns read them in one go: on others they try for hours.

LONGEST_ATTRIBUTE = 20_000
"""Characters of an attribute other than a path's; real ones have some hundreds."""
LONG_BY_NATURE = frozenset({"d", "points", "href", "data"})
"""Attributes that may be longer: coordinates and pictures."""


def plain_rules(text: str) -> str:
    """The rules of a style sheet, each as `selector{what holds}`, without comments and whatever is no whole rule.

    Examples
    --------
    >>> plain_rules("/* a */ .a { fill: red } .b {} #c{display:none} .d {")
    '.a{fill: red}#c{display:none}'
    """
    bare = _without_comments(text)
    rules, at = [], 0
    while (opens := bare.find("{", at)) >= 0 and (closes := bare.find("}", opens)) >= 0:
        selector, says = bare[at:opens].strip(), bare[opens + 1 : closes].strip()
        if "{" in says:
            raise _unknown(f"{selector} {{{says[: says.find('{') + 1]}")
        if selector and says:
            rules.append(f"{selector}{{{says}}}")
        at = closes + 1
    return "".join(rules)


def too_long(name: str, value: str) -> str:
    """What is wrong with an attribute that is too long to be read; "" if it is not.

    Examples
    --------
    >>> too_long("transform", "rotate(1) " * 9000)
    'its transform has 90000 characters, at most 20000 are read'
    """
    if len(value) <= LONGEST_ATTRIBUTE or name.rpartition("}")[2] in LONG_BY_NATURE:
        return ""
    return f"its {name.rpartition('}')[2]} has {len(value)} characters, at most {LONGEST_ATTRIBUTE} are read"


def _without_comments(text: str) -> str:
    """Each comment as a blank: from /* to */ or to the end, and, as the library has it, from // to the line's end."""
    kept, at = [], 0
    block, line = text.find("/*"), text.find("//")
    while block >= 0 or line >= 0:
        if line < 0 or 0 <= block < line:
            ends = text.find("*/", block + 2)
            kept.append(text[at:block])
            at = len(text) if ends < 0 else ends + 2
        else:
            ends = text.find("\n", line)
            kept.append(text[at:line])
            at = len(text) if ends < 0 else ends
        block = text.find("/*", at) if 0 <= block < at else block
        line = text.find("//", at) if 0 <= line < at else line
    return " ".join([*kept, text[at:]])
