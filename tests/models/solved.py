"""Small nests solved exactly, without the search, or by it alone: `from kerfwise.tests.models.solved import …`."""

from __future__ import annotations

from kerfwise import Nest, Plan, Profile
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.jobs.request import facts_of
from kerfwise.models.engines.deadline import Deadline, Progress
from kerfwise.models.engines.ideals import prove
from kerfwise.models.engines.search import Searcher
from kerfwise.models.engines.solution import Incumbent, Solution, SolveOptions
from kerfwise.models.plan.explain.context import solved_context
from kerfwise.models.plan.explain.reasons import with_reasons
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.problem import Problem
from kerfwise.rule_kit import Facts, NoOptions, RuleSetting
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.stating.state_rules import Stated, state_rules

QUIET = ("heat-lag", "part-rigidity", "no-islands", "no-narrow-strips", "no-tip-travel")


def plant(*locks: object, off: tuple[str, ...] = QUIET) -> Profile:
    """The default profile with these locks, and without the rules that look at heat and stiffness."""
    given = load_profile()
    rules = dict(given.rules)
    for name in off:
        rules[name] = RuleSetting("off", None, rules[name].options if name in rules else NoOptions())
    return Profile(
        "plant", given.machine, given.material, given.leads, given.drawing, rules, given.objective, locks, sha256="aa"
    )


def proven_plan(nest: Nest, profile: Profile, stated: Stated | None = None) -> tuple[Facts, Stated, Plan]:
    """The best plan of a small nest; `stated` where it is not what the profile states."""
    facts = facts_of(nest, profile)
    stated = stated or state_rules(facts, profile)
    problem = make_problem(facts, stated.statements, profile.machine.home)
    proof = prove(problem, None, Deadline(10))
    assert proof is not None
    assert proof.incumbent is not None
    route = tuple(int(problem.site_candidate[s]) for s in proof.incumbent.route)
    mm = proof.incumbent.cost / UM_PER_MM
    solution = Solution(route, mm, mm, "optimal", "ideals", "ideals", 0.0)
    plan = make_plan(facts, profile, stated, solution, "portfolio", 1)
    return facts, stated, with_reasons(plan, solved_context(facts, profile, stated, solution))


CYCLES = (0.05, 0.2, 0.75)


def searched(problem: Problem, options: SolveOptions, progress: Progress | None = None) -> Incumbent | None:
    """The best lawful route that the search alone finds within the limits, by annealings of these shares of them."""
    searcher = Searcher(problem, options.seed)
    for part in CYCLES:
        time_s = None if options.time_s is None else options.time_s * part
        if not searcher.run(Deadline(options.work * part, time_s, progress)) and time_s is None:
            break
    return searcher.best
