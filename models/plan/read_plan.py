"""Reads kerfwise-plan/1 files; what does not fit the published schema is refused in place."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.resources import files
from itertools import islice
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from kerfwise.encoder.bevels.tilted_path import TiltedPath
from kerfwise.encoder.cut import Cut, Pierce, Span, Tab
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import places, read_limited, schema_message, strict_json, utf8_text
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import MOST_MEETINGS, has_too_many_crossings
from kerfwise.encoder.nest import CHORD_MM, CONTOUR_KINDS, Loss, Nest, lines_of_contours
from kerfwise.encoder.readers.drawing import LIMIT_MM, checked_curve
from kerfwise.models.physics.time_and_cost import Cost, TimeReport
from kerfwise.rules.plan_state import PlanState
from kerfwise.rules.profile.values import ForOneNest, ProfileValues, changed_since
from kerfwise.rules.statements import EXEMPTION_MM

from .plan import FORMAT, Dropped, LeftOut, Plan, PlannedCut, Prices, RuleReport, SolveReport, Totals
from .zones_cost import ZonesCost

if TYPE_CHECKING:
    from jsonschema import Draft202012Validator

MOST_ERRORS = 20
MOST_LEAD_MM = 100_000.0
"""A lead, or a link through waste, is no longer: longer than any sheet."""


def read_plan(path: str | Path) -> Plan:
    """Read a kerfwise-plan/1 file.

    Raises InputError if the file cannot be read, is not JSON, or holds what the format does not allow, with line and
    column.
    """
    try:
        data = read_limited(path)
    except InputError as error:
        raise InputError(f"not a plan: {error.message}", file=path, line=error.line, column=error.column) from None
    except OSError as error:
        raise InputError(f"cannot read the plan: {error.strerror}", file=path) from None
    except ValueError as error:  # no file can have this name
        raise InputError(f"not a plan: {error}", file=path) from None
    return plan_in(utf8_text(data, "a plan", path), path)


def plan_in(text: str, path: str | Path = "the plan") -> Plan:
    """The plan that a text is, which stands at `path`. Raises InputError as `read_plan` does."""
    try:
        data = strict_json(text)  # NaN becomes a text, which the schema refuses in place
    except InputError as error:
        raise InputError(f"not a plan: {error.message}", file=path, line=error.line, column=error.column) from None
    except json.JSONDecodeError as error:
        message = f"not a plan: expected JSON as solve writes it with --plan ({error.msg})"
        raise InputError(message, file=path, line=error.lineno, column=error.colno) from None
    except ValueError as error:  # a number of thousands of digits
        raise InputError(f"not a plan: {error}", file=path) from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise InputError(f'not a plan: expected "format": "{FORMAT}"', file=path)
    _check_schema(data, text, path)
    _check_order(data, path)
    _check_proof(data["solve"], path)
    _check_sums(data, path)
    try:
        return _plan_of(data)
    except InputError as error:
        raise InputError(f"the plan is damaged: {error.message}", file=path) from None


def _check_order(data: dict[str, Any], path: str | Path) -> None:
    """Cuts count from 1, those made before first."""
    already, cuts = (_finishing(data.get(key, [])) for key in ("already_cut", "cuts"))
    count = len(already)
    if data.get("resumed_after", 0) != count:
        says = f"it goes on after cut {data.get('resumed_after', 0)}, but lists {count} cuts as already cut"
        raise InputError(f"the plan is damaged: {says}", file=path)
    _expect_counted(already, 1, "what is already cut", path)
    _expect_counted(cuts, count + 1, "its cuts", path)
    for cut in (*data.get("already_cut", []), *data["cuts"]):
        if "stretch" in cut and not 1 <= cut["order"] <= count + len(cuts) + 1:
            says = f"a stretch of {cut['contour']} comes before cut {cut['order']}, which there is not"
            raise InputError(f"the plan is damaged: {says}", file=path)
        if cut["end_s"] < cut["start_s"]:
            says = f"cut {cut['order']} ends at {cut['end_s']:g} s, before it begins at {cut['start_s']:g} s"
            raise InputError(f"the plan is damaged: {says}", file=path)


def _finishing(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The cuts without those that leave their contours unfinished."""
    return [row for row in rows if "stretch" not in row]


@cache
def validator() -> Draft202012Validator:
    """The validator of the schema beside this file."""
    from jsonschema import Draft202012Validator as Validator

    return Validator(json.loads((files(__package__) / "plan.schema.json").read_text(encoding="utf-8")))


