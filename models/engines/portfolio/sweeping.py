"""The ideals in a run: sets are counted beforehand, and swept at once, or after a first look, or not at all."""

from __future__ import annotations

from kerfwise.models.engines import ideals, shares
from kerfwise.models.engines.ideals.series import series

from .preview import Preview
from .proof import take_proof
from .run import Run


class Sweeping:
    """`count` is how many sets there are, as far as there was a use for it."""

    def __init__(self, run: Run, preview: Preview) -> None:
        self._run, self._preview = run, preview
        self._tried = False
        self.count: ideals.Count | None = None

    def count_sets(self) -> None:
        """Count the sets that can occur, as far as there is a use for it."""
        run = self._run
        if run.options.member not in (None, "ideals"):
            return
        if why := ideals.unfit(run.of_sets):
            run.leave_out("ideals", why)
            return
        most = shares.COUNTED_FEW if run.problem.n <= shares.LONGEST else shares.COUNTED
        alone = run.options.member is not None and run.problem.n > shares.COUNTED_ALONE_CONTOURS
        most *= min(1.0, run.left() / (shares.COUNTED_ALONE_S if alone else shares.COUNTED_S))
        self.count = ideals.count_sets(run.of_sets, most, self._preview.counting)
        run.known.work += self.count.work

    def at_once(self) -> bool:
        """Whether all sets are swept before anything else; it is noted so."""
        run, count = self._run, self.count
        if count is None or not count.fits(run.most_bytes):
            return False
        longest_s = shares.AT_ONCE_S if self._few(count) else shares.AT_ONCE_MANY_S
        if not (run.options.member or count.seconds <= min(longest_s, shares.AT_ONCE * run.left())):
            return False
        run.known.notes.append(f"ideals: {'swept at once' if run.options.member is None else 'asked for'}, {count}")
        self._tried = True
        return True

    def fit(self) -> bool:
        """Whether a proof is worth its share; it is noted so."""
        run = self._run
        if self.count is None or self._tried:
            return False
        if not (run.options.member or self._sure() or self._few(self.count)):
            run.known.notes.append(f"ideals: left to the others, {self.count}")
            return False
        run.known.notes.append(f"ideals: {self.count}")
        return True

    def _few(self, count: ideals.Count) -> bool:
        """Whether stretches are so short that a bound may make the sets few."""
        longest = count.longest
        return longest <= shares.LONGEST or (longest <= shares.LONGEST_ZONE and longest <= self._run.problem.n / 2)

    def _sure(self) -> bool:
        """Whether a sweep over all sets fits well into what is left."""
        count, most_s = self.count, shares.SURE * self._run.left()
        return count is not None and count.fits(self._run.most_bytes) and count.seconds <= most_s

    def prove(self) -> None:
        """The ideals, with their share; walks take no more of a larger one."""
        run, member = self._run, self._run.options.member
        small, zones = run.problem.n <= shares.LONGEST, len(series(run.of_sets)) > 1
        if member or small or not (zones and ideals.priceable(run.of_sets)):
            share = 1.0 if member else shares.PROOF_SMALL if small else shares.PROOF
            self.sweep(run.left() * share)
            return
        part = shares.PROOF / shares.PROOF_ZONES
        self.sweep(run.left() * shares.PROOF_ZONES, tuple(part * stage for stage in ideals.STAGES))

    def sweep(self, share: float, stages: tuple[float, ...] = ideals.STAGES) -> None:
        """A proof by sweeps, bounds of walks in so many stages."""
        run, known, before = self._run, self._run.known, self._run.known.work
        stages = stages[:1] if self._sure() else stages
        going = run.within(max(share, run.left()))
        proof = ideals.prove(
            run.of_sets, known.incumbent, share, going, stages, run.limit_s(share), run.most_bytes, known.priced
        )
        known.work = before + (share if proof is None else proof.work)
        known.priced = known.priced if proof is None else proof.priced
        take_proof(run, proof)


def sweep_priced(run: Run, share: float) -> None:
    """The ideals with multipliers of the flow: few sets are left near a good bound."""
    plan = run.known.incumbent
    if plan is None:
        return
    proof = ideals.prove_priced(run.problem, plan, share, run.within(share), run.limit_s(share), run.most_bytes)
    run.known.work += share if proof is None else proof.work
    take_proof(run, proof)
