"""How long a program takes under a profile's model of motion, on what, and what a sheet costs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Protocol

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.rules.profile.plant_sections import Prices
from kerfwise.rules.profile.values import ProfileValues

from .motion import Accelerated, ConstantFeed, Feeds, Motion

# T = L_on / V_on + L_off / V_off + N_pt · t_pt, run by run, whatever the model of motion (Tavaeva and Petunin).


@dataclass(frozen=True, slots=True)
class RunTimes:
    """When each run begins (its pierce included) and ends, and what the whole program spends on what; all in s.

    `total_s` includes the idle moves after the last run, and `dwell_s`, for which the torch waits for metal to cool.
    """

    spans: tuple[tuple[float, float], ...]
    cut_s: float
    idle_s: float
    pierce_s: float
    dwell_s: float = 0.0

    @property
    def total_s(self) -> float:
        """The whole program, s."""
        return self.cut_s + self.idle_s + self.pierce_s + self.dwell_s


def times_of(job: Job, motion: Motion, feeds: Feeds) -> RunTimes:
    """The times of a program; `feeds` say how long piercing, and starting to mark, takes.

    Examples
    --------
    >>> from kerfwise.encoder.geometry.curve import Curve
    >>> from kerfwise.models.physics.motion import ConstantFeed
    >>> from kerfwise.models.physics.time_and_cost import Run
    >>> feeds = Feeds(10, 10, 50, 0.5)
    >>> line = Curve.of([(30, 40), (130, 40)], closed=False)
    >>> times_of(Job((Run(line, travels_mm=(50.0,)),), (100.0,), 9), ConstantFeed(feeds), feeds)
    RunTimes(spans=((1.0, 11.5),), cut_s=10.0, idle_s=3.0, pierce_s=0.5, dwell_s=0.0)
    """
    now = cut_s = idle_s = pierce_s = 0.0
    spans = []
    for run in job.runs:
        travel_s = sum(map(motion.travel_s, run.travels_mm))
        wait_s = feeds.mark_start_s if run.marks else feeds.pierce_s if run.pierced else feeds.edge_s
        wait_s = 0.0 if run.linked else wait_s
        if run.standing_s is not None:
            wait_s = run.standing_s
        on_s = motion.run_s(run.path, run.marks, run.feed_share) if run.moving_s is None else run.moving_s
        begin_s = now + travel_s + run.wait_s
        spans.append((begin_s, begin_s + wait_s + on_s))
        now = spans[-1][1]
        cut_s, idle_s, pierce_s = cut_s + on_s, idle_s + travel_s, pierce_s + wait_s
    idle_s += sum(map(motion.travel_s, job.homing_mm))
    return RunTimes(tuple(spans), cut_s, idle_s, pierce_s, sum(run.wait_s for run in job.runs))


# What a clock is given: the torch-on paths of a program in order, and the idle moves between them.


@dataclass(frozen=True, eq=False, slots=True)
class Run:
    """One open torch-on path from where the torch is switched on to where it goes off.

    The torch waits for `wait_s` before it is lit. `travels_mm` are the lengths of the idle moves that lead to it.
    `marks` says that it only marks; `pierced` is False where it comes in from the sheet edge. `moving_s` is how long it
    takes at feeds of its own, and `standing_s` how long the torch stands meanwhile, lit, as a program states them; None
    where the model of motion, or the machine's feeds, say so. Then it moves at `feed_share` of its feed. A `linked` one
    goes on from the run before it, with the torch on. `unlit_mm` of the path are over tabs, where the torch moves on at
    its feed and burns nothing.
    """

    path: Curve
    marks: bool = False
    pierced: bool = True
    travels_mm: tuple[float, ...] = ()
    wait_s: float = 0.0
    moving_s: float | None = None
    standing_s: float | None = None
    feed_share: float = 1.0
    linked: bool = False
    unlit_mm: float = 0.0


@dataclass(frozen=True, eq=False, slots=True)
class Job:
    """The runs of a program, its last idle moves, and how many NC blocks it has."""

    runs: tuple[Run, ...]
    homing_mm: tuple[float, ...]
    nc_blocks: int

    @property
    def pierces(self) -> int:
        """Runs that pierce the sheet."""
        return sum(run.pierced and not run.marks and not run.linked for run in self.runs)

    @property
    def on_mm(self) -> float:
        """L_on: length with the torch, or the marking tool, on, mm."""
        return sum(run.path.length_mm - run.unlit_mm for run in self.runs)

    @property
    def idle_mm(self) -> float:
        """L_off: length of all idle moves, mm."""
        return sum(mm for run in self.runs for mm in run.travels_mm) + sum(self.homing_mm)


# What a plan says of its time: the model, the blocks counted, and what the seconds are spent on.


@dataclass(frozen=True, slots=True)
class TimeReport:
    """Seconds that a program cuts (and marks), moves idle, pierces, and waits for metal to cool, by the model named.

    `nc_blocks` is the number n of blocks of the program, comments left out.

    Examples
    --------
    >>> TimeReport("constant feed", 40, 90.0, 9.0, 1.0).idle_share
    0.09
    """

    model: str
    nc_blocks: int
    cut_s: float
    idle_s: float
    pierce_s: float
    dwell_s: float = 0.0

    @property
    def total_s(self) -> float:
        """The whole program, s."""
        return self.cut_s + self.idle_s + self.pierce_s + self.dwell_s

    @property
    def idle_share(self) -> float:
        """Idle travel's share of the total, 0…1."""
        return self.idle_s / self.total_s if self.total_s > 0 else 0.0

    def as_json(self) -> dict[str, Any]:
        """The report as `kerfwise time --json` prints it."""
        return {
            "cut_s": round(self.cut_s, 3),
            "idle_s": round(self.idle_s, 3),
            "pierce_s": round(self.pierce_s, 3),
            "total_s": round(self.total_s, 3),
            "idle_share": round(self.idle_share, 6),
            "nc_blocks": self.nc_blocks,
            **({"dwell_s": round(self.dwell_s, 3)} if self.dwell_s else {}),
            "model": self.model,
        }