def _check_schema(data: dict[str, Any], text: str, path: str | Path) -> None:
    """Hold a plan against the schema; cuts that plainly fit are not shown to it, which would take long over many."""
    cuts = data.get("cuts")
    shown, numbers = data, []
    if isinstance(cuts, list):
        numbers = [k for k, cut in enumerate(cuts) if not _plain(cut)]
        shown = {**data, "cuts": [cuts[k] for k in numbers]}
    found: list[tuple[list[str | int], str]] = []
    for error in islice(validator().iter_errors(shown), MOST_ERRORS):
        steps = list(error.absolute_path)
        if len(steps) > 1 and steps[0] == "cuts":
            steps[1] = numbers[int(steps[1])]
        found.append((steps, schema_message(error)))
    if not found:
        return
    at = places(text, [steps for steps, _ in found])
    first = min(range(len(found)), key=lambda k: (at[k][0] or 0, at[k][1] or 0))
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    message = f"the plan is damaged: {_spoken(found[first][0])}: {found[first][1]}{more}"
    raise InputError(message, file=path, line=at[first][0], column=at[first][1])


def _spoken(steps: list[str | int]) -> str:
    """A path as "cuts 3, lead_in 1": lists count from 1."""
    words = "".join(f" {step + 1}" if isinstance(step, int) else f", {step}" for step in steps)
    return words.removeprefix(", ") or "the file"


def _plain(cut: object) -> bool:
    """True for a cut that the schema has nothing to say about."""
    if not isinstance(cut, dict) or len(_CUT_KINDS.keys() & cut.keys()) < len(_CUT_KINDS):
        return False
    if not all(type(cut[key]) in kinds for key, kinds in _CUT_KINDS.items()):
        return False
    texts = [*cut["because"], *(cut.get("excused", ()) if isinstance(cut.get("excused", ()), list | tuple) else (0,))]
    return (
        cut["kind"] in CONTOUR_KINDS
        and cut["direction"] in ("cw", "ccw")
        and 0 <= cut["zone"] <= LIMIT_MM
        and all(len(cut[key]) == 2 and _plain_row(cut[key]) for key in ("entry", "pierce"))
        and all(isinstance(row, list) and 2 <= len(row) <= 3 and _plain_row(row) for key in _PATHS for row in cut[key])
        and all(0 <= cut[key] <= 1e12 for key in ("length_mm", "start_s", "end_s"))
        and all(isinstance(text, str) for text in texts)
        and not _SELDOM & cut.keys()
    )


def _plain_row(row: list[object]) -> bool:
    return all(type(x) in (int, float) and -LIMIT_MM <= x <= LIMIT_MM for x in row)  # type: ignore[operator]


_PATHS = ("lead_in", "lead_out")
_SELDOM = {"across", "dwell_s", "linked", "span", "stretch", "tabs", "passes", "torch", "together"}
_NUMBER, _TEXT, _WHOLE, _LIST = (int, float), (str,), (int,), (list,)
_CUT_KINDS: dict[str, tuple[type, ...]] = {
    "order": _WHOLE, "contour": _TEXT, "part": _TEXT, "kind": _TEXT, "zone": _WHOLE, "entry": _LIST, "pierce": _LIST,
    "lead_in": _LIST, "lead_out": _LIST, "direction": _TEXT, "length_mm": _NUMBER, "start_s": _NUMBER,
    "end_s": _NUMBER, "because": _LIST,
}  # fmt: skip


def _plan_of(data: dict[str, Any]) -> Plan:
    return Plan(
        nest=data["nest"],
        profile=data["profile"],
        start_side=data["start_side"],
        start_side_because=data["start_side_because"],
        cuts=_cuts(data["cuts"]),
        totals=_record(Totals, data["totals"]),
        solve=_record(SolveReport, data["solve"]),
        prices=Prices.of_json(data["prices"]) if "prices" in data else None,
        rules=tuple(
            RuleReport(
                r["id"],
                r["strength"],
                r["holds"],
                tuple((tuple(e["contours"]), e["why"]) for e in r["exceptions"]),
                tuple((tuple(b["contours"]), b["why"]) for b in r.get("breaches", ())),
                r.get("file", ""),
                r.get("file_sha256", ""),
                r.get("in_place_of_shipped", False),
            )
            for r in data["rules"]
        ),
        dropped=tuple(Dropped(d["rule"], tuple(d["contours"]), d["why"]) for d in data["dropped"]),
        time=_record(TimeReport, data["time"]) if "time" in data else None,
        made_with=ForOneNest.of_json(data["job"]) if "job" in data else None,
        cost=Cost.of_json(data["totals"]["cost"]) if "cost" in data["totals"] else None,
        left_out=tuple(LeftOut(left["contour"], left["why"]) for left in data.get("left_out", ())),
        losses=tuple(Loss(row["contour"], tuple(row["touches"]), row["loss_mm"]) for row in data.get("losses", ())),
        zones_cost=ZonesCost.of_json(data["zones_cost"]) if "zones_cost" in data else None,
        origin=data.get("origin", "drawing"),
        zero=(float(data["zero"][0]), float(data["zero"][1])) if "zero" in data else (0.0, 0.0),
        already_cut=_cuts(data.get("already_cut", [])),
        broken_off=_cut(data["broken_off"]) if "broken_off" in data else None,
        pierces=tuple(
            Pierce(p["contour"], (float(p["at"][0]), float(p["at"][1])), p["before"], p["start_s"], p["end_s"])
            for p in data.get("pierces", ())
        ),
        state=PlanState.of_json(data["state"]) if "state" in data else None,
        begun=tuple(
            (row["order"], _cut(row)) for row in (*data.get("already_cut", []), *data["cuts"]) if "stretch" in row
        ),
    )


