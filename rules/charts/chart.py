"""A material chart as it was read, and what it says of one material in one thickness."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import yaml

from kerfwise.encoder.bevels.bevel import LEAST_DEG, MOST_DEG
from kerfwise.encoder.nearest_name import unknown
from kerfwise.rules.options.kind import Number, OptionKind, Text, Unfit, scalar_text
from kerfwise.rules.options.quantities import (
    AMPS,
    CUT_FEED,
    FLOW,
    KERF,
    MARK_FEED,
    PIERCE_TIME,
    SHARE_OF_POWER,
    THICKNESS,
    TORCH_HEIGHT,
    VOLTS,
    Quantity,
)
from kerfwise.rules.options.yaml_positions import is_empty

# A material chart as it was read: rows of values, each with the line of the file that it stands in.

Value = float | str
SAME_MM = 1e-6


@dataclass(frozen=True, slots=True)
class ChartRow:
    """One row: the line it begins in, what it is called by, and its values by column, in the profile's own units.

    `names` are its own name and, in QtPlasmaC's files, its number; `lines` are the lines of values that have their own.
    """

    line: int
    values: Mapping[str, Value]
    names: tuple[str, ...] = ()
    lines: Mapping[str, int] | None = None

    def line_of(self, column: str) -> int:
        """The line that a value stands in."""
        return (self.lines or {}).get(column, self.line)

    @property
    def label(self) -> str:
        """What the row is called in messages."""
        texts = [
            value_text(column, self.values[column]) for column in ("material", "thickness") if column in self.values
        ]
        return self.names[0] if self.names else ", ".join(texts) or f"line {self.line}"


@dataclass(frozen=True, slots=True)
class Chart:
    """A chart: its file, the sha256 of its bytes, and its rows in the order of the file."""

    file: str
    sha256: str
    rows: tuple[ChartRow, ...]


def same_value(one: Value | None, other: Value | None, rel_tol: float = 1e-9, abs_tol: float = SAME_MM) -> bool:
    """Whether two values are equal, but for capitals and rounding; what is not there equals nothing.

    Examples
    --------
    >>> same_value("O2", "o2 "), same_value(6.0, 6.0000001), same_value(6.0, 6.1), same_value(None, 6.0)
    (True, True, False, False)
    """
    if isinstance(one, str) or isinstance(other, str):
        return str(one).strip().casefold() == str(other).strip().casefold()
    return one is not None and other is not None and math.isclose(one, other, rel_tol=rel_tol, abs_tol=abs_tol)


def value_text(column: str, value: Value) -> str:
    """A value as a person reads it.

    Examples
    --------
    >>> value_text("feed", 2500 / 60), value_text("gas", "O2"), value_text("thickness", 6.0)
    ('2500 mm/min', 'O2', '6 mm')
    """
    return str(value) if isinstance(value, str) else _short(column_of(column).kind.write(value))


def _short(text: str) -> str:
    number, _, unit = text.partition(" ")
    return f"{float(number):.6g} {unit}".strip()


# The columns that a material chart may have: what each is, in which units, and which option of a profile it sets.


@dataclass(frozen=True, slots=True)
class Column:
    """One column. `section` and `option` are the key of a profile that it sets, "" for what only names a row.

    A kerf by angle is one row of the option's table, that of `angle_deg`.
    """

    kind: OptionKind
    help: str
    section: str = ""
    option: str = ""
    angle_deg: float | None = None

    @property
    def key(self) -> tuple[str, str]:
        """Section and option, as one."""
        return self.section, self.option

    @property
    def units(self) -> tuple[str, ...]:
        """The units that a number may have here; none for texts and plain numbers."""
        return tuple(self.kind.units) if isinstance(self.kind, Quantity) else ()

    @property
    def blends(self) -> bool:
        """Whether a value lies between two others: numbers do, texts do not."""
        return not isinstance(self.kind, Text)


COLUMNS: Mapping[str, Column] = {
    "name": Column(Text(), "what the row is called"),
    "source": Column(Text(), "who has published the row: its values are starting values then"),
    "material": Column(Text(), "grade of the sheet", "material", "name"),
    "thickness": Column(THICKNESS, "thickness of the sheet", "material", "thickness"),
    "kerf": Column(KERF, "width that the cut burns away", "material", "kerf"),
    "feed": Column(CUT_FEED, "speed while cutting", "machine", "cut_feed"),
    "mark_feed": Column(MARK_FEED, "speed while marking", "machine", "mark_feed"),
    "pierce_delay": Column(PIERCE_TIME, "time to pierce", "machine", "pierce_time"),
    "pierce_height": Column(TORCH_HEIGHT, "height of the torch while it pierces", "material", "pierce_height"),
    "cut_height": Column(TORCH_HEIGHT, "height of the torch while it cuts", "material", "cut_height"),
    "amps": Column(AMPS, "current of the arc", "material", "amps"),
    "volts": Column(VOLTS, "voltage of the arc", "material", "volts"),
    "power": Column(SHARE_OF_POWER, "power while cutting", "material", "power"),
    "pierce_power": Column(SHARE_OF_POWER, "power while piercing", "material", "pierce_power"),
    "mark_power": Column(SHARE_OF_POWER, "power while marking", "material", "mark_power"),
    "gas": Column(Text(), "gas, or gases", "material", "gas"),
    "gas_flow": Column(FLOW, "gas that flows with the torch on", "material", "gas_flow"),
    "process": Column(Text(), "what the control calls the row, for a dialect's {process}", "material", "process"),
    "small_hole_feed": Column(
        Number(0.05, 1), "share of the feed in the smallest holes", "small_holes", "small_hole_feed"
    ),
    "corner_feed": Column(Number(0.05, 1), "share of the feed at corners", "corners", "corner_feed"),
}
"""Column → what it is. A row has those that it knows, and kerfs by angle, such as `kerf_30` (see `column_of`)."""
_BY_ANGLE = re.compile(r"kerf_(\d{1,2}(?:\.\d{1,3})?)")
ABOUT = ("name", "source")
"""Columns that say something of the row itself."""
PROCESS = ("amps", "gas")
"""Rows that differ in these are other settings of the machine: nothing lies between them."""


def known_column(name: str) -> str | None:
    """The name of a column as rows have it; None where there is no such column.

    Examples
    --------
    >>> known_column("kerf"), known_column("kerf_30.0"), known_column("kerf_75"), known_column("colour")
    ('kerf', 'kerf_30', None, None)
    """
    angle = _BY_ANGLE.fullmatch(name)
    if angle is None or not LEAST_DEG <= float(angle[1]) <= MOST_DEG:
        return name if name in COLUMNS else None
    return f"kerf_{float(angle[1]):g}"


def column_of(name: str) -> Column:
    """What a column is, by its name as rows have it."""
    if (angle := _BY_ANGLE.fullmatch(name)) is None:
        return COLUMNS[name]
    return Column(
        KERF, f"kerf of a torch that leans by {angle[1]}°, square to its jet", "cuts", "bevel.kerfs", float(angle[1])
    )


# What a chart says of one material in one thickness: the values of a row, and where asked, what lies between two.

_NAMED = 12


class NoRow(ValueError):
    """The chart has no such row, or several; the text says which there are."""


@dataclass(frozen=True, slots=True)
class Found:
    """One value of a chart: the lines it comes from, two where it lies between two rows.

    `between_mm` are the thicknesses of these rows.
    """

    value: Value
    lines: tuple[int, ...]
    between_mm: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class LookedUp:
    """What a chart says, column by column, and what the row is called: None where there is none of that thickness.

    `source` is who has published the row, or the rows between which the values lie; "" where nobody is named.
    """

    label: str
    values: Mapping[str, Found]
    row: ChartRow | None
    source: str = ""


def look_up(
    chart: Chart, choice: RowChoice | None, material: str, thickness_mm: float, interpolate: bool = False
) -> LookedUp:
    """The values for a row of this name, or of these columns; without a choice for the material and the thickness.

    With `interpolate` what the row lacks, or all where there is no row of that thickness, lies on the straight line
    between the next thinner and the next thicker row of the same material, current and gas. Raises NoRow if there is no
    such row, or more than one: with the near ones and their lines.

    Examples
    --------
    >>> thin = ChartRow(2, {"material": "S235", "thickness": 6.0, "kerf": 1.5})
    >>> thick = ChartRow(3, {"material": "S235", "thickness": 10.0, "kerf": 1.9})
    >>> found = look_up(Chart("shop.csv", "", (thin, thick)), None, "S235", 8.0, interpolate=True)
    >>> found.values["kerf"]
    Found(value=1.7, lines=(2, 3), between_mm=(6.0, 10.0))
    """
    wanted: dict[str, Value] = dict(choice or (("material", material), ("thickness", thickness_mm)))
    if "name" in wanted:
        row = _only([r for r in _named(chart, str(wanted["name"])) if _fits(r, wanted)], wanted, chart)
        kin, at_mm = _kin(chart, row), row.values.get("thickness")
    else:
        graded = any("material" in row.values for row in chart.rows)
        wanted = {**({"material": material} if graded else {}), "thickness": thickness_mm, **wanted}
        kin, at_mm = _alike(chart, wanted), wanted["thickness"]
        row = None
        exact = [r for r in kin if same_value(r.values.get("thickness"), at_mm)]
        if exact:
            row = _only(exact, wanted, chart)
            kin = [r for r in kin if _one_process(r, row)]
        elif not interpolate:
            raise NoRow(_no_thickness(kin, wanted, chart, "; say interpolate: true to have what lies between two rows"))
    own = {} if row is None else row.values
    values = {c: Found(v, (row.line_of(c),)) for c, v in own.items() if c not in ABOUT and row is not None}
    sources = [] if row is None else [row]
    if interpolate and isinstance(at_mm, float):
        between = _neighbours(kin, at_mm)
        sources = sources or between
        if row is None:
            _expect_one_process(between, wanted, chart)
        values = {**_blended(kin, at_mm, row is None), **values}
    source = ", ".join(dict.fromkeys(str(one.values["source"]) for one in sources if "source" in one.values))
    if row is None:
        known = [c for c in ("material", "thickness") if c in wanted]
        text = ", ".join(value_text(c, wanted[c]) for c in known)
        values |= {c: Found(wanted[c], ()) for c in known}
        return LookedUp(text, values, None, source)
    return LookedUp(row.label, values, row, source)


def _named(chart: Chart, name: str) -> list[ChartRow]:
    found = [row for row in chart.rows if any(same_value(one, name) for one in row.names)]
    if not found:
        names = list(dict.fromkeys(one for row in chart.rows for one in row.names[:1]))
        if not names:
            raise NoRow(f"no row of {chart.file} has a name: say such as row: {{material: S235, thickness: 6 mm}}")
        raise NoRow(f"{chart.file}: {unknown('row', name, names)}")
    return found


def _alike(chart: Chart, wanted: Mapping[str, Value]) -> list[ChartRow]:
    """The rows that have what is asked, whatever their thickness.

    Raises NoRow if there are none: with the first column that no row has so.
    """
    rows: Sequence[ChartRow] = chart.rows
    if not any("thickness" in row.values for row in rows):
        names = ", ".join(row.label for row in rows[:_NAMED])
        raise NoRow(f"{chart.file} gives no thicknesses: name the row, such as row: {rows[0].label} (it has {names})")
    for column, value in wanted.items():
        if column == "thickness":
            continue
        fitting = [row for row in rows if same_value(row.values.get(column), value)]
        if not fitting and column == "material":
            fitting = [row for row in rows if row.values.get(column) == family_of(str(value))]
        if not fitting:
            known = [row.values[column] for row in rows if column in row.values]
            texts = list(dict.fromkeys(value_text(column, one) for one in known))
            raise NoRow(f"{chart.file}: {unknown(column, value_text(column, value), texts)}")
        rows = fitting
    return list(rows)


_FAMILIES: Mapping[str, str] = {
    "mild steel": r"s ?[1-9]\d\d|st ?\d\d|a ?(36|572)|d[cd] ?\d\d|q ?\d\d\d|p ?2\d\d|1\.0\d|mild|carbon|ст ?\d|09г",
    "stainless steel": r"1\.4\d|aisi ?[34]|3(04|16|21)|x\d?cr|v[24]a|inox|stainless|12х18",
    "aluminium": r"al(mg|si|mn|\b)|alumin|en ?aw|am?g\d|[56]\d\d\d|3\.\d",
}


def family_of(material: str) -> str:
    """What a grade is, where a chart says no more than that: `mild steel` of S235; "" for what is not known.

    Examples
    --------
    >>> family_of("S355J2"), family_of("1.4301"), family_of("AlMg3"), family_of("oak")
    ('mild steel', 'stainless steel', 'aluminium', '')
    """
    return next((name for name, grades in _FAMILIES.items() if re.match(grades, material.strip().casefold())), "")


def _kin(chart: Chart, row: ChartRow) -> list[ChartRow]:
    """The rows of the same material, current and gas as one."""
    if "material" not in row.values:
        return [row]
    return [
        other
        for other in chart.rows
        if same_value(other.values.get("material"), row.values["material"]) and _one_process(other, row)
    ]


def _one_process(one: ChartRow, other: ChartRow) -> bool:
    return all(one.values.get(p) == other.values.get(p) for p in PROCESS)


def _fits(row: ChartRow, wanted: Mapping[str, Value]) -> bool:
    return all(column == "name" or same_value(row.values.get(column), value) for column, value in wanted.items())


def _only(rows: Sequence[ChartRow], wanted: Mapping[str, Value], chart: Chart) -> ChartRow:
    if len(rows) == 1:
        return rows[0]
    text = ", ".join(f"{column} {value_text(column, value)}" for column, value in wanted.items())
    if not rows:
        raise NoRow(f"{chart.file} has no row with {text}")
    lines = ", ".join(str(row.line) for row in rows[:_NAMED])
    differ = [c for c in COLUMNS if c not in wanted and len({row.values.get(c) for row in rows}) > 1]
    tell = [c for c in ("name", *PROCESS) if c in differ] or differ[:3]
    how = (
        f": say also {' or '.join(tell)}, such as row: {_example(rows[0], wanted, tell[0])}" if tell else ": delete one"
    )
    raise NoRow(f"{chart.file} has {len(rows)} rows with {text} (lines {lines}){how}")


def _example(row: ChartRow, wanted: Mapping[str, Value], column: str) -> str:
    pairs = {**wanted, **({column: row.values[column]} if column in row.values else {})}
    return f"{{{', '.join(f'{c}: {value_text(c, v)}' for c, v in pairs.items())}}}"


def _no_thickness(rows: Sequence[ChartRow], wanted: Mapping[str, Value], chart: Chart, more: str) -> str:
    at_mm = float(wanted["thickness"])
    known = sorted((t, row.line) for row in rows if isinstance(t := row.values.get("thickness"), float))
    near = sorted(sorted(known, key=lambda one: abs(one[0] - at_mm))[:4])
    text = ", ".join(f"{value_text('thickness', t)} (line {line})" for t, line in near)
    inside = bool(known) and known[0][0] < at_mm < known[-1][0]
    of = f" of {wanted['material']}" if "material" in wanted else ""
    at = value_text("thickness", at_mm)
    return f"{chart.file} has no row{of} at {at}: near are {text or 'none'}{more if inside else ''}"


def _neighbours(rows: Sequence[ChartRow], at_mm: float) -> list[ChartRow]:
    """All rows of the next smaller and of the next greater thickness."""
    known = {t for row in rows if isinstance(t := row.values.get("thickness"), float)}
    below = max((t for t in known if t < at_mm - SAME_MM), default=None)
    above = min((t for t in known if t > at_mm + SAME_MM), default=None)
    return [row for row in rows if row.values.get("thickness") in {below, above} - {None}]


def _expect_one_process(rows: Sequence[ChartRow], wanted: Mapping[str, Value], chart: Chart) -> None:
    """Refuse to go between rows that are other settings of the machine, or beyond the end of a chart."""
    if len({row.values["thickness"] for row in rows}) < 2:
        raise NoRow(_no_thickness(_alike(chart, wanted), wanted, chart, "") + "; beyond its ends a chart says nothing")
    for column in PROCESS:
        differ = {row.values.get(column) for row in rows}
        if len(differ) > 1:
            text = " and ".join(
                f"{value_text(column, row.values[column]) if column in row.values else 'none'} (line {row.line})"
                for row in rows[:_NAMED]
            )
            raise NoRow(
                f"{chart.file}: at {value_text('thickness', wanted['thickness'])} nothing lies between rows of another "
                f"{column}: {text}; say which with row: {{{column}: …}}, or add the row"
            )
    _check_single_values(rows, wanted, chart)


def _check_single_values(rows: Sequence[ChartRow], wanted: Mapping[str, Value], chart: Chart) -> None:
    for thickness in {row.values["thickness"] for row in rows}:
        _only([row for row in rows if row.values["thickness"] == thickness], {**wanted, "thickness": thickness}, chart)


def _blended(rows: Sequence[ChartRow], at_mm: float, texts: bool) -> dict[str, Found]:
    """Every column between the nearest rows that have it; with `texts` those too that are the same in both."""
    found: dict[str, Found] = {}
    by_angle = sorted({name for row in rows for name in row.values} - COLUMNS.keys())
    for name in (*COLUMNS, *by_angle):
        if name in (*ABOUT, "material", "thickness"):
            continue
        column = column_of(name)
        having = [row for row in rows if name in row.values]
        ends = sorted(_neighbours(having, at_mm), key=lambda row: float(row.values["thickness"]))
        if len(ends) != 2:
            continue
        low, high = ends
        (a, y), (b, z) = ((float(row.values["thickness"]), row.values[name]) for row in ends)
        lines = (low.line_of(name), high.line_of(name))
        if y == z and (texts or column.blends):
            found[name] = Found(y, lines)
        elif column.blends:
            found[name] = Found(_between(name, float(y), float(z), (at_mm - a) / (b - a)), lines, (a, b))
    return found


def _between(column: str, low: float, high: float, share: float) -> float:
    """A number that lies a share of the way from one to another, with few digits in its usual unit."""
    kind = column_of(column).kind
    unit = kind.units[kind.bare] if isinstance(kind, Quantity) else Fraction(1)
    first, last = Fraction(low) / unit, Fraction(high) / unit
    return float(Fraction(f"{float(first + (last - first) * Fraction(share)):.9g}") * unit)


# Which row of a chart a profile means: by its name, or by what stands in its columns.

AUTO = "auto"
RowChoice = tuple[tuple[str, Value], ...]
"""Column and value, pair by pair."""


@dataclass(frozen=True, slots=True)
class RowChoiceKind(OptionKind):
    """A row's name, or a mapping such as `{material: S355, thickness: 8 mm, amps: 45}`; `auto` stands for None."""

    def read(self, node: yaml.Node) -> RowChoice | None:
        if not isinstance(node, yaml.MappingNode):
            text = scalar_text(node, self).strip()
            if not text:
                raise self.refuse(node)
            return None if text == AUTO else (("name", text),)
        found: dict[str, Value] = {}
        for key, value in node.value:
            name = str(key.value)
            if name not in COLUMNS:
                raise Unfit(unknown("column", name, COLUMNS), key)
            if name in found:
                raise Unfit(f"{name} is given twice", key)
            read = COLUMNS[name].kind.read(value) if not is_empty(value) else None
            if not isinstance(read, str | float | int):
                raise Unfit(f"{name}: expected {COLUMNS[name].kind.expected()}, got nothing", value)
            found[name] = read
        if not found:
            raise self.refuse(node)
        return tuple(found.items())

    def write(self, value: Any) -> str:
        if value is None:
            return AUTO
        pairs = [f"{name}: {COLUMNS[name].kind.write(one)}" for name, one in value]
        return f"{{{', '.join(pairs)}}}"

    def schema(self) -> dict[str, Any]:
        keys = {name: {"description": column.help, **column.kind.schema()} for name, column in COLUMNS.items()}
        mapping = {"type": "object", "properties": keys, "additionalProperties": False, "minProperties": 1}
        return {"anyOf": [Text().schema(), {"type": "integer"}, mapping]}

    def expected(self) -> str:
        return "a row's name, or some of its columns such as {material: S235, thickness: 6 mm}"


ROW_CHOICE = RowChoiceKind()
