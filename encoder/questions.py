"""Questions that a drawing raises: what it does not decide, with the choices, and the answers that were given.

Whoever reads a nest asks through `Asking.ask`. An answer that was given is taken; without one the likeliest choice is
taken for the time being, so that later questions are found too, and `Questions` is raised once all are known.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from .errors import InputError
from .escape import escape_text
from .nearest_name import nearest

Answers = tuple[tuple[str, str], ...]
"""The id of a question and the value of the choice, in the order in which they were given: the last one stands."""

ANSWERED, LIKELIEST = "as answered", "the likeliest, until it is answered"
"""Why something is taken for what it is that a question is about."""

NARROW, SMALL_HOLES, SHARED_EDGES = "narrow", "small-holes", "shared-edges"
"""The ids of the questions that arise when a nest is to be cut: slots narrower than the kerf, small holes, and parts
that share an edge, or are one kerf apart."""

OF_CUTTING = (NARROW, SMALL_HOLES, SHARED_EDGES)
OF_DRAWING = ("units", "clip", "mask", "fill", "paper", "off-page")
"""Those that arise as the lines of a file are read, before any of them is taken for something."""

LAYER = "layer:"
"""How the id of a question about a layer begins; the layer's name follows."""


_USES = ("cut", "mark", "ignore", "sheet", "scrap", "bridge", "tab")
_UNITS = ("mm", "cm", "m", "in", "ft", "pt", "px", "dm", "yd", "mil", "um", "us-ft", "72dpi", "90dpi", "96dpi")
CHOICES: Mapping[str, tuple[str, ...]] = {
    "units": _UNITS,
    "frame": ("sheet", "part"),
    LAYER: (*_USES, "open:mark", "open:ignore", "open:close", "open:shared"),
    "colour:": _USES,
    "linetype:": _USES,
    "text": ("mark", "ignore"),
    "text:": ("mark", "ignore"),
    "point": ("mark", "ignore"),
    "point:": ("mark", "ignore"),
    "doubled": ("outer", "inner", "both"),
    "overlap": ("join", "notch", "largest", "refuse"),
    "thin": ("ignore", "mark", "cut"),
    "clip": ("clipped", "whole", "ignore"),
    "mask": ("whole", "ignore"),
    "paper": ("read", "ignore"),
    "off-page": ("ignore", "cut"),
    "fill": ("cut", "ignore"),
    "crossing": ("outline", "loops", "largest", "corners"),
    NARROW: ("leave", "slit", "refuse"),
    SMALL_HOLES: ("skip", "spot", "cut", "refuse"),
    SHARED_EDGES: ("once", "pierced", "refuse"),
}
"""Every question that there is, with all choices that it may have; after a colon follows what it is about."""


OF_LISTS = "row:"
"""How the id of a question about parts of a list begins; what they are of follows. Its choices are rows of a chart."""
OF_LAYERS = ("layer", "text", "point")
"""The questions that are about a layer."""


def answer_problem(question: str, choice: str) -> tuple[str, bool] | None:
    """What is wrong with an answer, whatever the drawing, and whether that is the choice; None where nothing is.

    What is asked of a list is answered by what its profiles offer: whoever asks looks at that.

    Examples
    --------
    >>> answer_problem("frame", "part"), answer_problem("layer:0", "cut,open:mark"), answer_problem("layer:A=B", "cut")
    (None, None, None)
    >>> answer_problem("Frame", "sheet")
    ("no drawing raises a question 'Frame': did you mean 'frame'?", False)
    >>> answer_problem("frame", "stock")
    ('the answer frame=stock is none of the choices: expected sheet, part', True)
    """
    word, colon, about = question.partition(":")
    if f"{word}{colon}" == OF_LISTS:
        return None
    if f"{word}{colon}" not in CHOICES:
        known = CHOICES if not colon else [name for name in CHOICES if name.endswith(":")]
        guess = nearest(f"{word}{colon}", known)
        meant = f": did you mean '{guess}{about if guess.endswith(':') else ''}'?" if guess else ""
        listed = "" if guess else f"; there are {', '.join(CHOICES)}"
        return f"no drawing raises a question '{question}'{meant}{listed}", False
    choices = CHOICES[f"{word}{colon}"]
    if set(choice.split(",") if colon else [choice]) <= set(choices):
        return None
    return f"the answer {question}={choice} is none of the choices: expected {', '.join(choices)}", True


