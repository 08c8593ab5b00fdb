"""A dialect proposed from old programs: what a plant's post prints today, and what cannot be told from it.

Rows are taken to pieces by their spelling alone: what stands between a travel and the first line or arc starts the
torch, what stands between the last one and the next travel stops it, and what comes before and behind all is header and
footer. The nearest dialect that comes with kerfwise has the rest. Whether the check reads the proposal back is said.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check.reader.controls import Control, row_of, without
from kerfwise.postproc.check.reader.own_words import control_for
from kerfwise.postproc.check.reader.words import BOUNDS
from kerfwise.postproc.dialects.load import load_dialect, new_dialect_text, parse_dialect
from kerfwise.postproc.verdict.dialect_read_back import read_back
from kerfwise.rules.options.yaml_positions import with_value

_COMMENTED = re.compile(r"\([^()]*\)|;.*")
_WORD = re.compile(r"([A-Z$]+)([-+]?[0-9]*[.,]?[0-9]*)")
_NUMBER = re.compile(r"^\s*N\s*([0-9]+)\s*", re.IGNORECASE)
_WAIT = re.compile(r"G0*4\s*([A-Z])\s*([0-9.,]+)")
_NAME = re.compile(r"(?P<letter>[O:P])(?P<digits>[0-9]{1,8})")
_PLACES = frozenset("XYIJR")
_KERF, _KERF_OFF = re.compile(r"G0*4([12])(\.1)?(?![0-9.])"), re.compile(r"G0*40(?![0-9.])")
_ROUND_MM = 0.05
_DECIMALS = 3
_TOLD_BY_HEADER: Sequence[tuple[set[float], str]] = (
    ({17}, "G17"),
    ({40}, "G40"),
    ({94}, "G94"),
    ({61, 61.1, 64}, "G61"),
    ({90, 91}, "G90"),
)
"""What a program has to say before it moves, where its control can be told it, and what holds where it does not."""


@dataclass(frozen=True, slots=True)
class _Line:
    """A row without its number and its comments: its text, its words, and what it moves by."""

    text: str
    words: tuple[tuple[str, str], ...]
    motion: str
    said: bool

    @property
    def moves(self) -> bool:
        """Whether it names a place."""
        return any(letter in ("X", "Y") for letter, _ in self.words)

    @property
    def travels(self) -> bool:
        """Whether it is a travel."""
        return self.moves and self.motion.lstrip("G").lstrip("0") == ""


@dataclass(slots=True)
class Proposal:
    """The text of a dialect, what it was told from, and what could not be told."""

    like: str
    values: dict[str, object] = field(default_factory=dict)
    unsure: list[str] = field(default_factory=list)

    def text(self, name: str, files: Sequence[str]) -> str:
        """The file of the dialect under a name."""
        body = new_dialect_text(name, self.like).split("\n", 1)[1]
        body = "\n".join(row for row in body.split("\n") if row.strip() and not row.startswith("#"))
        for key, value in self.values.items():
            body = with_value(
                body, [key], yaml.safe_dump(value, default_flow_style=True, width=1e9).split("\n...")[0].strip()
            )
        lines = [f"# Told from {' and '.join(files)}; what is not told from these is as in {self.like}."]
        lines += ["# What could not be told:", *(f"# - {text}" for text in self.unsure)] if self.unsure else []
        return "\n".join([*lines, *(row for row in body.split("\n") if row.strip()), ""])


def propose_dialect(texts: Sequence[str], like: str | None = None) -> Proposal:
    """A dialect for the control that these programs were written for; `like` is the one to begin with, where known.

    Raises InputError if a program holds no travel with a line or an arc behind it.
    """
    programs = [list(_lines(text)) for text in texts]
    for program, text in zip(programs, texts, strict=True):
        if not any(line.travels for line in program) or not any(line.moves and not line.travels for line in program):
            raise InputError(
                "no travel (G0) with a line or an arc (G1, G2, G3) behind it: nothing can be told of what starts and "
                "stops the torch; give the dialect to begin with (--like), and change it by hand",
                line=len(text.split("\n")),
            )
    programs, kerf = _without_kerf(programs)
    on, off = _tools(programs)
    proposal = Proposal(like or _nearest(texts, programs, on))
    _kerf_words(proposal, kerf)
    _tool_words(proposal, on, off)
    _spelling(proposal, texts, programs)
    _frame(proposal, programs)
    _own_words(proposal)
    _in_force(proposal)
    proposal.values["assumes"] = {}
    return proposal


def try_proposal(proposal: Proposal, name: str, files: Sequence[str]) -> str:
    """The text of the proposal; what the check says against it is among what could not be told."""
    text = proposal.text(name, files)
    try:
        read_back(parse_dialect(text, f"{name}.yaml"), name)
    except InputError as error:
        proposal.unsure.append(f"the check does not read it back yet: {error.message}")
        text = proposal.text(name, files)
    return text


def _lines(text: str) -> Iterator[_Line]:
    motion = ""
    for raw in text.replace("\r", "").split("\n"):
        bare = _COMMENTED.sub("", _NUMBER.sub("", raw, count=1)).strip().upper()
        bare = re.sub(r"(?<=[A-Z$])\s+(?=[-+0-9.])", "", bare)
        if not bare:
            continue
        words = tuple((letter, number) for letter, number in _WORD.findall(bare))
        moved = [
            f"G{number}" for letter, number in words if letter == "G" and number.lstrip("0") in ("", "1", "2", "3")
        ]
        motion = moved[0] if moved else motion
        yield _Line(bare, words, motion, bool(moved))


def _without_kerf(programs: Sequence[Sequence[_Line]]) -> tuple[list[list[_Line]], Counter[str]]:
    """The programs without the rows that have the control add the kerf and leave it again; these, and how often."""
    found, kept = Counter[str](), list[list[_Line]]()
    for program in programs:
        rest, beside = list[_Line](), False
        for line in program:
            if _KERF.search(line.text) or (beside and _KERF_OFF.search(line.text)):
                found[line.text] += 1
                beside = bool(_KERF.search(line.text))
                if not line.moves:
                    continue
            rest.append(line)
        kept.append(rest)
    return kept, found


def _kerf_words(made: Proposal, kerf: Counter[str]) -> None:
    """The words by which the control adds the kerf, where these programs have it do so."""
    sides = [text for text, _ in kerf.most_common() if _KERF.search(text)]
    if not sides:
        return
    alone = [text for text in sides if not re.search("[XY]", text)]
    if not alone:
        made.unsure.append(f"the control adds the kerf, within a move ({sides[0]}): kerf is as its defaults are")
    spelt = re.sub(r"(?<=D)[0-9.,]+", "{kerf}", alone[0]) if alone and ".1" in alone[0] else (alone or ["G41"])[0]
    off = next((text for text, _ in kerf.most_common() if text not in sides and not re.search("[XY]", text)), "G40")
    dynamic = ".1" if ".1" in spelt else ""
    words = {key: _KERF.sub(f"G4{n}{dynamic}", spelt) for key, n in (("left", 1), ("right", 2))}
    made.values["kerf"] = {**words, "off": off}
    made.unsure.append("the control adds the kerf: which, its table has to say, or the word itself ({kerf})")


def _tools(programs: Sequence[Sequence[_Line]]) -> tuple[Counter[tuple[str, ...]], Counter[tuple[str, ...]]]:
    """What stands between a travel and the path behind it, and between a path and the travel behind that; how often."""
    on, off = Counter[tuple[str, ...]](), Counter[tuple[str, ...]]()
    for program in programs:
        moves = [k for k, line in enumerate(program) if line.moves]
        for a, b in pairwise(moves):
            between = tuple(line.text for line in program[a + 1 : b] if line.text != "%")
            if program[a].travels and not program[b].travels:
                on[between] += 1
            elif not program[a].travels and program[b].travels:
                off[between] += 1
    return on, off


def _nearest(texts: Sequence[str], programs: Sequence[Sequence[_Line]], on: Counter[tuple[str, ...]]) -> str:
    """The dialect whose words are nearest."""
    starts = " ".join(" ".join(block) for block in on)
    if "$" in starts:
        return "linuxcnc-qtplasmac"
    if re.search(r"M0*7(?![0-9])", starts):
        return "eia"
    if re.search(r"M0*4(?![0-9])", starts) or any(
        re.search(r"G0*1\b.*\bS[0-9]", line.text) for p in programs for line in p
    ):
        return "grbl"
    if re.search(r"M0*3(?![0-9])", starts):
        return "linuxcnc"
    return "eia"


def _tool_words(proposal: Proposal, on: Counter[tuple[str, ...]], off: Counter[tuple[str, ...]]) -> None:
    (starts, times), *others = on.most_common()
    stops = off.most_common(1)[0][0] if off else ()
    blocks: list[str] = []
    for text in starts:
        if found := _WAIT.fullmatch(text):
            if "{dwell}" not in blocks:
                blocks.append("{dwell}")
                proposal.values["dwell"] = f"{text[: found.start(1)].strip()} {found[1]}{{seconds}}"
                proposal.values["pierce_dwell"] = "program"
            continue
        if re.fullmatch(r"F[0-9.,]+", text):
            proposal.unsure.append(f"{text} stands alone where the torch starts: the feed is written with the path")
            continue
        blocks.append(text)
    if "{dwell}" not in blocks:
        proposal.values["pierce_dwell"] = "machine"
    proposal.values["torch_on"] = blocks or ["M3"]
    proposal.values["torch_off"] = list(stops) or ["M5"]
    if not blocks:
        proposal.unsure.append(
            "no word stands between a travel and the path behind it: what starts the torch is a guess"
        )
    if not stops:
        proposal.unsure.append(
            "no word stands between a path and the travel behind it: what stops the torch is a guess"
        )
    height_off, height_on = load_dialect(proposal.like).height_off, load_dialect(proposal.like).height_on
    others = [(block, n) for block, n in others if block != (*starts, *height_off) or not height_off]
    marks = [block for block, _ in others if _codes(block) and _codes(block) != _codes(starts)]
    if marks:
        shown = "; ".join(" / ".join(block) for block in marks[:3])
        proposal.unsure.append(
            f"{sum(n for b, n in others if b in marks)} of {times + sum(n for _, n in others)} starts are otherwise "
            f"({shown}): are these marks (mark_on, mark_off), or a kind of contour (around)?"
        )
    else:
        proposal.values |= {"mark_on": None, "mark_off": None}
        proposal.unsure.append("nothing is marked in these programs: mark_on and mark_off are left empty")
    ends = [block for block, _ in off.most_common(4)[1:] if block != (*height_on, *stops) or not height_on]
    if ends:
        shown = "; ".join(" / ".join(block) or "nothing" for block in ends)
        proposal.unsure.append(f"paths also end with {shown}: what does that say?")


def _codes(block: Sequence[str]) -> tuple[str, ...]:
    """The M words of some rows, as codes."""
    return tuple(f"M{int(number)}" for text in block for number in re.findall(r"M([0-9]+)", text))


def _spelling(proposal: Proposal, texts: Sequence[str], programs: Sequence[Sequence[_Line]]) -> None:
    lines = [line for program in programs for line in program]
    numbers = [number for line in lines for letter, number in line.words if letter in _PLACES and number]
    values = proposal.values
    values["newline"] = "crlf" if all("\r\n" in text for text in texts) else "lf"
    comma = any("," in number for number in numbers)
    if comma:
        values["decimal"] = ","
    pointed = [number for number in numbers if "." in number or "," in number]
    digits = [len(number.replace(",", ".").partition(".")[2]) for number in numbers]
    decimals = min(max(digits, default=0), 6)
    if pointed and decimals < _DECIMALS:
        proposal.unsure.append(f"places have {decimals} decimals at most here: {_DECIMALS} are written")
    values["decimals"] = max(decimals, _DECIMALS) if pointed else decimals
    if pointed and len(pointed) == len(numbers):
        if len(set(digits)) == 1 and digits[0] > 0:
            values["trailing_zeros"] = True
        elif any(number.endswith((".", ",")) for number in numbers):
            values["whole_point"] = True
        else:
            proposal.unsure.append("whole numbers have a point and a zero (X10.0): written as X10 here")
    if not pointed:
        proposal.unsure.append("no place has a decimal point: are they whole mm, or steps (scale, reads: {step: …})?")
    moving = [line for line in lines if line.moves]
    words = [
        name
        for name, left_out in (("motion", _left_out(moving)), ("x", _lacks(moving, "X")), ("y", _lacks(moving, "Y")))
        if left_out
    ]
    feeds = [line for line in moving if not line.travels]
    if sum(any(letter == "F" for letter, _ in line.words) for line in feeds) < _cuts(lines):
        words.append("feed")
    if words:
        values["modal"] = words
    spelt = _blanks(texts)
    if spelt is not None:
        values["blanks"] = spelt
    _motions(proposal, lines, moving)
    _line_numbers(proposal, texts)
    _comments(proposal, texts)


def _left_out(moving: Sequence[_Line]) -> bool:
    return any(not line.said for line in moving)


def _lacks(moving: Sequence[_Line], axis: str) -> bool:
    return any(axis not in [letter for letter, _ in line.words] for line in moving if not line.travels)


def _cuts(lines: Sequence[_Line]) -> int:
    moves = [line for line in lines if line.moves]
    return sum(a.travels and not b.travels for a, b in pairwise(moves))


def _blanks(texts: Sequence[str]) -> bool | None:
    """Whether blanks stand between words; None where no row tells."""
    rows = [_COMMENTED.sub("", _NUMBER.sub("", row, count=1)).strip() for text in texts for row in text.split("\n")]
    telling = [row for row in rows if len(_WORD.findall(row.upper())) > 1]
    return None if not telling else any(re.search(r"[0-9.] +[A-Z]", row.upper()) for row in telling)


def _motions(proposal: Proposal, lines: Sequence[_Line], moving: Sequence[_Line]) -> None:
    """How travel, lines and arcs are spelt, and how the centres of arcs are told."""
    for key, code in (("rapid", "0"), ("line", "1"), ("arc_cw", "2"), ("arc_ccw", "3")):
        motions = [
            line.motion for line in lines if line.said and line.motion.lstrip("G").lstrip("0") == code.replace("0", "")
        ]
        if motions:
            proposal.values[key] = Counter(motions).most_common(1)[0][0]
        else:
            proposal.unsure.append(f"no {key} is in these programs: it is as in {proposal.like}")
    arcs = [line for line in moving if line.motion.lstrip("G").lstrip("0") in ("2", "3")]
    if not arcs:
        proposal.unsure.append("no arc is in these programs: whether it knows them, and how, is not told")
    elif any(letter == "R" for line in arcs for letter, _ in line.words):
        proposal.values["arc_centre"] = "radius"
    else:
        proposal.values["arc_centre"] = _centres(proposal, moving)


def _centres(proposal: Proposal, moving: Sequence[_Line]) -> str:
    """Whether I and J count from the arc's start or from the origin: by which the radius stays the same."""
    errors = {"relative": 0.0, "absolute": 0.0}
    x = y = 0.0
    for line in moving:
        at = {letter: float(number.replace(",", ".")) for letter, number in line.words if letter in _PLACES and number}
        end = at.get("X", x), at.get("Y", y)
        if line.motion.lstrip("G").lstrip("0") in ("2", "3"):
            i, j = at.get("I", 0.0), at.get("J", 0.0)
            for way, (cx, cy) in (("relative", (x + i, y + j)), ("absolute", (i, j))):
                off = abs(((x - cx) ** 2 + (y - cy) ** 2) ** 0.5 - ((end[0] - cx) ** 2 + (end[1] - cy) ** 2) ** 0.5)
                errors[way] = max(errors[way], off)
        x, y = end
    best = min(errors, key=lambda way: errors[way])
    if errors[best] > _ROUND_MM:
        proposal.unsure.append("the centres of arcs fit neither the arc's start nor the origin: is it G91?")
        return "relative"
    return best


