"""Damaged inputs of every kind through the command line.

`python -m kerfwise.tests.fuzz --kinds all --cases 100000 --seed 1 --keep FOLDER` prints what came of them, by kind, and
exits 1 where anything is wrong. FOLDER takes the smallest case of each finding.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path

import click

from kerfwise.tests.fuzz.inputs.kinds import KINDS, kind_of, made
from kerfwise.tests.fuzz.runs.kept import keep
from kerfwise.tests.fuzz.runs.smaller import smaller, what
from kerfwise.tests.fuzz.runs.worker import AGAIN_EVERY, APART_EVERY, Report, Worker

COLUMNS = ("cases", "accepted", "judged 1", "refused", "findings", "tracebacks", "hangs", "over 3 GB")


@click.command()
@click.option("--kinds", default="all", show_default=True, help=f"all, or some of {','.join(KINDS)}.")
@click.option("--cases", default=1000, show_default=True, help="How many cases, of all kinds together.")
@click.option("--seed", default=1, show_default=True)
@click.option("--first", default=0, show_default=True, help="Number of the first.")
@click.option(
    "--keep", "folder", type=click.Path(file_okay=False, path_type=Path), help="Folder for findings, made small."
)
@click.option("--minutes", type=float, help="Stop after so many.")
@click.option("--twice", default=AGAIN_EVERY, show_default=True, help="Of so many cases one is run twice.")
@click.option("--apart", default=APART_EVERY, show_default=True, help="And one in a process of its own.")
def main(
    kinds: str, cases: int, seed: int, first: int, folder: Path | None, minutes: float | None, twice: int, apart: int
) -> None:
    """Run damaged inputs through the command line, and judge how each ends."""
    names = list(KINDS) if kinds == "all" else kinds.split(",")
    if unknown := [name for name in names if name not in KINDS]:
        raise click.UsageError(f"no kind {unknown[0]!r}: expected all, or some of {','.join(KINDS)}")
    began_s = time.monotonic()
    counted: Counter[tuple[str, str]] = Counter()
    seen: dict[frozenset[str], int] = {}
    worker, done = Worker(), 0
    slowest = Report(made(names[0], seed, first), 0, ())
    try:
        for number in range(first, first + cases):
            if minutes is not None and time.monotonic() - began_s > minutes * 60:
                break
            kind = kind_of(number, names)
            report = worker.ask(made(kind, seed, number), number % twice == 0, number % apart == apart - 1)
            count(kind, report, counted)
            slowest = max(slowest, report, key=lambda found: found.seconds)
            done += 1
            if done % 500 == 0:
                took_s = time.monotonic() - began_s
                click.echo(f"{done} cases, {took_s:.0f} s, {sum(seen.values())} findings; {worker.state()}", err=True)
            if report.findings:
                one = what(report)
                seen[one] = seen.get(one, 0) + 1
                if seen[one] == 1:
                    _tell(number, report, worker, folder)
    finally:
        worker.stop()
    click.echo(
        f"cases: {done} (seed {seed}), in {time.monotonic() - began_s:.0f} s; the slowest took {slowest.seconds:.1f} s"
    )
    click.echo(table(names, counted))
    for one, times in sorted(seen.items(), key=lambda item: -item[1]):
        click.echo(f"{times:6} × {'; '.join(sorted(one))}")
    sys.exit(1 if seen else 0)


def count(kind: str, report: Report, counted: Counter[tuple[str, str]]) -> None:
    """Add a report to the table."""
    counted[kind, "cases"] += 1
    if report.code in (0, 1, 2):
        counted[kind, ("accepted", "judged 1", "refused")[report.code]] += 1
    counted[kind, "findings"] += bool(report.findings)
    for column, starts in (
        ("tracebacks", ("own fault", "traceback", "died")), ("hangs", ("hang",)), ("over 3 GB", ("over 3 GB",))
    ):  # fmt: skip
        counted[kind, column] += any(text.removeprefix("apart: ").startswith(starts) for text in report.findings)


def table(names: list[str], counted: Counter[tuple[str, str]]) -> str:
    """A row for each kind, and one of sums."""
    rows = [f"{'':10}" + "".join(f"{column:>12}" for column in COLUMNS)]
    rows += [f"{kind:10}" + "".join(f"{counted[kind, column]:12}" for column in COLUMNS) for kind in names]
    sums = (sum(counted[kind, column] for kind in names) for column in COLUMNS)
    return "\n".join([*rows, f"{'all':10}" + "".join(f"{total:12}" for total in sums)])


def _tell(number: int, report: Report, worker: Worker, folder: Path | None) -> None:
    if not any(text.startswith(("hang", "apart")) for text in report.findings):
        report = smaller(report, worker.ask)
    case = report.case
    click.echo(f"case {number} of {case.kind}: kerfwise {' '.join(map(ascii, case.words))}")
    for text in report.findings:
        click.echo(f"  {text.encode('ascii', 'backslashreplace').decode()}")
    for name in case.damaged:
        click.echo(f"  {name}: {(case.files[name] or b'')[:300]!r}")
    if folder is not None:
        keep(report, folder / f"{case.kind}-{number}")


if __name__ == "__main__":
    main()