@dataclass(frozen=True, slots=True)
class Choice:
    """One answer: the value that a flag takes, what it means, and what it would give, as far as that is known."""

    value: str
    words: str
    gives: str = ""


@dataclass(frozen=True, slots=True)
class Question:
    """What nobody but a person can say; the likeliest choice stands first.

    Examples
    --------
    >>> choices = Choice("sheet", "the sheet", "3 parts"), Choice("part", "a part")
    >>> frame = Question("frame", "is it the sheet?", choices)
    >>> print(frame.told())
    frame: is it the sheet?
        --answer frame=sheet   the sheet: 3 parts
        --answer frame=part    a part
    """

    id: str
    text: str
    choices: tuple[Choice, ...]

    def __post_init__(self) -> None:
        wrong = [problem for choice in self.choices if (problem := answer_problem(self.id, choice.value))]
        assert not wrong, f"CHOICES forgets this: {wrong[0][0]}"

    def flag(self, choice: Choice) -> str:
        """The option that gives this answer, as it is typed in a shell."""
        answer = f"{self.id}={choice.value}"
        plain = answer.replace(":", "").replace("=", "").replace("_", "").replace("-", "").replace(",", "")
        return f"--answer {answer}" if plain.isalnum() and answer.isascii() else f'--answer "{answer}"'

    def told(self) -> str:
        """The question and its choices, a line each."""
        flags = [self.flag(choice) for choice in self.choices]
        wide = max(map(len, flags), default=0)
        rows = [
            f"    {flag:{wide}}   {choice.words}{f': {choice.gives}' if choice.gives else ''}"
            for flag, choice in zip(flags, self.choices, strict=True)
        ]
        return "\n".join([f"{self.id}: {self.text}", *rows])

    def as_json(self) -> dict[str, Any]:
        """The question as data."""
        rows = [
            {"value": c.value, "words": c.words, "gives": c.gives, "flag": self.flag(c).removeprefix("--answer ")}
            for c in self.choices
        ]
        return {"id": self.id, "text": self.text, "choices": rows}


class Questions(InputError):
    """A drawing raises questions that nobody has answered; nothing is made of it until they are.

    `questions` are all of them. `reading` is how the drawing is read with the first choice of each, where that is
    known. The command line shows them and ends with exit code 3.
    """

    def __init__(self, questions: Sequence[Question], *, file: str | Path | None = None, reading: Any = None) -> None:
        self.questions, self.reading = tuple(questions), reading
        count = len(self.questions)
        which = "a question that nobody has answered" if count == 1 else f"{count} questions that nobody has answered"
        super().__init__(f"the drawing raises {which}", file=file, details=tuple(q.told() for q in self.questions))

    def _text(self) -> str:
        place = f"{escape_text(str(self.file))}: " if self.file is not None else ""
        lines = [
            f"  {k}. " + "\n".join(escape_text(line) for line in question.told().split("\n")).replace("\n", "\n  ")
            for k, question in enumerate(self.questions, 1)
        ]
        job = f"{Path(str(self.file)).stem}.job.yaml" if self.file is not None else "NEST.job.yaml"
        first = json.dumps(first_choices(self.questions), ensure_ascii=False)
        kept = (
            f"Answers are kept in {escape_text(job)} (in Python: answers=). A profile may answer for a plant: "
            f"drawing: {{answers: {escape_text(first)}}}"
        )
        return "\n".join([f"{place}{self.message}:", *lines, kept])

    def in_file(self, file: str | Path) -> Questions:
        """The same, of a file by this name."""
        return Questions(self.questions, file=file, reading=self.reading)

    def as_json(self) -> list[dict[str, Any]]:
        """All questions as data."""
        return [question.as_json() for question in self.questions]

    def __reduce__(self) -> tuple[Any, ...]:
        return _questions, (self.questions, self.file)