def _line_numbers(proposal: Proposal, texts: Sequence[str]) -> None:
    found = [int(number[1]) for row in texts[0].split("\n") if (number := _NUMBER.match(row))]
    if len(found) < 2:
        proposal.values["line_numbers"] = None
        return
    step = Counter(b - a for a, b in pairwise(found) if b > a).most_common(1)
    values = {"start": max(found[0], 1), "step": step[0][0] if step else 1}
    if any(b < a for a, b in pairwise(found)):
        values["highest"] = max(found)
    proposal.values["line_numbers"] = values


def _comments(proposal: Proposal, texts: Sequence[str]) -> None:
    joined = "\n".join(texts)
    if re.search(r"\([^()]*\)", joined):
        proposal.values["comment"] = "({text})"
    elif re.search(r"^\s*;", joined, re.MULTILINE):
        proposal.values["comment"] = "; {text}"
    else:
        proposal.unsure.append(
            f"no comment is in these programs: whether the control knows any is as in {proposal.like}"
        )


def _frame(proposal: Proposal, programs: Sequence[Sequence[_Line]]) -> None:
    """Header and footer: what all programs have before their first place and behind their last."""
    heads, tails, ends = [], [], []
    for program in programs:
        first = next(k for k, line in enumerate(program) if line.moves)
        last = max(k for k, line in enumerate(program) if line.moves)
        heads.append([line.text for line in program[:first]])
        ends.append(program[last])
        tails.append([line.text for line in program[last + 1 :]])
    header = [text for text in heads[0] if all(text in head for head in heads) or _NAME.fullmatch(text)]
    kept = [text for text in header if not re.fullmatch(r"[FS][0-9.,]+", text)]
    if dropped := [text for text in heads[0] if text not in kept]:
        proposal.unsure.append(
            f"{', '.join(dropped[:4])} at the top is not the same in both, or is a feed: it is left out"
        )
    for k, text in enumerate(kept):
        if found := _NAME.fullmatch(text):
            kept[k] = f"{found['letter']}{{program}}"
            proposal.values["program"] = {"number": max(int(found["digits"]) % 3601, 1), "digits": len(found["digits"])}
    stops = _list(proposal.values["torch_off"])
    footer = tails[0] if tails[0][: len(stops)] != stops or ends[0].travels else tails[0][len(stops) :]
    proposal.values["header"] = kept
    if footer:
        proposal.values["footer"] = footer
    codes = {word for text in heads[0] for word in re.findall(r"G[0-9.]+", text)}
    if codes & {"G20", "G70"}:
        proposal.values["units"] = "inch"
    if "G91" in codes:
        proposal.values["positions"] = "incremental"


