"""What a chart says of one material in one thickness: the values of a row, and where asked, what lies between two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from kerfwise.rules.options.quantities import Quantity
from kerfwise.rules.options.suggest import unknown

from .chart import SAME_MM, Chart, ChartRow, Value, same, written
from .columns import COLUMNS, PROCESS
from .row_choice import RowChoice

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
    """What a chart says, column by column, and what the row is called: None where there is none of that thickness."""

    label: str
    values: Mapping[str, Found]
    row: ChartRow | None


def look_up(
    chart: Chart, choice: RowChoice | None, material: str, thickness_mm: float, interpolate: bool = False
) -> LookedUp:
    """The values for a row of this name, or of these columns; without a choice for the material and the thickness.

    With `interpolate` what the row lacks, or all where there is no row of that thickness, lies on the straight line
    between the next thinner and the next thicker row of the same material, current and gas.

    Raises
    ------
    NoRow
        If there is no such row, or more than one: with the near ones and their lines.

    Examples
    --------
    >>> thin = ChartRow(2, {"material": "S235", "thickness": 6.0, "kerf": 1.5})
    >>> thick = ChartRow(3, {"material": "S235", "thickness": 10.0, "kerf": 1.9})
    >>> found = look_up(Chart("shop.csv", "", (thin, thick)), None, "S235", 8.0, interpolate=True)
    >>> found.values["kerf"]
    Found(value=1.7, lines=(2, 3), between_mm=(6.0, 10.0))
    """
    asked: dict[str, Value] = dict(choice or (("material", material), ("thickness", thickness_mm)))
    if "name" in asked:
        row = _only([r for r in _named(chart, str(asked["name"])) if _fits(r, asked)], asked, chart)
        kin, at_mm = _kin(chart, row), row.values.get("thickness")
    else:
        graded = any("material" in row.values for row in chart.rows)
        asked = {**({"material": material} if graded else {}), "thickness": thickness_mm, **asked}
        kin, at_mm = _alike(chart, asked), asked["thickness"]
        row = None
        exact = [r for r in kin if same(r.values.get("thickness"), at_mm)]
        if exact:
            row = _only(exact, asked, chart)
            kin = [r for r in kin if _one_process(r, row)]
        elif not interpolate:
            raise NoRow(_no_thickness(kin, asked, chart, "; say interpolate: true to have what lies between two rows"))
    own = {} if row is None else row.values
    values = {c: Found(v, (row.line_of(c),)) for c, v in own.items() if c != "name" and row is not None}
    if interpolate and isinstance(at_mm, float):
        between = _neighbours(kin, at_mm)
        if row is None:
            _expect_one_process(between, asked, chart)
        values = {**_blended(kin, at_mm, row is None), **values}
    if row is None:
        known = [c for c in ("material", "thickness") if c in asked]
        told = ", ".join(written(c, asked[c]) for c in known)
        values |= {c: Found(asked[c], ()) for c in known}
        return LookedUp(told, values, None)
    return LookedUp(row.label, values, row)


def _named(chart: Chart, name: str) -> list[ChartRow]:
    found = [row for row in chart.rows if any(same(one, name) for one in row.names)]
    if not found:
        names = list(dict.fromkeys(one for row in chart.rows for one in row.names[:1]))
        if not names:
            raise NoRow(f"no row of {chart.file} has a name: say such as row: {{material: S235, thickness: 6 mm}}")
        raise NoRow(f"{chart.file}: {unknown('row', name, names)}")
    return found


def _alike(chart: Chart, asked: Mapping[str, Value]) -> list[ChartRow]:
    """The rows that have what is asked, whatever their thickness.

    Raises
    ------
    NoRow
        If there are none: with the first column that no row has so.
    """
    rows: Sequence[ChartRow] = chart.rows
    if not any("thickness" in row.values for row in rows):
        names = ", ".join(row.label for row in rows[:_NAMED])
        raise NoRow(f"{chart.file} gives no thicknesses: name the row, such as row: {rows[0].label} (it has {names})")
    for column, value in asked.items():
        if column == "thickness":
            continue
        fitting = [row for row in rows if same(row.values.get(column), value)]
        if not fitting:
            known = [row.values[column] for row in rows if column in row.values]
            texts = list(dict.fromkeys(written(column, one) for one in known))
            raise NoRow(f"{chart.file}: {unknown(column, written(column, value), texts)}")
        rows = fitting
    return list(rows)


def _kin(chart: Chart, row: ChartRow) -> list[ChartRow]:
    """The rows of the same material, current and gas as one."""
    if "material" not in row.values:
        return [row]
    return [
        other
        for other in chart.rows
        if same(other.values.get("material"), row.values["material"]) and _one_process(other, row)
    ]


def _one_process(one: ChartRow, other: ChartRow) -> bool:
    return all(one.values.get(p) == other.values.get(p) for p in PROCESS)


def _fits(row: ChartRow, asked: Mapping[str, Value]) -> bool:
    return all(column == "name" or same(row.values.get(column), value) for column, value in asked.items())


def _only(rows: Sequence[ChartRow], asked: Mapping[str, Value], chart: Chart) -> ChartRow:
    if len(rows) == 1:
        return rows[0]
    told = ", ".join(f"{column} {written(column, value)}" for column, value in asked.items())
    if not rows:
        raise NoRow(f"{chart.file} has no row with {told}")
    lines = ", ".join(str(row.line) for row in rows[:_NAMED])
    differ = [c for c in COLUMNS if c not in asked and len({row.values.get(c) for row in rows}) > 1]
    tell = [c for c in ("name", *PROCESS) if c in differ] or differ[:3]
    how = (
        f": say also {' or '.join(tell)}, such as row: {_example(rows[0], asked, tell[0])}" if tell else ": delete one"
    )
    raise NoRow(f"{chart.file} has {len(rows)} rows with {told} (lines {lines}){how}")


def _example(row: ChartRow, asked: Mapping[str, Value], column: str) -> str:
    pairs = {**asked, **({column: row.values[column]} if column in row.values else {})}
    return f"{{{', '.join(f'{c}: {written(c, v)}' for c, v in pairs.items())}}}"


def _no_thickness(rows: Sequence[ChartRow], asked: Mapping[str, Value], chart: Chart, more: str) -> str:
    at_mm = float(asked["thickness"])
    known = sorted((t, row.line) for row in rows if isinstance(t := row.values.get("thickness"), float))
    near = sorted(sorted(known, key=lambda one: abs(one[0] - at_mm))[:4])
    told = ", ".join(f"{written('thickness', t)} (line {line})" for t, line in near)
    inside = bool(known) and known[0][0] < at_mm < known[-1][0]
    of = f" of {asked['material']}" if "material" in asked else ""
    at = written("thickness", at_mm)
    return f"{chart.file} has no row{of} at {at}: near are {told or 'none'}{more if inside else ''}"


def _neighbours(rows: Sequence[ChartRow], at_mm: float) -> list[ChartRow]:
    """All rows of the next smaller and of the next greater thickness."""
    known = {t for row in rows if isinstance(t := row.values.get("thickness"), float)}
    below = max((t for t in known if t < at_mm - SAME_MM), default=None)
    above = min((t for t in known if t > at_mm + SAME_MM), default=None)
    return [row for row in rows if row.values.get("thickness") in {below, above} - {None}]


def _expect_one_process(rows: Sequence[ChartRow], asked: Mapping[str, Value], chart: Chart) -> None:
    """Refuse to go between rows that are other settings of the machine, or beyond the end of a chart."""
    if len({row.values["thickness"] for row in rows}) < 2:
        raise NoRow(_no_thickness(_alike(chart, asked), asked, chart, "") + "; beyond its ends a chart says nothing")
    for column in PROCESS:
        differ = {row.values.get(column) for row in rows}
        if len(differ) > 1:
            told = " and ".join(
                f"{written(column, row.values[column]) if column in row.values else 'none'} (line {row.line})"
                for row in rows[:_NAMED]
            )
            raise NoRow(
                f"{chart.file}: at {written('thickness', asked['thickness'])} nothing lies between rows of another "
                f"{column}: {told}; say which with row: {{{column}: …}}, or add the row"
            )
    _only_one_each(rows, asked, chart)


def _only_one_each(rows: Sequence[ChartRow], asked: Mapping[str, Value], chart: Chart) -> None:
    for thickness in {row.values["thickness"] for row in rows}:
        _only([row for row in rows if row.values["thickness"] == thickness], {**asked, "thickness": thickness}, chart)


def _blended(rows: Sequence[ChartRow], at_mm: float, texts: bool) -> dict[str, Found]:
    """Every column between the nearest rows that have it; with `texts` those too that are the same in both."""
    found: dict[str, Found] = {}
    for name, column in COLUMNS.items():
        if name in ("name", "material", "thickness"):
            continue
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
    kind = COLUMNS[column].kind
    unit = kind.units[kind.bare] if isinstance(kind, Quantity) else Fraction(1)
    first, last = Fraction(low) / unit, Fraction(high) / unit
    return float(Fraction(f"{float(first + (last - first) * Fraction(share)):.9g}") * unit)
