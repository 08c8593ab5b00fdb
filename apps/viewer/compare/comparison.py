"""Two sides of one nest: figures, rules and cuts, what may be said of the difference; as text, picture, page, paper."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from kerfwise.apps.viewer.page.page_data import page_bytes, plan_side, program_data, rules_data
from kerfwise.apps.viewer.page.page_html import Data, cut_data, page_of, short, state_data
from kerfwise.apps.viewer.page.page_reasons import heat_data
from kerfwise.apps.work_sheets.paper import Paper
from kerfwise.encoder.display import align_columns
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.jobs.display import Picture, PictureKind
from kerfwise.models.plan.plan import PlannedCut
from kerfwise.postproc.check.result import Judgement
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.output_files import write_files
from kerfwise.postproc.report.legend import counted
from kerfwise.postproc.report.plot import pdf_bytes
from kerfwise.postproc.report.scene import Scene
from kerfwise.postproc.report.simple_pictures import Panel, burns_scene, draw_burns

from .differences import CutPair, Figure, cut_pairs, figures
from .sides import Side

FORMAT = "kerfwise-comparison/1"


@dataclass(frozen=True, slots=True)
class RulePays:
    """What one rule is on one side: its strength and verdict, its breaches and what they cost, mm, what is not kept.

    `cost_mm` is the weight of a soft rule times its breaches, as the check counts them; hard rules and rules that are
    off cost nothing.
    """

    strength: str
    verdict: str
    breaches: int
    excuses: int
    cost_mm: float
    unkept: str = ""
    """How many places are excused, relaxed and dropped, in words."""

    @property
    def told(self) -> str:
        """The same in a few words."""
        if self.strength in ("off", "-"):
            return self.strength
        if self.verdict == "excused":
            return f"{self.strength}, kept but for {self.unkept}"
        text = f"{self.strength}, {self.verdict}"
        if self.cost_mm:
            text += f": {self.breaches} × = {self.cost_mm / 1000:.3f} m"
        elif self.breaches:
            text += f": {self.breaches} ×"
        return text + (f", {self.unkept}" if self.unkept else "")

    @property
    def quiet(self) -> bool:
        """Whether there is nothing to say of it: a hard rule that holds everywhere, or one that is not asked."""
        return self.strength == "-" or (self.strength, self.verdict) == ("hard", "holds")

    def as_json(self) -> dict[str, Any]:
        """The same as data."""
        return {name: getattr(self, name) for name in self.__slots__}


NOT_ASKED = RulePays("-", "not judged", 0, 0, 0.0)
"""A program is asked other things than a plan."""


@dataclass(frozen=True, eq=False, slots=True)
class Comparison:
    """Two sides, A and B, and what differs; `print` says what `kerfwise compare` prints.

    Attributes
    ----------
    a, b
        Each with `plan` (None for a program), `verdict`, `times` and, where it was asked for, `heat`.
    figures
        Lengths, pierces, times, cost: `key`, `a`, `b` and `texts` of each.
    rules
        Id of each rule, and what it is on both sides: `strength`, `verdict`, `breaches`, `excuses`, `cost_mm`.
    cuts
        Every contour in both: its position in each, and what differs, in `told`.
    notes
        What is to be known of one side, such as that its plan was made with another profile.
    """

    a: Side
    b: Side
    figures: tuple[Figure, ...]
    rules: tuple[tuple[str, RulePays, RulePays], ...]
    cuts: tuple[CutPair, ...]
    notes: tuple[str, ...] = ()

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C, or the progress callback, ended the planning of a side."""
        return self.a.interrupted or self.b.interrupted

    @property
    def changed(self) -> tuple[CutPair, ...]:
        """The cuts that differ in more than the number of their position."""
        return tuple(pair for pair in self.cuts if not pair.same)

    @property
    def claim(self) -> str:
        """What the difference may be taken for: no more than is proven."""
        if not self.changed:
            return "both make the same cuts in the same order"
        if self.a.optimal and self.b.optimal:
            return (
                "each plan is proven optimal within its own zones and entries only: with other zones or entries the "
                "difference may be another"
            )
        found = [name for name, side in (("A", self.a), ("B", self.b)) if not side.optimal]
        one = f"{found[0]} is" if len(found) == 1 else "A and B are"
        return f"{one} not proven optimal: the difference is between these two, and better ones may exist"

    def as_json(self) -> dict[str, Any]:
        """The comparison as `kerfwise compare --json` prints it."""
        return {
            "format": FORMAT,
            "nest": self.a.given.nest.file,
            "a": _side(self.a),
            "b": _side(self.b),
            "claim": self.claim,
            "figures": {figure.key: figure.as_json() for figure in self.figures},
            "rules": [{"id": name, "a": a.as_json(), "b": b.as_json()} for name, a, b in self.rules],
            "changed": [pair.as_json() for pair in self.changed],
        }

    def picture(self, kind: PictureKind = "svg") -> Picture:
        """Both routes, cuts that differ in red; "html" is the page with the tables."""
        content = _content(self, f".{kind}")
        return Picture(content.encode("utf-8") if isinstance(content, str) else content, kind)

    def save(self, *paths: str | Path) -> tuple[Path, ...]:
        """Write it as .svg, .png, .html or .pdf, by the ends of the names: all files or none.

        Raises InputError if a name ends otherwise, or a file cannot be written.
        """
        expect_kinds(paths)
        write_files({Path(path): _content(self, Path(path).suffix.lower()) for path in paths})
        return tuple(map(Path, paths))

    def __str__(self) -> str:
        return text(self)