def _own_words(proposal: Proposal) -> None:
    """Words that the control's family does not know: proposed as harmless, for somebody to confirm."""
    control = control_for(parse_dialect(new_dialect_text("shop", proposal.like), "shop.yaml"))
    keys = ("header", "torch_on", "torch_off", "footer")
    blocks = [text for key in keys for text in _list(proposal.values.get(key, [])) if "{" not in text and text != "%"]
    own = list(dict.fromkeys(word for block in blocks if (word := _unknown_of(block, control))))
    if own:
        proposal.values["also"] = own
        proposal.unsure.append(
            f"{'; '.join(own[:8])}: nobody here knows what it does; it is carried as said under also: confirm that it "
            "touches neither the path nor the torch, or say what it means (reads: {means: …})"
        )


def _unknown_of(block: str, control: Control) -> str:
    """The words of a block that a control does not know, with the numbers that go with them; "" where it knows all."""
    row = row_of(block, 1, control.opens)
    for also in control.also:
        while found := also.pattern.search(row.code):
            row = without(row, found)
    words = _WORD.findall(row.code)
    if any(letter == "Z" for letter, _ in words):
        return block
    known = {"G": control.known_g, "M": control.known_m}
    strange = [letter in known and float(number or -1) not in known[letter] for letter, number in words]
    if not any(strange) and all(letter in BOUNDS or letter in known for letter, _ in words):
        return ""
    kept = (
        f"{letter}{number}"
        for (letter, number), odd in zip(words, strange, strict=True)
        if odd or letter not in ("G", "M", "F", "X", "Y")
    )
    return " ".join(kept)


