"""The page of the Python interface, from the docstrings.

`python -m kerfwise.tests.docs.api_page > docs/api.md` writes it anew.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator

import kerfwise
from kerfwise import api

HEAD = """\
# The Python interface

This page is made from the docstrings by `python -m kerfwise.tests.docs.api_page > docs/api.md`. Three notebooks in
`examples/notebooks` show the interface at work: plan a nest and look at it; ask why, lock, and let rules clash; heat
and what cooler orders cost.
"""
FUNCTIONS = (
    "read_nest", "load_profile", "solve", "check", "explain", "conflict", "times", "simulate", "distort", "trade_off",
    "draw", "compare", "resequence", "nest", "make", "edit", "facts", "read_plan", "read_job",
)  # fmt: skip
CLASSES = (
    "Result", "Reached", "NoPlan", "InputError", "Questions", "RulesConflict", "KerfwiseError", "Conflict",
    "CheckResult",
    "Explanation", "Times", "Simulation", "Offer", "Comparison", "Resequenced", "Nests", "EditedNest", "Picture",
    "Lock", "Job", "Plan", "Nest", "Profile",
)  # fmt: skip


def page() -> str:
    """The whole page."""
    missing = {*kerfwise.__all__} ^ {"__version__", *FUNCTIONS, *CLASSES}
    assert not missing, f"not on the page, or not in the interface: {', '.join(sorted(missing))}"
    lines = [HEAD, *_text(inspect.getdoc(api) or "")]
    for name in FUNCTIONS:
        lines += ["", f"## {name}", "", *_function(name, getattr(kerfwise, name))]
    for name in CLASSES:
        lines += ["", f"## {name}", "", *_class(getattr(kerfwise, name))]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).rstrip() + "\n"


def _function(name: str, function: object) -> Iterator[str]:
    yield from _signature(name, function)
    yield from _text(inspect.getdoc(function) or "")


def _class(kind: type) -> Iterator[str]:
    yield from _text(inspect.getdoc(kind) or "")
    kinds = [k for k in reversed(kind.__mro__) if k.__module__.startswith("kerfwise.")]
    own = [(n, v) for k in kinds for n, v in vars(k).items() if not n.startswith("_")]
    for name, member in own:
        if isinstance(member, property):
            said = inspect.getdoc(member) or ""
            yield f"- `{name}`: {' '.join(said.split())}"
    for name, member in own:
        if inspect.isfunction(member):
            yield from ("", f"### {kind.__name__}.{name}", "", *_function(name, member))


def _signature(name: str, function: object) -> Iterator[str]:
    assert callable(function)
    signature = inspect.signature(function)
    given = [p for p in signature.parameters.values() if p.name != "self"]
    inner = [_parameter(p) for p in given if p.kind is not p.VAR_KEYWORD]
    for options in (p for p in given if p.kind is p.VAR_KEYWORD):
        kind = vars(inspect.getmodule(function))[str(options.annotation).removeprefix("Unpack[").removesuffix("]")]
        inner += [f"{key}: {said.__forward_arg__} = …" for key, said in kind.__annotations__.items()]
    first = next((k for k, p in enumerate(given) if p.kind is p.KEYWORD_ONLY), None)
    if first is not None:
        inner.insert(first, "*")
    line = f"{name}({', '.join(inner)}) -> {signature.return_annotation}"
    if len(line) > 100:
        line = f"{name}(\n" + "".join(f"    {one},\n" for one in inner) + f") -> {signature.return_annotation}"
    yield from ("```python", line, "```", "")


def _parameter(given: inspect.Parameter) -> str:
    default = "" if given.default is given.empty else f" = {given.default!r}"
    return f"{given.name}: {given.annotation}{default}"


def _text(doc: str) -> Iterator[str]:
    """A docstring as Markdown: sections become bold heads, entries become lists, examples become code."""
    section, code = "", False
    lines = doc.splitlines()
    for k, line in enumerate(lines):
        if k + 1 < len(lines) and lines[k + 1] and set(lines[k + 1]) == {"-"}:
            section = line
            yield from ("", f"**{line}**", "")
            continue
        if line and set(line) == {"-"}:
            continue
        line = re.sub(r"  # doctest: .*", "", line)
        starts = line.startswith(">>> ")
        if starts and not code:
            code = True
            yield from ("", "```pycon")
        elif code and not line:
            code = False
            yield "```"
        if code or section in ("", "Examples") or not line.strip():
            yield line
        elif not line.startswith(" "):
            yield f"- `{line}`:"
        else:
            yield f"  {line.strip()}"
    if code:
        yield "```"
    yield ""


if __name__ == "__main__":
    print(page(), end="")
