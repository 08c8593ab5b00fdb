"""Options that belong together and reach a verb as one value: the limits of plans, and where a stopped job goes on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from kerfwise.models.engines.solution import Limits

from .shared_options import AMOUNT_OVER_ZERO, Amount, Verb, print_note

if TYPE_CHECKING:
    from kerfwise.encoder.already_cut import AlreadyCut
    from kerfwise.jobs.inputs import Inputs

Adds = Callable[[Verb], Verb]


def together(name: str, kind: Callable[..., Any], *options: Adds) -> Adds:
    """Add options that a verb is given as one value, `name`: what `kind` makes of theirs, by their names.

    Examples
    --------
    >>> sizes = together("size", dict, click.option("--wide", default=1.0), click.option("--high", default=2.0))
    >>> command = click.command()(sizes(lambda size: click.echo(size)))
    >>> command.main(["--wide", "3"], standalone_mode=False)
    {'wide': 3.0, 'high': 2.0}
    """

    def add(verb: Verb) -> Verb:
        @wraps(verb)
        def gathered(*args: Any, **given: Any) -> Any:
            return verb(*args, **{name: kind(**{one: given.pop(one) for one in names})}, **given)

        before = len(getattr(gathered, "__click_params__", ()))
        for option in reversed(options):
            option(gathered)
        names = [str(parameter.name) for parameter in reversed(gathered.__click_params__[before:])]  # type: ignore[attr-defined]
        return gathered

    return add


RELAX = click.option(
    "--relax", is_flag=True, help="If hard rules conflict, relax the cheapest ones and mark them in the plan."
)
GAP = click.option("--gap", type=Amount(min=0, max=1), metavar="G", help="Stop at this gap; 0.01 is 1 %.")
NO_IMPROVEMENT = click.option("--no-improvement", "no_improvement_s", type=AMOUNT_OVER_ZERO, metavar="S",
                              help="Stop after S seconds without a better plan.")  # fmt: skip
SEED = click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, metavar="N",
                    help="Seed of the search.")  # fmt: skip


def time_and_work(of: str = "of each plan", work: float = 30.0) -> tuple[Adds, Adds]:
    """`--time-limit` and `--work`; `of` says what they are the limits of, `work` is the default."""
    return (
        click.option("--time-limit", "time_s", type=AMOUNT_OVER_ZERO, metavar="S",
                     help=f"Time limit {of}, in seconds."),
        click.option("--work", type=AMOUNT_OVER_ZERO, default=work, show_default=True, metavar="W",
                     help="Deterministic limit, without --time-limit: the same work gives the same bytes."),
    )  # fmt: skip


def limit_options(*further: Adds, of: str = "of each plan", work: float = 30.0) -> Adds:
    """`--time-limit`, `--work`, `--seed` and `further` options of that kind, as `limits`."""
    return together("limits", Limits, *time_and_work(of, work), SEED, *further)


@dataclass(frozen=True, slots=True)
class Stopped:
    """Where a stopped job goes on: the plan or program that was stopped, its last finished cut, and whether to redo."""

    lock_from: str | None
    upto: int | None
    redo_last: bool

    def already_cut(self, inputs: Inputs) -> AlreadyCut:
        """What is cut already. Raises InputError as `kerfwise.jobs.resume.already_cut` does."""
        from kerfwise.jobs.resume import already_cut

        return already_cut(inputs, self.lock_from, self.upto, self.redo_last, print_note)


def stopped_options(lock_from: str) -> Adds:
    """`--lock-from`, with this help, `--upto` and `--redo-last`, as `stopped`."""
    return together(
        "stopped",
        Stopped,
        click.option("--lock-from", metavar="OLD.plan.json|OLD.nc", help=lock_from),
        click.option(
            "--upto", type=click.IntRange(min=1), metavar="N", help="Number of its last finished cut; with --lock-from."
        ),
        click.option("--redo-last", is_flag=True,
                     help="Repeat cut N, which broke off, from its start; with --lock-from."),
    )  # fmt: skip
