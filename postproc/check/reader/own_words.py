"""What a dialect's file says that its control knows, besides what `controls` says of its family.

Words of a plant's own are told apart from those that are checked before a row is taken to pieces: some stand for a
word that is known (`means`), others touch neither the path nor the torch (`also`) and are left out. A word that a
control is known to move or switch by cannot be declared to be harmless.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass, replace
from itertools import chain
from string import Formatter

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.dialects import Dialect
from kerfwise.postproc.dialects.blocks import Also
from kerfwise.rules.options.yaml_positions import place_in, wrong_at
from kerfwise.rules.profile.plant_sections import ENDINGS

from .controls import CONTROLS, MARKS_UP_TO, Control, Declared
from .essi import OBEYED
from .tools import ENDS, HALTS
from .words import BOUNDS

_NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)"
_TOKEN = re.compile(r"(?P<letter>[A-Z$#@_=]+)(?P<number>[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)?)|(?P<rest>.)")
_PLACES = frozenset("XYIJR")
_FEEDS = {"mm_min": 1.0, "m_min": 1000.0, "in_min": 25.4, "mm_s": 60.0, "cm_s": 600.0}
_ROUND = 1.5
"""How many steps of its digits the radius of an arc may differ by between its ends."""


def control_for(dialect: Dialect, file: str = "") -> Control:
    """The control that a dialect is for: that of its family, with what the file says of words of its own.

    Raises InputError for words that cannot be harmless; with their place, where `file` is the dialect's.
    """
    control = CONTROLS[dialect.control]
    changes: dict[str, object] = {}
    if dialect.powers is not None and (control.beam or any("{mark_power}" in block for block in dialect.mark_on)):
        full = float(dialect.powers.full)
        changes |= {"full_power": full, "marks_up_to": MARKS_UP_TO * full}
    if any(_is_halt(block) for block in (*dialect.torch_on, *dialect.mark_on)):
        changes["halts_lit"] = True
    if dialect.comment is None and dialect.reads is not None:
        changes["opens"] = ""
    if not control.arcs:
        changes["mismatch_mm"] = max(control.mismatch_mm, _ROUND * dialect.step_mm)
        changes["program_names"] = (*control.program_names, *_program_names(dialect))
    if dialect.decimal != ".":
        changes["decimal"] = dialect.decimal
    if (form := _comment_form(dialect)) is not None and not control.arcs:
        changes |= {"comment_form": form, "comments": True, "opens": "".join(c for c in "(;" if c == form[0])}
    changes["subprograms"] = dialect.subprogram is not None
    changes["also"] = control.also
    if (reads := dialect.reads) is not None:
        means = [(_regex(own, named=True), _template(known)) for own, known in reads.means]
        changes["means"] = (*means, *control.means)
        changes |= _of_another_control(dialect, control)
        changes |= {"title": reads.title or control.title, "modal": reads.modal}
        changes["fixed"] = control.fixed | {_code_number(word, file) for block in reads.fixed for word in block.split()}
        if reads.dwell is not None:
            letter = reads.dwell.letter
            changes |= {"dwell": letter, "dwell_s": 0.001 if reads.dwell.unit == "ms" else 1.0}
            if letter not in BOUNDS:  # a word of its own for the time of a wait
                of_wait = re.compile(f"(?:(?<=G4)|(?<=G04)){letter}(?=[0-9.])")
                changes |= {"dwell": "P", "means": (*changes["means"], (of_wait, "P"))}  # type: ignore[misc]
        if reads.step_mm is not None:
            changes["place_mm"] = reads.step_mm
        if reads.feed != "units_min":
            changes["feed_mm_min"] = _FEEDS[reads.feed]
        if reads.longest is not None:
            changes["longest"] = reads.longest
    own: Control = replace(control, known_m=control.known_m - changes.get("foreign", frozenset()))  # type: ignore[operator]
    changes["also"] = (*(_pattern(one, own, file) for one in dialect.also), *changes["also"])  # type: ignore[misc]
    changed: Control = replace(control, **changes)  # type: ignore[arg-type]
    if rests := [s for s, _ in _own_waits(dialect.torch_off, changed)]:
        changed = replace(changed, rests_s=sum(rests))
    waits = list(_own_waits(dialect.torch_on, changed))
    if waits:
        changed = replace(changed, stands_s=sum(s for s, _ in waits), preheat_s=sum(s for s, lit in waits if not lit))
    return changed


def _of_another_control(dialect: Dialect, control: Control) -> dict[str, object]:
    """What its family's words are to a control with a name of its own: none, but those that it writes, or means.

    Where M3 and M5 mean M07 and M08, as on Fanuc-like controls, M08 itself starts a coolant; M48 has Marlin probe.
    """
    if dialect.reads is None or dialect.reads.title is None:
        return {}
    written = " ".join(
        _texts(replace(dialect, name="", title="", reads=None, also=(), verified_by=(), no_marking=None))
    )
    meant = _m_words(" ".join(known for _, known in dialect.reads.means)) | {7.0, 8.0, 9.0}  # coolants, wherever
    shared = HALTS | ENDS | _m_words(written) | (meant - {*control.starts, *control.stops})
    return {"foreign": control.known_m - shared, "also": ()}


def _texts(value: object) -> Iterator[str]:
    """The texts that a field's value holds."""
    if isinstance(value, str):
        yield value
    elif is_dataclass(value):
        yield from chain.from_iterable(_texts(getattr(value, one.name)) for one in fields(value))
    elif isinstance(value, tuple):
        yield from chain.from_iterable(map(_texts, value))