def compare(a: Side, b: Side, *, notes: tuple[str, ...] = ()) -> Comparison:
    """Put two sides of one nest next to each other."""
    return Comparison(a, b, figures(a, b), rules_of(a, b), cut_pairs(a.cuts, b.cuts), notes)


def rules_of(a: Side, b: Side) -> tuple[tuple[str, RulePays, RulePays], ...]:
    """Id, and what the rule is on both sides: of every rule that is on in one of them, and of the program's own."""
    first, second = _paid(a), _paid(b)
    names = dict.fromkeys([*first, *second])
    rows = [(name, first.get(name, NOT_ASKED), second.get(name, NOT_ASKED)) for name in names]
    return tuple(row for row in rows if {row[1].strength, row[2].strength} - {"off", "-"})


def _paid(side: Side) -> dict[str, RulePays]:
    settings = side.profile.settings()
    return {j.id: _pays(j, settings[j.id].weight if j.id in settings else None) for j in side.verdict.rules}


def _pays(judged: Judgement, weight_mm: float | None) -> RulePays:
    breaches = len(judged.violations)
    unkept = ", ".join(f"{count} {how}" for how, count in Counter(one.how for one in judged.excused).items())
    cost_mm = breaches * (weight_mm or 0.0)
    return RulePays(judged.strength, judged.verdict, breaches, len(judged.excused), cost_mm, unkept)


def _side(side: Side) -> dict[str, Any]:
    plan = side.plan
    return {
        "name": side.name,
        "made": side.made,
        "profile": {"name": side.profile.name, "sha256": side.profile.sha256},
        "ok": side.verdict.ok,
        "broken": list(side.verdict.broken()),
        "state": side.verdict.state.as_json(),
        "proof": side.proof,
        "status": None if plan is None else plan.solve.status,
        "bound_mm": None if plan is None else plan.solve.bound,
        "gap": None if plan is None else plan.told_gap,
        "time": side.times.as_json(),
    }


# What compare prints.

_TOLD = 20


def text(compared: Comparison) -> str:
    """Both sides by name, the figures, the rules, the cuts that differ, and what may be claimed."""
    lines = [*sides(compared), ""]
    lines += align_columns([("", "A", "B", ""), *figure_rows(compared)])
    telling = [
        row for row, (_, a, b) in zip(rule_rows(compared), compared.rules, strict=True) if not (a.quiet and b.quiet)
    ]
    lines += ["", *(align_columns([("rule", "A", "B", ""), *telling]) if telling else [])]
    if quiet := len(compared.rules) - len(telling):
        lines.append(f"{counted(quiet, 'hard rule')} more, which hold wherever they are asked (--json has them all)")
    lines.append("")
    changed = compared.changed
    lines.append(summary_of(changed, len(compared.cuts)))
    if changed:
        lines += align_columns([("contour", "A", "B", ""), *(cut_row(pair) for pair in changed[:_TOLD])])
        if len(changed) > _TOLD:
            lines.append(f"... and {len(changed) - _TOLD} more (--json has them all)")
    return "\n".join([*lines, "", *proofs(compared)])


def sides(compared: Comparison) -> list[str]:
    """Both sides by name."""
    return [f"A: {_named(compared.a)}", f"B: {_named(compared.b)}"]