def report_times(times: RunTimes, motion: Motion, nc_blocks: int) -> TimeReport:
    """What is said of these times."""
    return TimeReport(motion.words, nc_blocks, times.cut_s, times.idle_s, times.pierce_s, times.dwell_s)


# From a profile to its model of motion.


def machine_feeds(profile: ProfileValues) -> Feeds:
    """The machine's speeds and waits as the profile sets them."""
    machine = profile.machine
    return Feeds(
        machine.cut_feed_mm_s,
        machine.mark_feed_mm_s,
        machine.travel_mm_s,
        machine.pierce_time_s,
        machine.mark_time_s,
        machine.unpierced_s,
        profile.corner_feed(),
    )


def feeds_of(profile: ProfileValues) -> Feeds:
    """The speeds that plans are made with: none that the machine would pass, however short the program.

    What keeps a lag in seconds at these speeds keeps it at any that is lower, so it holds by every model of time.
    """
    feeds, time = machine_feeds(profile), profile.time
    if time.model != "blocks" or time.feed_by_blocks is None:
        return feeds
    return replace(feeds, cut_mm_s=max(feeds.cut_mm_s, time.feed_by_blocks.fastest_mm_s))


def motion_of(profile: ProfileValues, nc_blocks: int) -> Motion:
    """How the machine moves through a program of so many NC blocks, by the model that the profile names."""
    feeds, time = machine_feeds(profile), profile.time
    if time.model == "acceleration":
        return Accelerated(feeds, time.acceleration_mm_s2, time.corner_deviation_mm)
    if time.model == "blocks" and time.feed_by_blocks is not None:
        law = time.feed_by_blocks
        feed = law.mm_s(nc_blocks)
        words = f"feed by blocks, {law.name or 'own law'}, {feed * 60:.0f} mm/min at {nc_blocks}"
        return ConstantFeed(replace(feeds, cut_mm_s=feed), words)
    return ConstantFeed(feeds)


_HOUR_S = 3600.0