def _in_force(proposal: Proposal) -> None:
    """Words that nobody says, since the control is in them: what else a program would have to say at its top."""
    dialect = load_dialect(proposal.like)
    known: frozenset[float] = control_for(dialect).known_g - control_for(dialect).fixed
    header = " ".join(_list(proposal.values.get("header", [])))
    in_force = {float(code) for code in re.findall(r"G([0-9]+(?:\.[0-9])?)", header)}
    centres = "G90.1" if proposal.values.get("arc_centre") == "absolute" else "G91.1"
    needed: list[tuple[set[float], str]] = [*_TOLD_BY_HEADER, ({90.1, 91.1}, centres)]
    fixed = [word for codes, word in needed if codes & known and not codes & in_force]
    unit = known & {20.0, 21.0, 70.0, 71.0}
    if unit and not unit & in_force:
        proposal.unsure.append("the programs do not say their units: mm is assumed")
        fixed.append("G21" if 21.0 in known else "G71")
    reads: dict[str, object] = {"fixed": fixed} if fixed else {}
    if fixed:
        proposal.unsure.append(
            f"the programs do not say {', '.join(fixed)}: taken to be in force (reads: {{fixed: …}})"
        )
    starts = " ".join(_list(proposal.values.get("torch_on", [])))
    if dialect.control.startswith("linuxcnc") and re.search(r"M0*3(?![0-9])", starts) and "S" not in starts:
        reads["means"] = {"M3": "M3 S1"}
        proposal.unsure.append("M3 has no S word: LinuxCNC starts nothing without one, unless the machine is set so")
    if reads:
        proposal.values["reads"] = reads


def _list(value: object) -> list[str]:
    return [str(one) for one in value] if isinstance(value, list) else []
