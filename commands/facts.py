"""kerfwise facts: what the rules are told of a nest."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from kerfwise.encoder.errors import InputError

from .shared_options import input_options, protect, read_inputs
from .terminal import expect_printed


@click.command()
@input_options
@click.option(
    "-o",
    "--output",
    metavar="FACTS.json|FACTS.dzn",
    help="Output file, .json or .dzn. Default: print JSON.",
)
def command(output: str | None, **given: Any) -> None:
    """Write the facts of NEST: containment, what lies ahead, hulls, neighbours, zones, candidates."""
    if output and Path(output).suffix not in (".json", ".dzn"):
        raise InputError(
            f"cannot write facts as {Path(output).suffix or output!r}: give a name ending in .json or .dzn",
            file=output,
        )
    from kerfwise.encoder.facts import facts_dzn, facts_json
    from kerfwise.jobs.request import facts_of
    from kerfwise.postproc.output_files import expect_outputs, write_files

    expect_outputs([Path(output)] if output else [], [Path(given["nest"])])
    asked = read_inputs(**given)
    protect(asked, given["nest"], [output])
    facts = facts_of(asked.nest, asked.profile)
    facts = facts if facts.copies is None else facts.copies.whole
    if output is None:
        click.echo(facts_json(facts), nl=False)
        expect_printed()
    else:
        write_files({Path(output): facts_dzn(facts) if output.endswith(".dzn") else facts_json(facts)})
