"""One program through the simulation: `python -m kerfwise.tests.metal.one NEST PROGRAM -p PROFILE`."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from kerfwise import load_profile, read_nest
from kerfwise.tests.metal.plant import plant as given
from kerfwise.tests.metal.program import read_program
from kerfwise.tests.metal.simulate import simulate


@click.command()
@click.argument("nest")
@click.argument("program", type=Path)
@click.option("-p", "--profile", default="plasma-carbon-steel", show_default=True)
@click.option("--before", type=Path, help="The program that was broken off, where this one takes up its work.")
def main(nest: str, program: Path, profile: str, before: Path | None) -> None:
    """Print what PROGRAM does wrong to the metal of NEST; exit code 1 if it does anything."""
    plant, text = load_profile(profile), program.read_text(encoding="utf-8")
    old = before and before.read_text(encoding="utf-8")
    found = simulate(read_nest(nest, plant), text, before=old, **given(plant))
    for finding in found:
        click.echo(str(finding))
    click.echo(f"{len(read_program(text, plant.material.kerf_mm).paths)} cuts and marks burnt, findings: {len(found)}")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