class Spent(Protocol):
    """Seconds that a program spends: `RunTimes`, or the `TimeReport` of a plan."""

    @property
    def cut_s(self) -> float:
        """With the torch on and moving."""
        ...

    @property
    def pierce_s(self) -> float:
        """Piercing."""
        ...

    @property
    def total_s(self) -> float:
        """The whole program."""
        ...


@dataclass(frozen=True, slots=True)
class Cost:
    """What one sheet of a nest costs, in `currency`: of each thing, and in all.

    `machine` is the machine's time, `sheet` the stock, and `remnant` what is saved of it: it counts against the rest.

    Examples
    --------
    >>> cost = Cost(machine=40.0, gas=6.0, sheet=70.0, remnant=10.0)
    >>> cost.total, str(cost)
    (106.0, '106.00 EUR: machine 40.00, gas 6.00, sheet 70.00, remnant -10.00')
    """

    machine: float = 0.0
    gas: float = 0.0
    power: float = 0.0
    consumables: float = 0.0
    sheet: float = 0.0
    remnant: float = 0.0
    currency: str = "EUR"

    @property
    def total(self) -> float:
        """All together, less the remnant."""
        return self.machine + self.gas + self.power + self.consumables + self.sheet - self.remnant

    @property
    def parts(self) -> Iterator[tuple[str, float]]:
        """What each thing costs, by name, where it costs anything; a remnant is negative."""
        signs = {"remnant": -1}
        amounts = ((f.name, getattr(self, f.name)) for f in fields(self) if f.name != "currency")
        return ((name, signs.get(name, 1) * amount) for name, amount in amounts if amount)

    def as_json(self) -> dict[str, Any]:
        """The cost as plans and `kerfwise time --json` have it."""
        amounts = {f.name: round(getattr(self, f.name), 4) for f in fields(self) if f.name != "currency"}
        return {**amounts, "total": round(self.total, 4), "currency": self.currency}

    @staticmethod
    def of_json(data: Mapping[str, Any]) -> Cost:
        """The same, read back; of plans of before, which knew fewer things that cost."""
        return Cost(**{f.name: data[f.name] for f in fields(Cost) if f.name in data})

    def __str__(self) -> str:
        text = ", ".join(f"{name} {amount:.2f}" for name, amount in self.parts)
        return f"{self.total:.2f} {self.currency}" + (f": {text}" if text else "")


def cost_of(
    spent: Spent, prices: Prices, pierces: int = 0, gas_m3_hour: float = 0.0, sheet: float = 0.0, remnant: float = 0.0
) -> Cost | None:
    """The cost of one sheet; None where the profile has no prices.

    Gas and the torch's power are paid while it is on, piercing included. Consumables wear by both: a set is worn out
    when its share of pierces and its share of hours add up to one.

    Parameters
    ----------
    spent
        Seconds of the program.
    prices
        The profile's.
    pierces
        How many the program makes.
    gas_m3_hour
        Gas that flows while the torch is on, m³/h.
    sheet, remnant
        What the sheet costs, and what is saved of it.

    Examples
    --------
    >>> from kerfwise.models.physics.time_and_cost import RunTimes
    >>> times = RunTimes((), cut_s=1700.0, idle_s=1800.0, pierce_s=100.0)
    >>> str(cost_of(times, Prices(80.0, 12.0)))
    '86.00 EUR: machine 80.00, gas 6.00'
    """
    if not prices.given:
        return None
    hours, on_hours = spent.total_s / _HOUR_S, (spent.cut_s + spent.pierce_s) / _HOUR_S
    worn = prices.consumables
    sets = (pierces / worn.pierces if worn.pierces else 0.0) + (
        on_hours / worn.torch_hours if worn.torch_hours else 0.0
    )
    return Cost(
        machine=hours * prices.machine_hour,
        gas=on_hours * (prices.gas_hour + gas_m3_hour * prices.gas_m3),
        power=prices.kwh * (on_hours * prices.torch_kw + hours * prices.standby_kw),
        consumables=sets * worn.set_price,
        sheet=sheet,
        remnant=remnant,
        currency=prices.currency,
    )
