"""Rule t-max."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kerfwise.encoder.cut import CutSequence, HotSpot
from kerfwise.encoder.nest import Nest
from kerfwise.rules.options.kind import Flag
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import DURATION, TEMPERATURE, OrWord, likely
from kerfwise.rules.rule import Plant, Rule, RuleSetting, TemperatureLimit, Violation
from kerfwise.rules.statements import Statement

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


@dataclass(frozen=True, slots=True)
class TMaxOptions:
    """How hot metal may become, and whether the torch may wait for it to cool; `heat_limit_c` is `heat.limit_c`."""

    limit_c: float | None = setting(
        None, OrWord(likely(TEMPERATURE, -50.0, 3000.0), "auto"), "no metal becomes hotter (auto: `heat.limit_c`)"
    )
    dwells: bool = setting(False, Flag(), "whether the torch may wait over a pierce for metal to cool")
    longest_dwell_s: float = setting(60.0, likely(DURATION, 0.0, 3600.0), "longest such wait")
    heat_limit_c: float = 115.0

    @property
    def most_c(self) -> float:
        """The limit, °C."""
        return self.heat_limit_c if self.limit_c is None else self.limit_c


class TMax(Rule[TMaxOptions]):
    """No metal outside the kerf's band becomes hotter than a limit.

    ## What it does

    The sheet is simulated as `kerfwise heat` does, always with the physical model and the data of the section `heat`;
    no point of a part or of the skeleton that lies outside the kerf's band may become hotter than `limit`. An order
    that fails is planned again: what heated the place should come earlier or later, at a price for each second that is
    missing, a few times over. With `dwells: true` the torch may also wait before a pierce, off, up to `longest_dwell`:
    of the orders tried, the one is taken whose program is done first. Waits stand in the plan (`dwell_s`) and in the
    program (`G4` before the torch is lit), and count in its time; the objective does not see them. Where neither helps
    there is no plan, and the answer says how hot the coolest one got, and which waits would do. The check simulates the
    program as its own reader understands it.

    ## Links, tabs and other cuts

    - **Links**: With `dwells: true` no part is linked with the next: the torch waits while it is off. Without, the
      simulation burns the links of the program.
    - **Tabs**: The check has the torch burn through the tab, so that it errs on the safe side.
    - **Common cuts**: Each shared edge is heated once, by the cut that burns it.
    - **Scrap lines**: They are simulated as all cuts are.

    ## Why

    Verkhoturov et al. call a place that passes t_max overheated: metal that is held fast yields by its own expansion
    there, and the part is bent when it is cold.

    ## Wrong

    Two narrow parts side by side, cut one right after the other: the web between them has no time to cool.

    ## Right

    The same parts with a wait, or with another part far away, between them.
    """

    id = "t-max"
    sentence = "No metal outside the kerf's band becomes hotter than a limit."
    source = "Verkhoturov et al."
    Options = TMaxOptions
    takes_no_file = "temperatures are simulated, not stated"
    strengths = ("hard", "off")
    default = "off"

    def statements(self, facts: Facts, options: TMaxOptions) -> Sequence[Statement]:
        return ()

    def temperature_limit(self, options: TMaxOptions) -> TemperatureLimit:
        return TemperatureLimit(self.id, options.most_c, options.dwells, options.longest_dwell_s)

    def check_with(
        self, options: TMaxOptions, plant: Plant, rules: Mapping[str, RuleSetting]
    ) -> Iterator[tuple[str, str]]:
        if options.limit_c is not None and options.limit_c <= plant.ambient_c:
            is_at = f"{options.limit_c:g} °C is not above heat.ambient_c, {plant.ambient_c:g} °C"
            yield "limit", f"{is_at}: no metal is ever so cool"

    def unjudged(self, nest: Nest, cuts: CutSequence, options: TMaxOptions) -> str | None:
        known = cuts.hot_spots is not None or not cuts
        return None if known else "the temperatures of these cuts have not been simulated"

    def violations(self, nest: Nest, cuts: CutSequence, options: TMaxOptions) -> list[Violation]:
        found = []
        for spot in cuts.hot_spots or ():
            k = cuts.made + sum(cut.start_s <= spot.at_s for cut in cuts.new)
            if k > cuts.made and spot.peak_c > options.most_c:
                contour, most = cuts[k - 1].contour, f"{options.most_c:g} °C at the most"
                text = f"{contour} (cut {k}) makes {_where(spot)} {spot.peak_c:.1f} °C hot, not {most}"
                found.append(Violation(self.id, (contour,), text, (k,)))
        return found


def _where(spot: HotSpot) -> str:
    x, y = spot.at
    return f"the metal at ({x:.0f}, {y:.0f}), {'on part ' + spot.part if spot.part else 'between parts'},"