def figure_rows(compared: Comparison) -> list[tuple[str, str, str, str]]:
    """Label, both values, and the change."""
    return [(figure.label, *figure.texts) for figure in compared.figures]


def rule_rows(compared: Comparison) -> list[tuple[str, str, str, str]]:
    """Id, what the rule is on both sides, and whether that differs."""
    return [
        (name, a.told, b.told, "" if a == b or "-" in (a.told, b.told) else "changed") for name, a, b in compared.rules
    ]


def cut_row(pair: CutPair) -> tuple[str, str, str, str]:
    """Contour, both positions, and what differs."""
    a, b = ("-" if place is None else str(place) for place in (pair.a, pair.b))
    return escape_text(pair.contour), a, b, pair.told


def proofs(compared: Comparison) -> list[str]:
    """What is proven of each side, whether it keeps every hard rule, and what the difference may be taken for."""
    lines = [f"{letter}: {side.proof}" for letter, side in (("A", compared.a), ("B", compared.b))]
    lines += [
        f"{letter}: the check refuses it: {', '.join(side.verdict.broken())}"
        for letter, side in (("A", compared.a), ("B", compared.b))
        if not side.verdict.ok
    ]
    states = [(letter, side.verdict.state) for letter, side in (("A", compared.a), ("B", compared.b))]
    lines += [f"{letter}: {escape_text(state.words())}" for letter, state in states if state.kind == "kept but for"]
    return [*lines, compared.claim]


def summary_of(changed: Sequence[CutPair], count: int) -> str:
    """How many cuts differ, and in what."""
    if not changed:
        return f"{counted(count, 'cut')}, none differs"
    kinds = (
        ("moved", sum(pair.moved for pair in changed)),
        ("begun elsewhere", sum(pair.entry_mm > 0 for pair in changed)),
        ("other way round", sum(pair.turned for pair in changed)),
        ("with another lead", sum(pair.lead for pair in changed)),
        ("with other tabs", sum(pair.tabs for pair in changed)),
        ("in one only", sum(None in (pair.a, pair.b) for pair in changed)),
    )
    text = ", ".join(f"{number} {what}" for what, number in kinds if number)
    return f"{len(changed)} of {counted(count, 'cut')} differ: {text or 'linked in one only'}"


def _named(side: Side) -> str:
    kind = {"plan": "plan", "program": "program", "solved": "planned now"}[side.made]
    return f"{escape_text(side.name)} ({kind}, profile {escape_text(side.profile.name)})"


# A comparison as a file: a picture of both routes, or a page or paper with all.

KINDS = (".svg", ".png", ".html", ".pdf")


def expect_kinds(names: Iterable[str | Path]) -> None:
    """Refuse a file that a comparison cannot be written as. Raises InputError naming the file."""
    for name in names:
        if Path(name).suffix.lower() not in KINDS:
            raise InputError(f"a comparison is written as {', '.join(KINDS)}: give a name that ends so", file=name)


def _content(compared: Comparison, suffix: str) -> str | bytes:
    """The content of a file whose name ends so; one of `KINDS`."""
    if suffix == ".pdf":
        return paper(compared)
    return page_bytes(compared_data(compared)) if suffix == ".html" else picture(compared, suffix)


# Both routes in one picture, the cuts that differ in red.

_SAME_S = 1e-3
"""Plans write times to milliseconds."""


def picture(compared: Comparison, suffix: str) -> str | bytes:
    """The picture as SVG text or as PNG bytes."""
    return draw_burns(_panels(compared), suffix, title_of(compared))


def picture_scene(compared: Comparison) -> Scene:
    """The picture, to be set on a page."""
    return burns_scene(_panels(compared), title_of(compared))


def title_of(compared: Comparison) -> str:
    """What a picture or page of the comparison is called."""
    return f"{escape_text(Path(compared.a.given.nest.file or 'nest').name)} compared"


def _panels(compared: Comparison) -> list[Panel]:
    changed = {pair.contour for pair in compared.changed}
    return [_panel(letter, side, changed) for letter, side in (("A", compared.a), ("B", compared.b))]


def _panel(letter: str, side: Side, changed: Collection[str]) -> Panel:
    job = side.times.timed.job
    text = f"idle {job.idle_mm / 1000:.3f} m, {job.pierces} pierces"
    begun_s = np.array(sorted(cut.start_s for cut in side.cuts.new if cut.contour in changed))
    starts_s = np.array([burn.start_s for burn in side.burns])
    loud = frozenset((np.searchsorted(starts_s, begun_s + _SAME_S) - 1).tolist())
    return Panel(f"{letter}: {side.name}", text, side.burns, side.home, side.end, loud, side.cuts.made + 1)