def _m_words(text: str) -> set[float]:
    return {float(found[1]) for found in re.finditer(r"(?<![A-Za-z])M0*([0-9]+)", text)}


def _own_waits(blocks: Sequence[str], control: Control) -> Iterator[tuple[float, bool]]:
    """The waits, s, that stand in the blocks of a dialect, and whether the torch has been started by these before."""
    lit = False
    for block in blocks if not control.arcs else ():
        code = _code(block)
        for own, known in control.means:
            code = own.sub(lambda found, known=known: known.format(**found.groupdict()), code)  # type: ignore[misc]
        lit = lit or any(float(m[1]) in (*control.starts, 3.0, 4.0) for m in re.finditer(r"M0*([0-9]+)", code))
        if re.match(r"G0*4(?![0-9.])", code) and (found := re.search(f"{control.dwell}({_NUMBER})", code)):
            yield float(found[1]) * control.dwell_s, lit


def _is_halt(block: str) -> bool:
    found = re.fullmatch(r"M0*([0-9]+)", block.strip().upper())
    return found is not None and float(found[1]) in HALTS


def _program_names(dialect: Dialect) -> Iterator[re.Pattern[str]]:
    """Rows by which a program is called on the control, as the header has them."""
    for block in dialect.header:
        if "{program}" in block:
            before, after = (re.escape(_code(text)) for text in block.split("{program}"))
            yield re.compile(f"{before}[0-9]+{after}")
        elif re.fullmatch(r"[O:][0-9]+", _code(block)):
            yield re.compile(_code(block))


def _comment_form(dialect: Dialect) -> tuple[str, str] | None:
    """What a comment begins and ends with, where that is not ( )."""
    if dialect.comment is None:
        return None
    before, after = (text.strip() for text in dialect.comment.split("{text}"))
    if before.startswith("(") or not re.match(r"[^A-Za-z0-9%+.-]|[A-Za-z]{2}", before):  # that would be a word
        return None
    return before, after


def _code(text: str) -> str:
    return text.replace(" ", "").upper()


def _code_number(word: str, file: str) -> float:
    found = re.fullmatch(r"G([0-9]+(?:\.[0-9])?)", word.upper())
    if found is None:
        raise _wrong(file, "reads", f"reads.fixed: expected G words such as G21, got {word!r}")
    return float(found[1])


def _template(text: str) -> str:
    """The code that words stand for, with the names of its numbers as they are written."""
    return "".join(f"{_code(literal)}{{{name}}}" if name else _code(literal) for literal, name, _, _ in _parsed(text))


def _parsed(text: str) -> Iterator[tuple[str, str | None, str | None, str | None]]:
    return iter(Formatter().parse(text))


def _regex(text: str, named: bool = False) -> re.Pattern[str]:
    """Words as a row's code has them: leading zeros do not count, and no digit goes on behind them.

    With `named` the numbers have the names that stand for them.
    """
    pattern = ""
    for literal, name, _, _ in Formatter().parse(text):
        pattern += re.sub(r"(?<![0-9.])0*([0-9]+)(?![0-9.])", r"0*\1(?:\\.0*)?", re.escape(_code(literal)))
        pattern += (f"(?P<{name}>{_NUMBER})" if named and name else _NUMBER) if name is not None else ""
    begins = r"(?<![A-Z])" if pattern[:1].isalpha() else ""
    return re.compile(f"{begins}{pattern}" + ("(?![0-9.])" if pattern[-1:] not in "=);" else ""))


def _pattern(also: Also, control: Control, file: str) -> Declared:
    bare = _code(Formatter().vformat(also.words, (), _Ones()))
    known = []
    for found in _TOKEN.finditer(bare):
        letter, value = found["letter"] or "", float(found["number"] or 0)
        if letter in _PLACES and found["number"]:
            raise _wrong(file, "also", f"also: {also.words!r} names a place ({found[0]}): such a word moves the torch")
        is_known = (letter == "G" and value in control.known_g) or (letter == "M" and value in control.known_m)
        known.append(is_known or letter == "F" or (letter == "S" and control.beam))
    if control.arcs and bare.partition("+")[0].isdigit():
        known = [int(bare.partition("+")[0]) in OBEYED]
    elif control.arcs and bare[:1] in "+-":
        raise _wrong(file, "also", f"also: {also.words!r} is a move")
    if known and all(known):
        ends = "ends the program" if bare in {f"M{code:g}" for code in ENDS} else "has a meaning of its own"
        text = (
            f"also: {also.words!r} {ends} on {control.title}, and is checked: only words that it does not know may be"
        )
        raise _wrong(file, "also", f"{text} said to touch neither path nor torch")
    return Declared(_regex(also.words), also.where, also.words)


class _Ones(dict[str, object]):
    def __missing__(self, key: str) -> str:
        return "1"


def _wrong(file: str, key: str, text: str) -> InputError:
    place = place_in(file, (key,)) if file.endswith(ENDINGS) else None
    return wrong_at(place, text) if place is not None else InputError(text, file=file or None)
