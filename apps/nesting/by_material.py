"""Parts of an order by material and thickness: the sheets, and the profile or row of a chart, that each is cut with."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from kerfwise.encoder.candidates import build_with_older_kerfs
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.encoder.questions import OF_LISTS, Answers, Choice, Question, Questions
from kerfwise.rules.charts import Chart, read_chart, shipped_charts
from kerfwise.rules.charts.chart import column_of, family_of
from kerfwise.rules.profile.overrides import read_setting, with_settings
from kerfwise.rules.profile.profile import Profile

from .part_list import BadRow
from .placement.demand import Demand, PartType, Spacing, Stock
from .placement.fill import too_large
from .placement.nofit import Placed
from .placement.shapes import Shapes

SHIPPED = "kerfwise/rules/profile/shipped/"
"""How the files of shipped profiles begin."""

# An order in groups, one for each sheet metal that its parts are cut from.

_SAME_MM = 1e-6


@dataclass(frozen=True, eq=False, slots=True)
class Group:
    """Parts of one material and thickness, and the stock of it; "" and None where the order does not say."""

    material: str
    thickness_mm: float | None
    wanted: Demand

    @property
    def said(self) -> str:
        """What it is cut from, such as `S235, 6 mm`; "" where nothing is said."""
        thick = "" if self.thickness_mm is None else f"{self.thickness_mm:g} mm"
        return ", ".join(text for text in (self.material, thick) if text)

    @property
    def name(self) -> str:
        """The same as the name of a folder."""
        return re.sub(r"[^\w.]+", "-", self.said.replace(" mm", "mm")).strip("-.")


def groups_of(wanted: Demand) -> list[Group]:
    """The order by material and thickness, as they come first in it; stock that says neither serves all.

    Examples
    --------
    >>> from kerfwise.rules.case import part, rect
    >>> plate = part("A", rect(0, 0, 40, 40))
    >>> types = [PartType(f"p{t}", plate, 1, material="S235", thickness_mm=t) for t in (6.0, 10.0, 6.0)]
    >>> stock = Stock("100x100", Sheet.rectangle(100, 100)), Stock("6", Sheet.rectangle(9, 9), thickness_mm=6.0)
    >>> [(g.name, len(g.wanted.types), len(g.wanted.stocks)) for g in groups_of(Demand(tuple(types), stock))]
    [('S235-6mm', 2, 2), ('S235-10mm', 1, 1)]
    """
    kinds: dict[tuple[str, float | None], list[PartType]] = {}
    for kind in wanted.types:
        thick = None if kind.thickness_mm is None else round(kind.thickness_mm, 4)
        kinds.setdefault((plain_grade(kind.material), thick), []).append(kind)
    return [
        Group(types[0].material, thick, Demand(tuple(types), tuple(s for s in wanted.stocks if _serves(s, types[0]))))
        for (_, thick), types in kinds.items()
    ]


def plain_grade(material: str) -> str:
    """A grade without capitals, blanks, hyphens and the quality of structural steel.

    Examples
    --------
    >>> plain_grade("S 235"), plain_grade("S355J2+N"), plain_grade("St37-2"), plain_grade("1.4301")
    ('s235', 's355', 'st372', '1.4301')
    """
    plain = "".join(c for c in material.casefold() if c.isalnum() or c in ".+")
    return _QUALITY.sub(r"\1", plain)


_QUALITY = re.compile(r"^(s[1-9]\d\d)(?:jr|j0|j2|k2|g[1-4]|mc|nl|ml|n|m|w|c|\+ar|\+n|\+m)+$")


def _serves(stock: Stock, kind: PartType) -> bool:
    graded = not stock.material or not kind.material or plain_grade(stock.material) == plain_grade(kind.material)
    return graded and (
        stock.thickness_mm is None
        or kind.thickness_mm is None
        or abs(stock.thickness_mm - kind.thickness_mm) < _SAME_MM
    )


def left_of(wanted: Demand, used: Counter[int]) -> Demand:
    """The order with the stock that other groups have left; `used` counts sheets by the identity of their stock."""
    left = (
        stock if stock.count is None else replace(stock, count=stock.count - used[id(stock.sheet)])
        for stock in wanted.stocks
    )
    return replace(wanted, stocks=tuple(stock for stock in left if stock.count is None or stock.count > 0))


# Which profile cuts a group: the plant's own of that material and thickness, or one with the row of its chart.

ROW = OF_LISTS
"""How the id of a question about a group begins; what it is cut from follows."""
_SKIP, _AS_IT_IS, _BETWEEN = "skip", "as-it-is", "interpolate"


class ListQuestions(Questions):
    """A list names material for which no profile has values, and nobody has said how it is cut."""

    def _text(self) -> str:
        lines = [f"  {k}. " + question.told().replace("\n", "\n  ") for k, question in enumerate(self.questions, 1)]
        return "\n".join(["the list raises questions that nobody has answered:", *lines])


@dataclass(frozen=True, eq=False, slots=True)
class Cutting:
    """How a group is cut: the profile, the one that it was made of, and what was set in that, as `KEY=VALUE`."""

    plant: Profile
    base: Profile
    settings: tuple[str, ...] = ()


def cutting_of(plants: Sequence[Profile], group: Group, answers: Answers = ()) -> Cutting | Question | None:
    """How a group is cut, a question where nobody can know, or None where the answer leaves its parts out.

    The first of `plants` serves parts of which nothing is said.
    """
    fitting = [plant for plant in plants if _is_of(plant, group)] if group.said else plants[:1]
    if fitting:
        return Cutting(fitting[0], fitting[0])
    why, charted = [], _charted(plants)
    for plant, chart in charted:
        try:
            return _with(plant, (*chart, *_settings(group)))
        except InputError as error:
            why.append(error.message.removeprefix("--set (in Python: settings): "))
    question = _question(plants, charted, group, why)
    answer = dict(answers).get(question.id)
    if answer is None:
        return question
    if answer not in (choice.value for choice in question.choices):
        known = ", ".join(choice.value for choice in question.choices)
        raise InputError(f"--answer {question.id}={answer}: expected one of {known}")
    if answer == _SKIP:
        return None
    if answer == _AS_IT_IS:
        return Cutting(plants[0], plants[0])
    plant, chart = charted[0]
    if answer == _BETWEEN:
        return _with(plant, (*chart, *_settings(group), "material.interpolate=true"))
    return _with(plant, _as_row(plant, chart, group, answer))


_STARTING = {"plasma": "plasma-air", "oxyfuel": "oxyfuel"}
"""The shipped chart for a process, which a shipped profile takes where it is for another thickness."""


def _charted(plants: Sequence[Profile]) -> list[tuple[Profile, tuple[str, ...]]]:
    """The profiles that have a chart; else the first with the setting that gives it the shipped one, if it may."""
    own: list[tuple[Profile, tuple[str, ...]]] = [(plant, ()) for plant in plants if plant.material.chart is not None]
    chart = _STARTING.get(plants[0].machine.process)
    if own or chart is None or not plants[0].file.startswith(SHIPPED):
        return own
    return [(plants[0], (f"material.chart={chart}",))]


def _is_of(plant: Profile, group: Group) -> bool:
    material = plant.material
    graded = not group.material or plain_grade(material.name) == plain_grade(group.material)
    return graded and (group.thickness_mm is None or abs(material.thickness_mm - group.thickness_mm) < _SAME_MM)


def _settings(group: Group) -> tuple[str, ...]:
    settings = [f"material.thickness={group.thickness_mm:g} mm"] if group.thickness_mm is not None else []
    return (*settings, *([f"material.name={_quoted(group.material)}"] if group.material else []))


def _with(plant: Profile, settings: tuple[str, ...]) -> Cutting:
    return Cutting(with_settings(plant, [read_setting(one) for one in settings]), plant, settings)


def _as_row(plant: Profile, chart: tuple[str, ...], group: Group, thickness: str) -> tuple[str, ...]:
    """Settings that cut a group with the row of another thickness."""
    settings = (*chart, f"material.thickness={thickness}", *_settings(group)[1:])
    at = with_settings(plant, [read_setting(one) for one in settings])
    assert at.chart is not None
    taken = [(column_of(one.column), one.text) for one in at.chart.taken]
    rows = [f"{'.'.join(c.key)}={_quoted(text)}" for c, text in taken if c.option and c.angle_deg is None]
    kerfs = ", ".join(f"{c.angle_deg:g}: {text}" for c, text in taken if c.angle_deg is not None)
    rows += [f"cuts.bevel.kerfs={{{kerfs}}}"] if kerfs else []
    named = ("material.name=", "material.thickness=")
    return ("material.chart=none", *_settings(group), *(row for row in rows if not row.startswith(named)))


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _question(
    plants: Sequence[Profile],
    charted: Sequence[tuple[Profile, tuple[str, ...]]],
    group: Group,
    why: Sequence[str],
) -> Question:
    of = [f"{plant.name} ({plant.material.name}, {plant.material.thickness_mm:g} mm)" for plant in plants]
    reasons = "; ".join(why) or f"no profile is of it, and none has a chart: {', '.join(of)}"
    choices = _rows(charted, group)
    if not choices or all(plant.material.chart is None for plant in plants):
        choices.append(Choice(_AS_IT_IS, f"cut with {plants[0].name} as it is", of[0]))
    choices.append(Choice(_SKIP, "leave its parts out"))
    count = sum(kind.quantity for kind in group.wanted.types)
    text = f"how are {count} parts of {group.said} cut? {reasons}"
    return Question(f"{ROW}{group.name}", text, tuple(choices))


def _rows(charted: Sequence[tuple[Profile, tuple[str, ...]]], group: Group) -> list[Choice]:
    """Rows of the chart that are near, and what lies between them."""
    if not charted or group.thickness_mm is None:
        return []
    plant, _ = charted[0]
    file = plant.material.chart or shipped_charts()[_STARTING[plant.machine.process]]
    chart = read_chart(str(file), plant.material.chart_units)
    thicknesses = sorted(_thicknesses(chart, group.material))
    thicker = [t for t in thicknesses if t > group.thickness_mm]
    thinner = [t for t in thicknesses if t < group.thickness_mm]
    found = [Choice(_BETWEEN, "what lies between the rows")] if thicker and thinner else []
    return found + [
        Choice(f"{t:g}mm", f"the row of {t:g} mm, {side}")
        for t, side in [*((t, "thicker") for t in thicker[:1]), *((t, "thinner") for t in thinner[-1:])]
    ]


def _thicknesses(chart: Chart, material: str) -> set[float]:
    return {
        t
        for row in chart.rows
        if isinstance(t := row.values.get("thickness"), float)
        and (not material or _same_grade(str(row.values.get("material", material)), material))
    }


def _same_grade(of_row: str, material: str) -> bool:
    return plain_grade(of_row) == plain_grade(material) or of_row == family_of(material)


def cuttings_of(
    plants: Sequence[Profile], groups: Sequence[Group], answers: Answers = ()
) -> tuple[list[tuple[Group, Cutting]], list[BadRow]]:
    """Each group with how it is cut, and the parts of those that answers leave out.

    Raises ListQuestions if nobody can know how a group is cut: all of them at once.
    """
    found: list[tuple[Group, Cutting]] = []
    left_out: list[BadRow] = []
    questions: list[Question] = []
    for group in groups:
        match cutting_of(plants, group, answers):
            case None:
                left_out += (BadRow(kind.name, None, f"left out with {group.said}") for kind in group.wanted.types)
            case Question() as question:
                questions.append(question)
            case Cutting() as cutting:
                found.append((group, cutting))
    if questions:
        raise ListQuestions(questions)
    return found, left_out


# What cannot be cut is found before parts are laid: each alone, on a sheet of its own.

_BESIDE_MM = 100.0


def uncuttable(wanted: Demand, plant: Profile, spacing: Spacing) -> dict[int, str]:
    """Parts that cannot be cut even alone on a large sheet, or fit on no sheet, by number: why."""
    alone = replace(plant, locks=())
    found = {kind: why for kind, one in enumerate(wanted.types) if (why := _why_not(one, alone))}
    shapes = Shapes(wanted.types, spacing.gap_mm, spacing.common)
    for kind in too_large(wanted, shapes, spacing):
        x0, y0, x1, y1 = wanted.types[kind].part.outer.polygon.bounds
        size = f"{x1 - x0:.1f} × {y1 - y0:.1f} mm"
        found.setdefault(kind, f"fits on no sheet, it is {size}: give a larger sheet, or allow other rotations")
    return found


def _why_not(kind: PartType, plant: Profile) -> str:
    pose = kind.poses[0]
    x0, y0, x1, y1 = Placed(0, pose, 0.0, 0.0).area(kind.part.outer.polygon).bounds
    lying = Placed(0, pose, _BESIDE_MM - x0, _BESIDE_MM - y0).part(kind.part, kind.name)
    sheet = Sheet.rectangle(x1 - x0 + 2 * _BESIDE_MM, y1 - y0 + 2 * _BESIDE_MM)
    try:
        nest = plant.as_cut(Nest(sheet, (lying,)))
        build_with_older_kerfs(nest, plant.lead_options(nest))
    except (InputError, RulesConflict) as error:
        return " ".join(str(error).split())
    return ""


def without(wanted: Demand, kinds: Collection[int]) -> Demand:
    """The order without these part types."""
    return replace(wanted, types=tuple(kind for k, kind in enumerate(wanted.types) if k not in kinds))
