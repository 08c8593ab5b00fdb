"""When to anneal how long: several times, each as long as all before, and hotter or cooler by turns."""

from __future__ import annotations

from dataclasses import dataclass

SHORT = 50_000  # operations for a single annealing, times n^1.5: with less there is no time for several
HEATS = (2.0, 4.0, 1.0)
COOL = 2  # where to begin in them if time is short: less is lost by not going uphill
ANNEALED = 0.5  # share for annealings that begin anew, where what they find is then bred from
SHORTEST = 1_000_000  # operations for an annealing, times n^1.5: what one contour asks for grows with their number


@dataclass(frozen=True, slots=True)
class CoolingPart:
    """A part of one annealing: from which share of its cooling to which, and a number for its heat."""

    done: float
    ahead: float
    turn: int

    def annealing(self, count: int) -> tuple[int, CoolingPart] | None:
        """Which of `count` equal annealings it is in, and the part of that; None if it begins after them.

        Examples
        --------
        >>> CoolingPart(0.375, 0.5, 0).annealing(2)
        (1, CoolingPart(done=0.5, ahead=1.0, turn=1))
        """
        done, ahead = count * self.done / ANNEALED, count * self.ahead / ANNEALED
        number = int(done)
        if number >= count:
            return None
        return number, CoolingPart(done - number, min(1.0, ahead - number), self.turn + number)

    def heat(self, walker: int) -> float:
        """Factor on the temperatures; walkers differ."""
        return HEATS[(self.turn + walker) % len(HEATS)]


@dataclass(frozen=True, slots=True)
class Schedule:
    """`stages` annealings; the last takes half of all, the one before it a quarter, the first two the same.

    `turn` is the number for the heat of the last one. `short` says that there is time for one at the most.

    Examples
    --------
    >>> Schedule(3, 0).part(0.25, 0.375)
    CoolingPart(done=0.0, ahead=0.5, turn=1)
    """

    stages: int
    turn: int
    short: bool = False

    @classmethod
    def of(cls, n: int, operations: int) -> Schedule:
        """As many as there is time for, for n contours."""
        stages = int(operations / (SHORTEST * n**1.5)).bit_length()
        return cls(max(1, stages), 0 if stages else COOL, operations < SHORT * n**1.5)

    def part(self, done: float, ahead: float) -> CoolingPart:
        """What to do between two shares of the whole."""
        bounds = [0.0, *(2.0**-k for k in range(self.stages - 1, -1, -1))]
        stage = sum(done >= bound for bound in bounds[1:])
        start, stop = bounds[stage], bounds[stage + 1]
        whole, turn = stop - start, self.turn + self.stages - 1 - stage
        return CoolingPart((done - start) / whole, min(1.0, (ahead - start) / whole), turn)
