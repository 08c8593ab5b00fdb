"""Questions that a drawing raises, asked on a terminal; anywhere else they end the command with exit code 3."""

from __future__ import annotations

import sys
from collections.abc import Callable

import click

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import Answers, Question, Questions
from kerfwise.encoder.shown import shown


def answering(read: Callable[[Answers], Nest]) -> tuple[Nest, Answers]:
    """What `read` makes of a file, and what was answered to the questions that it raises, on a terminal.

    Raises
    ------
    Questions
        Where nobody sits before a terminal.
    """
    answers: dict[str, str] = {}
    while True:
        try:
            return read(tuple(answers.items())), tuple(answers.items())
        except Questions as questions:
            if not (sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty()):
                raise
            for question in questions.questions:
                answers[question.id] = _asked(question)


def _asked(question: Question) -> str:
    """The value of the choice that somebody types the number of."""
    lines = [shown(question.text)]
    for k, choice in enumerate(question.choices, 1):
        lines.append(f"  {k}  {shown(choice.words)}{f': {shown(choice.gives)}' if choice.gives else ''}")
    click.echo("\n".join(lines), err=True)
    numbers = click.Choice([str(k) for k in range(1, len(question.choices) + 1)])
    number = click.prompt("Which", type=numbers, show_choices=True, err=True)
    return question.choices[int(number) - 1].value