def _cuts(rows: list[dict[str, Any]]) -> tuple[PlannedCut, ...]:
    return tuple(_cut(row) for row in sorted(_finishing(rows), key=itemgetter("order")))


def _cut(c: dict[str, Any]) -> PlannedCut:
    return PlannedCut(
        Cut(
            c["contour"],
            (float(c["entry"][0]), float(c["entry"][1])),
            c["direction"],
            (float(c["pierce"][0]), float(c["pierce"][1])),
            _path(c, "lead_in"),
            _path(c, "lead_out"),
            c["zone"],
            c["start_s"],
            c["end_s"],
            tuple(c.get("excused", ())),
            c.get("linked", False),
            _span(ends) if (ends := c.get("stretch", c.get("span"))) is not None else None,
            tuple(Tab((float(t["at"][0]), float(t["at"][1])), float(t["width"])) for t in c.get("tabs", ())),
            c.get("torch", 1),
            c.get("together", ""),
            c["stretch"]["way"] if "stretch" in c else "",
        ),
        c["part"],
        c["kind"],
        c["length_mm"],
        tuple(c["because"]),
        c.get("dwell_s", 0.0),
        tuple((float(x), float(y)) for x, y in c.get("across", ())),
        tuple(TiltedPath.of_json(one) for one in c.get("passes", ())),
    )


def _span(ends: dict[str, Any]) -> Span:
    (x0, y0), (x1, y1) = ends["from"], ends["to"]
    return Span((float(x0), float(y0)), (float(x1), float(y1)))


def _path(cut: dict[str, Any], key: str) -> Curve | None:
    """A lead; one that goes nowhere is its one point."""
    if not cut[key]:
        return None
    path = checked_curve(cut[key], closed=False)
    if has_too_many_crossings(path.vertices[:, :2], closed=False, most=MOST_MEETINGS):
        raise InputError(f"its {key} crosses or touches itself more than {MOST_MEETINGS} times: no torch runs so")
    if path.length_mm > MOST_LEAD_MM:
        raise InputError(f"its {key} is {path.length_mm / 1000:.6g} m long: no torch runs so")
    return path


def _record(kind: Any, data: dict[str, Any]) -> Any:
    """The dataclass with the keys it knows; others are not this version's."""
    return kind(**{name: data[name] for name in kind.__slots__ if name in data})


# What a plan was made from, against what it is read with.

_SHA_DIGITS = 12


def source_changes(plan: Plan, nest: Nest, profile: ProfileValues) -> Iterator[str]:
    """A sentence for each thing that is not as it was when the plan was made: nest, profile, what is for one nest."""
    if plan.nest.get("sha256") != nest.sha256:
        yield "the nest is not the one the plan was made with (its sha256 differs)"
    if text := profile_change(plan, profile):
        yield text
    yield from changed_since(plan.made_with, profile.for_one_nest)


def profile_change(plan: Plan, profile: ProfileValues) -> str:
    """That a plan was made with another profile than this, with which, and what to do; "" where it was not."""
    own, sha256 = plan.profile.get("name", ""), plan.profile.get("sha256", "")
    if sha256 == profile.sha256:
        return ""
    text = f"the profile is not the one the plan was made with (its sha256 differs): this is '{profile.name}', "
    if not own:
        return f"{text}the plan does not say which that was"
    begins = f", whose sha256 begins {sha256[:_SHA_DIGITS]}" if sha256 else ""
    return f"{text}that was '{own}'{begins}: give it with -p (in Python profile=)"


