"""Which words may stand in one block: one of each modal group, and no number that nothing uses."""

from __future__ import annotations

from collections.abc import Mapping

from .controls import Control
from .words import Block, Word

MOTION = frozenset({0.0, 1.0, 2.0, 3.0})
ARCS = frozenset({2.0, 3.0})
DWELL, NO_MOTION, ROUNDING, PER_MINUTE = 4.0, 80.0, 64.0, 94.0
UNCHANGING = frozenset({17.0, 40.0, 54.0, 92.1, 94.0, 97.0})
"""Words that all others of their group are refused for, so that nothing of what they say ever changes."""
_KERF = "the control would shift the path by its own kerf, which the program does not show; post the program without"
_PLANE = "arcs outside the XY plane are not checked; post the program with G17"
_REFUSED_G: Mapping[float, str] = {18.0: _PLANE, 19.0: _PLANE, 41.0: _KERF, 42.0: _KERF, 41.1: _KERF, 42.1: _KERF}
_G_GROUPS: Mapping[str, frozenset[float]] = {
    "motion": MOTION | {NO_MOTION},
    "non-modal": frozenset({DWELL}),
    "plane": frozenset({17.0}),
    "units": frozenset({20.0, 21.0, 70.0, 71.0}),
    "kerf": frozenset({40.0}),
    "tool length": frozenset({49.0}),
    "coordinate system": frozenset({54.0}),
    "rounding": frozenset({61.0, 61.1, ROUNDING}),
    "distance": frozenset({90.0, 91.0}),
    "arc centres": frozenset({90.1, 91.1}),
    "offsets": frozenset({92.1}),
    "feed": frozenset({PER_MINUTE}),
    "spindle": frozenset({97.0}),
}
_M_GROUPS: Mapping[str, frozenset[float]] = {
    "stops": frozenset({0.0, 1.0, 2.0, 30.0}),
    "outputs": frozenset({64.0, 65.0, 67.0, 68.0}),
    "torch": frozenset({3.0, 4.0, 5.0}),
    "gas": frozenset({7.0, 8.0, 9.0, 10.0, 15.0, 16.0}),
    "height": frozenset({14.0}),
    "process": frozenset({36.0}),
    "stations": frozenset({37.0, 38.0}),
    "overrides": frozenset({48.0, 49.0, 50.0, 51.0, 52.0, 53.0}),
}
_GROUP_OF_G = {code: name for name, codes in _G_GROUPS.items() for code in codes}
_GROUP_OF_M = {code: name for name, codes in _M_GROUPS.items() for code in codes}
_USES_M: Mapping[float, str] = {
    3.0: "S$", 4.0: "S", 5.0: "$", 50.0: "P", 51.0: "P", 52.0: "P", 53.0: "P",
    36.0: "T", 37.0: "T", 38.0: "T", 64.0: "P", 65.0: "P", 67.0: "EQ", 68.0: "EQ",
}  # fmt: skip
_USES_MOTION: Mapping[float | None, str] = {None: "", 0.0: "XY", 1.0: "XY", 2.0: "XYIJRP", 3.0: "XYIJRP"}


def group_of(word: Word) -> str:
    """The modal group of a G or M word that is known here."""
    return (_GROUP_OF_M if word.letter == "M" else _GROUP_OF_G)[word.value]


def motion_of(block: Block, modal: float | None, control: Control) -> float | None:
    """The motion that a block makes: its own word's, else the one in force, where the block has a word for it."""
    if block.has_g(DWELL):
        return None
    for word in block.g:
        if word.value in MOTION:
            return word.value
        if word.value == NO_MOTION:
            return None
    letters = "XYIJ" if modal in ARCS and not control.bare else "XY"
    return modal if any(letter in block.words for letter in letters) else None


def refuse_conflicts(block: Block, motion: float | None, control: Control) -> None:
    """Refuse words that do not belong into one block; `motion` is the motion that it makes.

    Raises
    ------
    InputError
        With line and column.
    """
    _known_once(block, block.g, _GROUP_OF_G, control)
    _known_once(block, block.m, _GROUP_OF_M, control)
    if block.has_g(DWELL):
        moved = any(letter in block.words for letter in "XYIJR" if letter != control.dwell)
        if moved or any(word.value in MOTION for word in block.g):
            raise block.refused("a wait (G4) and a move in one block are not supported here; write them on two lines")
    users: dict[str, list[str]] = {}
    for word in block.g:
        _note(users, word.text, {DWELL: control.dwell, ROUNDING: "PQ"}.get(word.value, ""))
    for word in block.m:
        switches = word.value in control.starts or word.value in control.stops
        letters = "" if switches else _USES_M.get(word.value, "")
        _note(users, word.text, letters.replace("$", "") if control.beam else letters)
    _note(users, "the motion", _USES_MOTION[motion])
    for letter, word in block.words.items():
        if letter == "F" or (letter == "S" and control.beam):
            continue
        if letter not in users:
            raise block.refused(_unused(letter, control), word)
        if letter == "P" and len(users[letter]) > 1:
            text = f"{word.text} is meant for {' or '.join(users[letter])}: not supported here; write them on two lines"
            raise block.refused(text, word)


def _note(users: dict[str, list[str]], user: str, letters: str) -> None:
    for letter in letters:
        users.setdefault(letter, []).append(user)


def _known_once(block: Block, words: tuple[Word, ...], groups: Mapping[float, str], control: Control) -> None:
    seen: dict[str, Word] = {}
    for word in words:
        if word.letter == "G" and word.value in _REFUSED_G:
            raise block.refused(f"{word.text} is not supported here: {_REFUSED_G[word.value]}", word)
        if word.letter == "M" and (why := control.refused_m.get(word.value)):
            raise block.refused(f"{word.text} is not supported here: {why}", word)
        group = groups.get(word.value)
        if group is None or word.value not in (control.known_m if word.letter == "M" else control.known_g):
            raise block.refused(
                f"{word.text} is not understood, and not supported here, in a program for {control.title}, the control "
                "of the profile's dialect; post the program without",
                word,
            )
        if group in seen:
            first = seen[group].text
            raise block.refused(
                f"{first} and {word.text} are of one group ({group}), of which a block holds one; not supported here; "
                "write them on two lines",
                word,
            )
        seen[group] = word


def _unused(letter: str, control: Control) -> str:
    expected = {
        "S": "M3: another change of the torch's power is not checked, and not supported here",
        "$": "M3 or M5: not supported here",
        "P": "G4, G64 or an arc",
        "Q": "G64, M67 or M68",
        "E": "M67 or M68",
    }
    expected |= dict.fromkeys("XY", "a motion word (G0, G1, G2 or G3)")
    if control.dwell != "P":
        expected["P"] = f"none; the time of a wait is given by {control.dwell} here, such as G04 {control.dwell}0.5"
    expected |= dict.fromkeys("IJR", "an arc (G2 or G3)")
    expected |= dict.fromkeys("DHLT", "none, what it chooses is not supported here")
    return f"{letter} without a word that uses it: expected {expected[letter]}"
