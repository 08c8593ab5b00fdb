"""A plant's profile: its machine, its material, and what it asks of every plan. Frozen; speeds in mm/s, times in s."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import cast

from kerfwise.encoder.candidates.candidate import CommonOptions, LeadOptions
from kerfwise.encoder.candidates.snake import SnakeOptions
from kerfwise.encoder.candidates.stretches import SplitOptions
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import FactOptions
from kerfwise.encoder.narrow_features import Narrow
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import NARROW, SHARED_EDGES, SMALL_HOLES
from kerfwise.encoder.readers.layers import PURPOSES, Layers
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.rules.own import own_pairs

from .technique import Technique

NARROW_ANSWERS = ("slit", "leave", "refuse")
SMALL_HOLE_ANSWERS = ("skip", "spot", "cut", "refuse")
SHARED_EDGE_ANSWERS = ("once", "pierced", "refuse")
"""What may be answered to the questions of `encoder/candidates/lead_errors.py`."""
SHORTEST_SHARED_MM = 1.0
"""Edges that parts share are cut once, as answered, where one of them is as long as this."""


@dataclass(frozen=True)
class Profile(Technique):
    """Everything a plant fixes beforehand.

    `further_rules` are those beside the catalogue that `rules` has settings of: of installed packages, which are off
    unless a profile says otherwise, and of the files that it names.

    `sha256` is that of the profile's file and of all files that it is made of: those it is based on, its chart, its
    dialect's, and those of its rules; `read_from` are the places of that file and of those it is based on. `chart` says
    what of it is from a material chart, and `said_at` where each key stands, by such as `machine.home` and
    `rules.pierce`. `for_one_nest` says what a job file, or the command line, has in the place of the plant's own. These
    and `file` do not make two profiles differ.

    Examples
    --------
    >>> from kerfwise import load_profile
    >>> profile = load_profile("plasma-carbon-steel")
    >>> profile.material.kerf_mm, profile.rules["level-ahead"].strength
    (1.5, 'hard')
    """

    def lead_options(self, nest: Nest | None = None) -> LeadOptions:
        """How candidates are made: `leads`, the kerf, and what the rules and the locks say.

        Given a nest, they keep to what the machine reaches of it.
        """
        return replace(
            self._asked_of_leads(),
            reach=None if nest is None else self.reach_on(nest),
            entry_points={lock.contour: lock.entry for lock in self.locks if lock.contour and lock.entry},
            holes=self.hole_limits(),
            narrow=self.cuts.narrow,
            corner_mm=self.corners.leave_mm,
            common=self.common_options(),
        )

    def snake_options(self) -> SnakeOptions | None:
        """Which rows of neighbours are cut as snakes; None where none are."""
        snake = self.cuts.snake
        if snake.gap_mm is None:
            return None
        return SnakeOptions(snake.gap_mm, snake.parts, self.shared_edges, may_share=self._may_share, rows=snake.rows)

    def split_options(self) -> SplitOptions:
        """Which rounds are cut in two stretches."""
        split = self.cuts.split
        shared = self.shared_edges if split.shared_last and self._may_share else None
        return SplitOptions(split.halves, split.last_mm, shared)

    @property
    def shared_edges(self) -> CommonOptions:
        """Which edges two parts share that are cut along stretches."""
        return CommonOptions(0.0, self.cuts.common.gap_tolerance_mm, self.machine.kerf_start)

    @property
    def _may_share(self) -> bool:
        """Whether two parts may share an edge: one direction for all gives one of them the bad side of the kerf."""
        return not self.rules_of_direction("outer") or self.cuts.common.good_side != "part"

    def as_answered(self) -> Profile:
        """The profile with what `drawing.answers` says of slots narrower than the kerf, small holes and shared edges.

        Raises InputError for an answer that is none of the choices.
        """
        answers = dict(self.drawing.answers)
        cuts, holes, machine = self.cuts, self.small_holes, self.machine
        all_choices = {
            NARROW: NARROW_ANSWERS, SMALL_HOLES: SMALL_HOLE_ANSWERS, SHARED_EDGES: SHARED_EDGE_ANSWERS
        }  # fmt: skip
        for question, choices in all_choices.items():
            if (answer := answers.get(question, choices[0])) not in choices:
                raise InputError(
                    f"the answer {question}={answer} is none of the choices: expected {', '.join(choices)}"
                )
        if NARROW in answers:
            cuts = replace(cuts, narrow=cast(Narrow, answers[NARROW]))
        match answers.get(SMALL_HOLES):
            case "cut":
                holes = replace(holes, min_hole=self.material.kerf_mm, under="skip")
            case "refuse" | "skip" | "spot" as under:
                holes = replace(holes, under=under)
        if (shared := answers.get(SHARED_EDGES, "refuse")) != "refuse":
            shortest_mm = self.cuts.common.shortest_mm or SHORTEST_SHARED_MM
            common = replace(cuts.common, shortest_mm=shortest_mm, accept_loss=True, good_side="any")
            cuts = replace(cuts, common=common)
            machine = replace(machine, kerf_start=machine.kerf_start and shared != "pierced")
        return replace(self, cuts=cuts, small_holes=holes, machine=machine)

    def common_options(self) -> CommonOptions | None:
        """Which edges two parts have in common; None where none are to be cut once.

        Where hard rules have parts in the concavity of another cut before that one, so do orders of common cuts.
        """
        common = super().common_options()
        return None if common is None else replace(common, mouths_first="in_hull" in self.fact_options().zone_respects)

    def fact_options(self, nest: Nest | None = None) -> FactOptions:
        """The thresholds of the facts, as the rules and the locks say.

        Given a nest, zones keep to the orders of the plant's own hard rules too.
        """
        own = own_pairs(self.own_rules, nest, self._thresholds()) if nest is not None else ()
        own += self._pairs_in_files(nest) if nest is not None else ()
        given = FactOptions(
            zone_respects=frozenset({"contains"}),
            zone_pairs=(*((lock.contour, lock.before) for lock in self.locks if lock.contour and lock.before), *own),
            zone_places=self._zone_places(nest),
            zone_fixed=tuple((lock.part, lock.zone) for lock in self.locks if lock.part and lock.zone),
            kerf_mm=self.material.kerf_mm,
            splash_mm=None,
            pierce_pass=self.cuts.pierce_pass,
        )
        for rule, options, strength in self._every_rule:
            given = rule.fact_options(given, options, strength)
        return given

    def _pairs_in_files(self, nest: Nest) -> tuple[tuple[str, str], ...]:
        """Orders that hard rules in model files state of the nest alone, so that no zone contradicts them."""
        on = self.settings()
        hard = [rule for rule in self.model_rules() if on[rule.id].strength == "hard" and not rule.gives_way]
        return tuple(pair for rule in hard for pair in rule.pairs_of_nest(nest, on[rule.id].options))

    def _zone_places(self, nest: Nest | None) -> tuple[tuple[str, int], ...]:
        """Part → the position that a lock gives one of its contours: its zone must reach there."""
        if nest is None:
            return ()
        found: dict[str, int] = {}
        ends = {"first": 1, "last": len(nest.contours)}
        for lock in self.locks:
            if lock.contour in nest.without_scrap.index and lock.position is not None:
                at = lock.position if isinstance(lock.position, int) else ends[lock.position]
                found.setdefault(nest.contour(lock.contour).part, at)
        return tuple(found.items())

    def read_options(self) -> ReadOptions:
        """How nest files are read."""
        drawing = self.drawing
        return ReadOptions(
            units=drawing.units,
            units_by_profile=drawing.units is not None,
            layers=Layers(**{name: getattr(drawing.layers, name) for name in PURPOSES}),
            colours=(*drawing.layers.colour, *((key, "cut") for key, _ in drawing.layers.bevel)),
            linetypes=drawing.layers.linetype,
            answers=drawing.answers,
            quantity=drawing.quantity,
            kerf_mm=self.material.kerf_mm,
            spot_mm=self.small_holes.spot_size_mm,
            frame=drawing.frame,
            open_lines=drawing.open_lines,
            scrap_lines=drawing.scrap_lines,
            margin_mm=drawing.margin_mm,
            join_tolerance_mm=drawing.join_tolerance_mm,
            refit_arcs_mm=drawing.refit_arcs_mm,
            bevels=drawing.layers.bevel,
        )