def _expect_counted(cuts: list[dict[str, Any]], first: int, what: str, path: str | Path) -> None:
    """The order of these cuts is so many numbers from the first on, each once."""
    orders = Counter(cut["order"] for cut in cuts)
    missing = next((k for k in range(first, first + len(cuts)) if k not in orders), None)
    if missing is not None:
        counts = ", ".join(str(first + k) for k in range(3))
        twice = next((f", and {k} is there {n} times" for k, n in sorted(orders.items()) if n > 1), "")
        says = f"the order of {what} does not count {counts} …: {missing} is missing{twice}"
        raise InputError(f"the plan is damaged: {says}", file=path)


def _check_proof(solve: dict[str, Any], path: str | Path) -> None:
    """No plan costs less than what is proven, and the gap is the one between the two."""
    cost, bound, gap = (solve.get(key) for key in ("objective", "bound", "gap"))
    if bound is None or cost is None:
        return
    if bound > cost + _SAME_COST * max(1.0, abs(cost)):
        says = f"its bound, {bound:g} mm, is over its objective, {cost:g} mm"
        raise InputError(f"the plan is damaged: {says}", file=path)
    share = (cost - bound) / cost if cost > 0 else 0.0
    if gap is not None and abs(gap - share) > _SAME_GAP:
        says = f"its gap is {gap:g}, and its objective and bound make {share:.3g}"
        raise InputError(f"the plan is damaged: {says}", file=path)


def _check_sums(data: dict[str, Any], path: str | Path) -> None:
    """Times come to the total, what travel and breaches cost to the objective, and places that are not kept to a state.

    A state is shown to whoever stands at the machine.
    """
    time, prices = data.get("time", {}), data.get("prices")
    if "state" in data:
        state = PlanState.of_json(data["state"])
        listed = PlanState.of(state.places)
        if (listed.kind, listed.count) != (state.kind, data["state"]["count"]):
            says = (
                f"its state is {state.kind} ({data['state']['count']} places), and by its places it is {listed.short()}"
            )
            raise InputError(f"the plan is damaged: {says}", file=path)
    parts_s = [time[key] for key in ("cut_s", "idle_s", "pierce_s", "dwell_s") if key in time]
    for total_s in (time.get("total_s"), data["totals"]["time_s"]) if len(parts_s) > 2 else ():
        if total_s is not None and abs(sum(parts_s) - total_s) > _SAME_S + _SAME_COST * total_s:
            says = f"its times come to {sum(parts_s):.3f} s, and it says {total_s:.3f} s"
            raise InputError(f"the plan is damaged: {says}", file=path)
    share, sum_s = time.get("idle_share"), sum(parts_s)
    if share is not None and sum_s > 0 and abs(share - time["idle_s"] / sum_s) > _SAME_GAP:
        says = f"its share of idle travel is {share:g}, and its times make {time['idle_s'] / sum_s:.3g}"
        raise InputError(f"the plan is damaged: {says}", file=path)
    cost, excuses = data["solve"]["objective"], data["solve"].get("excuses", 0)
    if cost is not None and excuses * EXEMPTION_MM > cost * (1 + _SAME_COST) + _SAME_MM:
        says = f"it says {excuses} excuses of {EXEMPTION_MM:g} mm each, and its objective is {cost:.3f} mm"
        raise InputError(f"the plan is damaged: {says}", file=path)
    if prices is None:
        return
    sum_mm = Prices.of_json(prices).sum_mm
    if cost is not None and abs(sum_mm - cost) > _SAME_MM + _SAME_COST * abs(cost):
        says = f"its prices come to {sum_mm:.3f} mm, and its objective is {cost:.3f} mm"
        raise InputError(f"the plan is damaged: {says}", file=path)


_SAME_COST, _SAME_GAP, _SAME_MM, _SAME_S = 1e-4, 1e-3, 0.1, 0.01
"""Shares by which costs, and gaps, may differ: they are rounded in the file."""


# Whether a plan is one of a nest: what is drawn, timed or explained of it is looked up there.

OFF_MM = 1.0
"""How far from its contour the entry of a cut may be: more, and the plan is one of another nest."""
_MOST_TOLD = 12


