"""The command line: the verbs are in `commands` and in apps, whose files are imported only when a verb is called."""

from __future__ import annotations

import gc
import importlib
import sys
from typing import Any

import click

from . import __version__
from .app_modules import verbs

VERBS = {
    "solve": "Turn a nest into a checked cutting program.",
    "read": "Say what a drawing is taken for, and what it leaves open.",
    "check": "Judge a plan or a program by every rule, independently.",
    "explain": "Say why a contour is cut where it is, then, and so.",
    "time": "Say how long a plan or a program takes, and what it costs.",
    "facts": "Write the facts of a nest, as JSON or MiniZinc data.",
    "plot": "Draw a nest or a plan (SVG, PNG, PDF or HTML).",
    "job": "Check a job file, which says what belongs to one nest.",
    "engines": "List the engines and solvers that can be used.",
    "warm-up": "Compile ahead what plans need, for images and batches.",
}


FILES = {
    **dict.fromkeys(("read", "facts", "check", "explain", "time", "plot"), "results"),
    "warm-up": "engines",
}
"""The file in `commands` that has a verb, where it is not called like the verb."""

COLLECTED = 500_000, 20, 1000
"""How many objects are made before Python looks for circles among the new ones, and how many such looks there are
before the older ones are looked at. A nest is hundreds of thousands of objects that stay: with Python's own numbers
facts of 3000 contours take 3.1 s in place of 2.4, statements 2.1 in place of 1.3; with a fifth of these ones a first
plan of 1000 contours takes 4.9 in place of 4.7 s."""
WRONG_INPUT, QUESTIONS, UNFORESEEN, INTERRUPTED = 2, 3, 70, 130


class Unforeseen(Exception):
    """Carries, as its cause, what click would take for the end of input, a reader that has gone, or a way to leave."""


class Verbs(click.Group):
    """Knows the verbs by name and imports the one that is asked for."""

    def invoke(self, ctx: click.Context) -> Any:
        """Call the verb; an exception of its own keeps its name."""
        try:
            return super().invoke(ctx)
        except (EOFError, OSError, SystemExit) as error:
            raise Unforeseen from error

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The verbs, in the order a new user needs them."""
        return [*VERBS, *verbs()]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The verb's command, imported now; None for an unknown verb."""
        apps = verbs()
        if cmd_name in VERBS:
            module = importlib.import_module(f".commands.{FILES.get(cmd_name, cmd_name)}", __package__)
        elif cmd_name in apps:
            module = importlib.import_module(apps[cmd_name][0])
        else:
            return None
        command: click.Command = getattr(module, f"{cmd_name.replace('-', '_')}_command", None) or module.command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The verb that was asked for; a mistyped one is answered with the nearest."""
        if args[0] not in (known := self.list_commands(ctx)) and not args[0].startswith("-"):
            from kerfwise.encoder.nearest_name import unknown

            raise click.UsageError(unknown("verb", args[0], known), ctx)
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The verbs with a line each, without importing any."""
        with formatter.section("Verbs"):
            formatter.write_dl(list(VERBS.items()))
        if apps := verbs():
            with formatter.section("Verbs of apps"):
                formatter.write_dl([(name, does) for name, (_, does) in apps.items()])


@click.command(
    cls=Verbs,
    context_settings={"help_option_names": ["-h", "--help"]},
    subcommand_metavar="VERB …",
    epilog="Begin with: kerfwise solve NEST.dxf. What a verb takes: kerfwise VERB --help.",
)
@click.version_option(__version__)
def program() -> None:
    """Sequence the cuts of a nest: every rule held, idle travel as low as can be, and the proof.

    Exit codes: 0 done, 1 the rules cannot be met or are broken, 2 wrong usage or unreadable input, 3 the drawing
    raises questions that nobody has answered, 70 a fault of kerfwise itself (a report is written), 130 interrupted (the
    best plan so far is written).
    """


def main(argv: list[str] | None = None) -> None:
    """Run the command line and leave with its exit code."""
    from kerfwise.commands.terminal import terminal

    gc.set_threshold(*COLLECTED)
    with terminal():
        code = _ended(argv)
    sys.exit(code)


def run() -> None:
    """Be the program: `main`, and an end at which Python looks for circles nowhere, which is a tenth of a short run."""
    try:
        main()
    finally:
        gc.freeze()


def _ended(argv: list[str] | None) -> int:
    """The exit code; whatever goes wrong is told in words."""
    from kerfwise.encoder.errors import InputError, RulesConflict
    from kerfwise.encoder.questions import Questions

    try:
        code = program.main(argv, prog_name="kerfwise", standalone_mode=False)
    except click.ClickException as error:
        error.show()
        return WRONG_INPUT
    except (click.exceptions.Abort, KeyboardInterrupt):
        return INTERRUPTED
    except InputError as error:
        click.echo(f"kerfwise: {error}", err=True)
        return QUESTIONS if isinstance(error, Questions) else WRONG_INPUT
    except RulesConflict as error:
        click.echo(f"kerfwise: {error}", err=True)
        return 1
    except BaseException as error:
        from kerfwise.commands.crash_report import arguments, crash_message

        fault = error.__cause__ if isinstance(error, Unforeseen) and error.__cause__ else error
        click.echo(f"kerfwise: {crash_message(fault, arguments(argv))}", err=True)
        return UNFORESEEN
    return code if isinstance(code, int) else 0


if __name__ == "__main__":
    run()