def paper(compared: Comparison) -> bytes:
    """The comparison as a PDF; the same one gives the same bytes."""
    sheet = Paper(title_of(compared))
    sheet.heading(title_of(compared))
    sheet.lines(sides(compared))
    sheet.skip(6.0)
    sheet.table(("", "A", "B", "change"), figure_rows(compared))
    sheet.skip(6.0)
    sheet.lines(proofs(compared))
    sheet.skip(6.0)
    sheet.picture(picture_scene(compared))
    sheet.heading("Rules")
    sheet.table(("rule", "A", "B", ""), rule_rows(compared))
    sheet.heading("Cuts")
    sheet.lines([summary_of(compared.changed, len(compared.cuts))])
    if compared.changed:
        sheet.table(("contour", "A", "B", ""), [cut_row(pair) for pair in compared.changed])
    return pdf_bytes(sheet.scenes(), title_of(compared))


# A comparison as data of a page.


def compared_data(compared: Comparison) -> Data:
    """The page of two plans or programs, with what differs."""
    sides = [
        _compared(side) | {"name": f"{letter}: {escape_text(side.name)}"}
        for letter, side in (("A", compared.a), ("B", compared.b))
    ]
    nest = compared.a.given.nest
    title = f"{escape_text(Path(nest.file or 'nest').name)} compared"
    return page_of(nest, sides, title) | {"comparison": comparison_data(compared)}


def _compared(side: Side) -> Data:
    if side.plan is None:
        return program_side(side)
    nest, profile = side.given.nest, side.profile.at_origin(side.plan.origin)
    data = plan_side(side.given, side.plan, side.verdict)
    data["nc"] = program_data(write_program(side.plan, nest, profile), nest, profile)
    data["heat"] = heat_data(side.given, side.plan, side.heat is not None)
    return data


def program_side(side: Side) -> Data:
    """A program on its machine: its own burns, and what the check says of it."""
    nest, job = side.given.nest, side.times.timed.job
    begun = {round(burn.start_s, 3): burn for burn in side.burns}
    cuts = []
    for cut in side.cuts.new:
        contour = nest.contour(cut.contour)
        burn = begun.get(round(cut.start_s, 3))
        length_mm = contour.curve.length_mm if burn is None else burn.path.length_mm
        planned = PlannedCut(cut, contour.part, contour.kind, length_mm)
        data = cut_data(nest, planned, None if burn is None else burn.path)
        if burn is not None:
            data |= {"stand_s": short(burn.held_s + burn.pierce_s), "wait_s": short(burn.wait_s)}
        cuts.append(data)
    return {
        "name": side.name,
        "profile": side.profile.name,
        "kerf_mm": short(side.profile.material.kerf_mm),
        "home": [short(v) for v in side.home],
        "made": side.cuts.made,
        "end_s": short(max([side.times.total_s, *(cut["to_s"] for cut in cuts)])),
        "figures": {
            "cut_mm": short(job.on_mm), "idle_mm": short(job.idle_mm), "pierces": job.pierces, "status": "",
            "gap": None, "light_gap": None, "proof": side.proof, "cost": None,
        },
        "said": [],
        "ok": side.verdict.ok,
        "state": state_data(side.verdict.state),
        "cuts": cuts,
        "pierces": [],
        "already": [nest.index[cut.contour] for cut in side.cuts.cuts[: side.cuts.made]],
        "rules": rules_data(side.verdict, side.profile),
        "warnings": list(side.verdict.warnings),
        "dropped": [],
        "left_out": [],
        "why": {},
        "heat": None,
        "nc": None,
    }  # fmt: skip


def comparison_data(compared: Comparison) -> Data:
    """Figures, rules and cuts of both sides, in the words that `kerfwise compare` prints."""
    index = compared.a.given.nest.index
    return {
        "sides": sides(compared),
        "figures": [list(row) for row in figure_rows(compared)],
        "rules": [list(row) for row in rule_rows(compared)],
        "proofs": proofs(compared),
        "summary": summary_of(compared.changed, len(compared.cuts)),
        "changed": [
            {"contour": index.get(pair.contour, -1), "a": pair.a, "b": pair.b, "told": pair.told}
            for pair in compared.changed
        ],
    }