class QuestionsOfFiles(Questions):
    """What several drawings ask: all of it at once; `of` are the questions of each."""

    def __init__(self, of: Sequence[Questions]) -> None:
        self.of = tuple(of)
        super().__init__([question for one in of for question in one.questions])

    def _text(self) -> str:
        return "\n".join(map(str, self.of))

    def in_file(self, file: str | Path) -> Questions:
        """The same: each has its file."""
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return QuestionsOfFiles, (self.of,)


def _questions(questions: tuple[Question, ...], file: str | Path | None) -> Questions:
    return Questions(questions, file=file)


@dataclass(slots=True)
class Asking:
    """Takes questions, and answers those that were answered: `given` by question id.

    `raised` are those without an answer, by their ids; `used` are the answers that a question was met by. `mends` says
    that the likeliest choices may mend what is drawn wrongly; else all that is wrong is told.
    """

    given: Mapping[str, str] = field(default_factory=dict)
    raised: dict[str, Question] = field(default_factory=dict)
    used: dict[str, str] = field(default_factory=dict)
    mends: bool = True

    def ask(self, question: Question) -> str:
        """The value that was answered, or that of the likeliest choice, with the question put down as raised.

        Raises InputError for an answer that is none of the choices.
        """
        answer = self.given.get(question.id)
        if answer is None:
            return self.raised.setdefault(question.id, question).choices[0].value
        values = [choice.value for choice in question.choices]
        if answer not in values:
            raise InputError(
                f"the answer {question.id}={answer} is none of the choices: expected {', '.join(values)} "
                f"({question.text})"
            )
        self.used[question.id] = answer
        return answer

    def may_mend(self, question_id: str) -> bool:
        """Whether a question about a repair may be put: somebody has answered it, or its likeliest choice may mend."""
        return self.mends or question_id in self.given

    def because(self, question_id: str) -> str:
        """Why something is taken for what it is: it was answered, or it is the likeliest choice so far."""
        return ANSWERED if question_id in self.used else LIKELIEST

    def answered(self, question_id: str) -> str | None:
        """What was answered to a question, None where nobody has answered."""
        return self.given.get(question_id)


def answers_of(texts: Iterable[str]) -> Answers:
    """Answers as they are written on the command line, `QUESTION=CHOICE` each.

    Raises InputError for a text without `=`, for a question that no drawing raises, and for a choice that it does not
    have.

    Examples
    --------
    >>> answers_of(["frame=sheet", "layer:0=open:mark"])
    (('frame', 'sheet'), ('layer:0', 'open:mark'))
    """
    found = []
    for text in texts:
        question, sign, choice = text.rpartition("=")
        if not (sign and question.strip() and choice.strip()):
            raise InputError(f"--answer {text!r}: expected QUESTION=CHOICE, such as frame=sheet")
        if (problem := answer_problem(question.strip(), choice.strip())) is not None:
            raise InputError(f"--answer {text!r}: {problem[0]}")
        found.append((question.strip(), choice.strip()))
    return tuple(found)


def with_answers(before: Answers, later: Iterable[tuple[str, str]]) -> Answers:
    """Both, where the later ones take the place of those before.

    Examples
    --------
    >>> with_answers((("frame", "part"), ("units", "in")), [("frame", "sheet")])
    (('frame', 'sheet'), ('units', 'in'))
    """
    return tuple((dict(before) | dict(later)).items())


def first_choices(questions: Iterable[Question]) -> dict[str, str]:
    """The answers that take the likeliest choice of each."""
    return {question.id: question.choices[0].value for question in questions}


def with_gives(question: Question, gives: Mapping[str, str], refused: Iterable[str]) -> Question:
    """The question with what each choice would give; choices that cannot be cut stand behind the others."""
    last = set(refused)
    rows = [replace(choice, gives=gives.get(choice.value, choice.gives)) for choice in question.choices]
    return replace(question, choices=tuple(sorted(rows, key=lambda choice: choice.value in last)))