def expect_plan_of(plan: Plan, nest: Nest, once: bool = True) -> None:
    """Refuse a plan whose cuts are not of this nest, as it is cut; `once` says that it may cut nothing twice.

    Raises InputError if the nest does not have a contour that the plan cuts, or has it as another part or kind, the
    plan cuts it twice, or enters it where it is not: each with the number of the cut.
    """
    wrong = list(islice(_not_of(plan, nest, once), _MOST_TOLD))
    if wrong:
        raise InputError(
            f"the plan is not one of {nest.file or 'the nest'}: {wrong[0]}; give the nest that it was made from",
            file=nest.file or None,
            details=tuple(wrong[1:]),
        )


def expect_named_alike(plan: Plan, nest: Nest) -> None:
    """Refuse a plan that has a contour of this nest as another part or kind, or says something of one that it has not.

    What else is wrong with it is judged. Raises InputError with the number of the cut, or what the plan says.
    """
    rows = [row for row in enumerate((*plan.already_cut, *plan.cuts), 1) if row[1].cut.contour in nest.index]
    wrong = [text for number, row in rows if (text := _named_otherwise(row, nest, number))]
    for says in (*wrong, *_said_of_others(plan, nest)):
        text = f"the plan is not one of {nest.file or 'the nest'}: {says}; give the nest that it was made from"
        raise InputError(text, file=nest.file or None)


def _said_of_others(plan: Plan, nest: Nest) -> Iterator[str]:
    """What a plan says of contours that neither the nest has nor the plan cuts, or left out."""
    known = {*nest.index, *(one.contour for one in plan.left_out), *(row.cut.contour for row in plan.cuts)}
    known |= {row.cut.way for _, row in plan.begun}  # a snake, or round in pieces, begins contours under its own name
    for what, names in _sayings(plan):
        for name in names:
            if name not in known:
                yield f"it says of {name!r}, which is no contour of it, {what}"


def _sayings(plan: Plan) -> Iterator[tuple[str, Iterable[str]]]:
    """What a plan says of contours beside their cuts, and of which."""
    for rule in plan.rules:
        for names, _ in rule.exceptions:
            yield f"that {rule.id} does not hold there", names
        for names, _ in rule.breaches:
            yield f"that {rule.id} is broken there", names
    for dropped in plan.dropped:
        yield f"that {dropped.rule} was dropped there", dropped.contours
    for place in () if plan.state is None else plan.state.places:
        yield f"that {place.rule} is {place.how} there", place.contours
    for rule_id, names, _, _ in () if plan.prices is None else plan.prices.breaches:
        yield f"what {rule_id} costs there", names
    for loss in plan.losses:
        yield "how much of its part is lost", (loss.contour, *loss.others)
    for name, rule_id in () if plan.zones_cost is None else plan.zones_cost.avoided:
        yield f"that zones break {rule_id} there", (name,)


def _named_otherwise(planned: PlannedCut, nest: Nest, number: int) -> str:
    contour = nest.contour(planned.cut.contour)
    if (planned.part, planned.kind) == (contour.part, contour.kind):
        return ""
    said, meant = (_kind_of(one.kind, one.part) for one in (planned, contour))
    return f"cut {number} has {contour.id} as {said}, and it is {meant}"


def _not_of(plan: Plan, nest: Nest, once: bool) -> Iterator[str]:
    cut_at: dict[str, int] = {}
    cuts = (*plan.already_cut, *plan.cuts)
    known = [one.cut for one in cuts if one.cut.contour in nest.index]
    entries = shapely.points(np.array([cut.entry for cut in known]).reshape(-1, 2))
    off_mm = shapely.distance(lines_of_contours([nest.contour(cut.contour) for cut in known]), entries)
    beside = iter((off_mm < OFF_MM - CHORD_MM).tolist())  # the others are measured from their lines and arcs
    for number, planned in enumerate(cuts, 1):
        name, (x, y) = planned.cut.contour, planned.cut.entry
        if name not in nest.index:
            if number > len(plan.already_cut):
                yield f"cut {number} is of {name!r}, which is no contour of it"
            continue
        contour, is_beside = nest.contour(name), next(beside)
        if once and name in cut_at:
            yield f"cut {number} is of {name}, as cut {cut_at[name]} is already"
        elif says := _named_otherwise(planned, nest, number):
            yield says
        elif not is_beside and (far_mm := contour.curve.project((x, y))[1]) > OFF_MM:
            yield f"cut {number} enters {name} at ({x:.1f}, {y:.1f}), {far_mm:.1f} mm off it"
        cut_at[name] = number
    for pierce in plan.pierces:
        if pierce.contour and pierce.contour not in nest.index:
            yield f"a hole is pierced for {pierce.contour!r}, which is no contour of it"
    yield from _said_of_others(plan, nest)


def _kind_of(kind: str, part: str) -> str:
    return f"{kind} of {part}" if part else kind
