"""kerfwise check: every rule, judged independently of whatever made the plan."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ..encoder.errors import InputError
from .given import given_options, read_given


@click.command()
@given_options
@click.argument("made", metavar="PLAN.json|OUT.nc")
def command(made: str, **given: Any) -> int:
    """Judge a plan or an NC program of NEST by every rule; exit 1 if a hard one is broken."""
    from ..models.plan import read_plan
    from ..postproc.check import check_program, report
    from ..postproc.checking import check_plan

    asked = read_given(**given)
    if made.endswith(".json"):
        result = check_plan(asked.nest, read_plan(made), asked.profile)
    else:
        try:
            text = Path(made).read_text(encoding="utf-8")
        except OSError as error:
            raise InputError(f"cannot read the program: {error.strerror}", file=made) from None
        except UnicodeDecodeError:
            raise InputError("not an NC program: the file is not text", file=made) from None
        result = check_program(asked.nest, text, asked.profile)
    click.echo(report(result))
    return 0 if result.ok else 1
