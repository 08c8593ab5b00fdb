"""Every number that engines go by, and jobs that share out work and time: each with its unit and its reason.

`python -m kerfwise.benchmarks.tuning` makes one after the other half as large and half as large again, solves the same
problems, and prints what that costs: docs/tuning.md. What marks a place in a table, stands for "none", or keeps sums
exact, stays where it is used. Names that end in `_S` are seconds of work, `_PER_S` what a second of work stands for.
"""

# baselines.py

ATTEMPTS = 200  # random walks, after which there is no lawful order to be had
WARM_SHARE = 0.25
"""A contour is cool enough while the metal along it is warmer than the air by less than this share of the limit's."""

# bounds/completion.py

COMPLETION_ADDITIONS_PER_S = 6e8  # by one core
COMPLETION_MOST_NEIGHBOURS = 7  # contours that a walk remembers: each doubles the tables, and shortens fewer cycles
MOST_NUMBERS = 60_000_000  # Of all tables together.
COMPLETION_SHARE = 0.3  # Share of the bytes given that the tables may take; a sweep with its own follows.
BYTES_A_NUMBER = 8  # Of tables of walks, here and by stretches.
COMPLETION_PATIENCE = 8  # Rounds without a better bound after which the steps become shorter.
COMPLETION_SHORTEST = 0.002  # Steps below which no more rounds are worth it.
WORTH_SHARING = 2e5  # Additions at a place from which on other threads are worth waking.
INERTIA = 0.4  # How much of the last direction is in the next (Camerini, Fratta and Maffioli 1975).

# bounds/flow.py

FLOW_LEAST_GAIN = 3e-4  # Share of the bound that the last few rounds must bring.
FLOW_PATIENCE = 20  # rounds of cuts that must bring that much together
LOOSE = 0.004  # Share of what the program costs, by which the bound may lag behind before the program is cut again.
CROWD = 3  # Inequalities per contour, beyond which those are dropped that nothing is paid for.
RISEN = 1e-5
"""Share by which the bound has risen before inequalities are dropped again: else the same ones come back in turn."""
BYTES_A_MOVE = 18.0  # What is kept of every move, and needed while they are gone through.
FLOW_STEP = 0.4  # How far it goes from where it was towards the cheapest flow each time.
FLOW_LITTLE = 1e-3  # Less than so much along a move is none of it.
FLOW_LEAST = 0.02  # What the cheapest flow must be missing of an inequality.

# bounds/flow.py

PROGRAM_AT_ONCE_S, PROGRAM_AT_ONCE = 1.0, 0.2
"""Deterministic seconds from one question whether there is time left to the next; and share of the work that is left,
where that is more, as a program that is broken off often takes longer."""
PROGRAM_FEW = 1000  # Rounds of the simplex method that there is always time for.
MANY_MOVES, MOVES_KEPT = 8, 0.625  # Moves for every site, beyond which the dearest are dropped; share that stays.
DEAR_UM = 1.0  # A move that is no dearer than this is not dropped.

# What a bound by flows takes: solution.py

FLOWS_MOST_SITES, FLOWS_MOST_CONTOURS = 9000, 1500
"""With more sites contours stand for all of theirs; with more contours there is no bound (it takes too long)."""
SETTING_OUT = 0.75
"""Share of the work that may go before the first bound; where it takes more, contours stand for all of their sites."""
FLOWS_ROWS_PER_S = 1e7
"""Rows times rounds of the simplex method that a second is counted for, where there are half as many cuts as contours
or more."""
PRIMAL = 0.4  # Share of that which a round of the primal simplex method takes.
FREE = 0.2  # Share of either which a round takes without cuts.
LOOKED_PER_S = 4e7  # Moves that a look at all goes through.
MADE_PER_S = 1e7  # Moves whose costs are worked out, and that are gone through for the first ones.

# bounds/excuses.py

EXCUSES_MOST_ROWS, EXCUSES_ROWS_PER_S = 1_000_000, 3e5
"""Clauses of a model of sets at the most, and how many are made in a second."""

# bounds/move_costs.py

MOVE_ROWS = 128  # Sites whose moves are worked out, and gone through, at once.
MOST_INNER = 6  # Contours before the last one of a block, at the most: all their sets are gone through.

# bounds/network.py

MOST_SPLIT = 2  # Conditions of a site that are paid for by a site of their own, at the most.
NETWORK_NEAREST = 3  # Moves from and to every site that are looked at from the start.
MORE, MORE_EACH = 8000, 30
"""Moves that are added at once at the most, or so many for every contour, where those are more."""
ENOUGH_OF_PLAN = 1e-6
"""A move that would make the program cheaper by no more than this share of the plan, or `DEAR_UM`, is not missing."""

# bounds/reduced_costs.py

REDUCED_MOST_SITES = 2000  # Of a network: with more its program takes too long.
REDUCED_PATIENCE, REDUCED_LEAST_GAIN = 8, 1e-3
"""Rounds of cuts that must bring this share of the bound: what is left then sweeps find out in less time."""

# bounds/separation.py

SEPARATION_MUCH = 0.2  # What may be missing of a flow where there are cuts by more.
SEPARATION_MOST, PLENTY = 250, 2
"""Inequalities in a round at the most, unless there are more contours; and how many times as many are looked for."""
REST = 3
"""Rounds for which ways that nothing is missing of are looked at no more, unless nothing is missing of any other."""
SEPARATION_LOOKS = 64  # Ways from one look at whether to go on to the next.
MOVES_PER_S, SEPARATION_BESIDE = 1.5e7, 800
"""Moves of a flow that a second is counted for, every time that it is looked through; so many take as long as all else
with a way."""
SEPARATION_LITTLE = 0.05  # What may be missing of a flow without a cut.

# cpsat/model.py

MODEL_MOST_CONTOURS = 3_000  # With more the model takes too long to be made.
POLL_S = 0.1  # between two looks, by the clock, at whether CP-SAT, or MiniZinc, is to go on

# cpsat/variables.py

VARIABLES_LOOKS = 1000  # Pairs of contours from one question whether to go on to the next.

# first_plan.py

EARLY_LONG = 12  # Contours that a hard sum is about, at the least: what shorter ones ask the search finds by itself.

# ideals/stretches/priced_stretches.py

BACKWARD_FIRST, BACKWARD_WIDER, SPREAD = 0.002, 2, 0.006
"""Shares of what a known plan costs: how much more than the least a way in may cost that is settled first, how many
times as much next, and how much more than the best at last, as others take its place where the stretch before pays."""
BACKWARD_DEARER, BACKWARD_LITTLE = 3.0, 0.15
"""How many times as much work a sweep takes, about, that goes twice as far as the last, and what share of what is left
one may take that settles ways in which cost still more."""
BACKWARD_MOST_NEIGHBOURS = 3  # What a walk remembers at the most.

# ideals/by_arrays.py

SWEPT_AT_ONCE = 1 << 18  # Additions of whole arrays that are done together: what they take fits in a cache.

# ideals/lattice.py

A_SHARE = 3e7  # Additions that a thread does at a time, at the least.
STEPS_AN_ENTRY = 20  # Turns of inner loops that an entry takes beside its additions.
LATTICE_LOOKS = 16  # Times a layer is looked up from, at the most.
WORTH_CLEARING = 0.8  # A layer of which no more than this share of the entries lives is stored without the others.
BYTES_A_NEW_ENTRY, BYTES_A_NEW_SET = 38, 44
"""What an entry, and a set, take on top while their layer is being made; sets of one word, 16 more for each other."""
NEW_SETS_PER_SET = 4  # How many new sets a set leads to at the most, where there are many.

# ideals/priced.py

WALKS = 0.05  # Share of the work that bounds by walks may take.
SEVERAL = 3.0  # A sweep backwards may take as many times its even share of what is left, as most need little.

# ideals/stretches/priced_stretches.py

ROOM = 0.0005  # By what share of a plan the next limit is higher where a stretch has no way up to what it promised.
UNSURE = 0.01  # By what share of a plan an end must be better from which plans may cost more than is known.

# ideals/prove.py

STAGES = (0.03, 0.1, 0.4)
"""Shares of the work, or the time, for the bound by walks: a quick one first, as a sweep often is short even so."""
PRICED_WIDER = 2.5
"""How many times as much over the bound the next limit is by these, of one stretch: what sweeps take rises slowly."""
PROVE_PRICED, PRICED_ALONE, BACKWARD = 0.4, 0.5, 0.45
"""Share of the work that is left for linear programs of the stretches, where walks do not suffice; and where nothing
but these is tried; and share for sweeps of single stretches backwards, where there are several."""
OVERDRAWN_S = 0.5
"""Seconds of work by which bounds by walks may take more than what is left, where linear programs come next, or have
been solved: one round of each stretch at the least, which takes long where stretches are large."""
AS_GOOD_AS_IT_GETS = 0.8  # A bound that took no more than this of its share will not become better with more.
MOST_SITES_PRICED = 1000  # Sites of a stretch: its linear program takes too long with more.
LARGE_NEST = 2500
"""Contours beyond which a proof by zones is all there is time for: no linear programs of stretches are made (at 10,000
they take 0.7 GB), a sweep alone counts its sets for longer, and a plan without zones has what the proofs leave."""
PROVE_MOST_SITES, MOST_SITES_BOUND = 4000, 1500
"""Sites of a stretch: with more the table of moves is too large; sites altogether: the bound takes too long."""
FIRST_WIDTH, PROVE_WIDENED = 256, 2
"""States of a layer that the first sweep keeps, and how many times as many the next."""
BOUND = 0.15  # Share of the work that a bound by walks may take.

# ideals/sets.py

SLOTS_AT_FIRST = 1 << 12  # of the table that sets are looked up in; it doubles when it is half full
STEPS_A_WORD, STEPS_A_SET = 20, 30
"""Turns of inner loops that it takes to count what may follow a set, and to find a set that follows."""
SETS_ADDITIONS_PER_S = 1.2e10  # of the sweep, by vectors and all cores
ADDITIONS_AN_ENTRY, ADDITIONS_A_STATE = 1200, 100
"""Additions that it takes as long as to find, sort and look at an entry (a set and the contour cut last), and as to
store a state of it (its last site)."""
COUNTED_FASTER = 3  # How many times faster an entry is counted.
BYTES_AN_ENTRY, BYTES_A_STATE = 10, 4  # What is kept of every layer, for the way back.
SHARE_KEPT = 0.7
"""Of the bytes that a sweep may take, the share for layers that are made; the rest is for that which is being made."""

# ideals/stretches/stretch_bounds.py

STRETCH_MOST_NEIGHBOURS, STRETCH_SHARE = 6, 0.25
"""What a walk remembers at the most, and the share of the bytes given that the tables of all stretches may take."""
SHARES = 0.25, 0.5, 0.75, 1.0
"""Shares of what a known plan misses in a stretch, within which the cheapest way through it is looked for."""
STRETCH_NEAR, STRETCH_WIDER, FAR_OVER = 0.005, 1.6, 0.1
"""By what share of the bound a plan may be dearer that is looked for first, how many times as much next (`wider`, where
that is given), and from what share on limits rise by what sweeps take."""
STRETCH_DEARER, STRETCH_LITTLE = 4.0, 0.002
"""How many times as much work as the last one the next sweep may take where limits are far; less than that share of
what is left says nothing of the next."""
SOON, STRETCH_FIRST, TWICE, ENDS = 0.0005, 0.002, 2.0, 0.8
"""By what shares of the bound a plan may be dearer that is looked for first where every sweep is to come to its end,
how many times as much next, and what share of the work that is left a sweep may take."""
ONE_GO, LEAST_STEP = 1.5, 0.1
"""How many steps it may be to the known plan for the next sweep to go that far, and the least step, as a share of what
was gone so far."""
PIECE = 1 << 23  # Numbers in a piece, 64 MB: a piece is far larger than what an allocator keeps for later.

# minizinc_engine.py

NODES_PER_S = 100_000  # Search nodes that count as a second of deterministic work.
MOST_MOVES = 1_000_000
"""Moves between the ways to cut that a model is written for; tables of them grow with every part besides."""

# search/anneal.py

HOT, ANNEAL_COLD = 1.0, 0.01  # temperatures, in typical rises of the cost
LIVELY = 0.01  # share of exchanges taken at the first temperature, on plain problems
ANNEAL_FALL = 25.0  # by what the temperature falls there, as a factor
LOOK = 200_000  # operations for a look at how many are taken
ANNEAL_LOOKS = 40  # at the most, to find that temperature
ANNEAL_STEP = 1.4  # between the temperatures looked at
EXCHANGES = 4  # work on exchanges for one of ruins, where they are quick
ANNEAL_MOST = 12  # contours taken out at once
RUINS, FEW_RUINS, ANNEAL_LONG = 0.1, 0.03, 300
"""share of ruins among the moves, the rest are swaps: fewer on long routes"""
FORCED = 0.3  # share of ruins in which a site is forced, where that makes sense
ANNEAL_MUCH = 0.4  # chance of overlooking a place where a trial is to differ
JUDGE = 128  # trials between two looks at how many of them were lawful

# search/state/conditions.py

STEPS = 8  # a hard lag that is kept for no time at all counts as so many broken statements, besides one for itself

# search/moves/exchanges.py

PER_TRIAL = 13  # operations for an exchange that is tried

# search/moves/lin_kernighan.py

CHAIN_NEAR, CHAIN_BESIDE = 0.5, 8.0
"""What the first temperature is, in reduced costs of near arcs, and of the arcs of the first good route: orders make
those dear."""
CHAIN_FALL = 30.0  # By what the temperature falls, as a factor.
STILL = 1e-6  # A temperature at which nothing goes uphill.
CHAIN_SHORT = 8  # Length of stretches that are moved by steps whose second new arc need not be a near one.
PER_ARC, PER_SWAP = 5, 20  # Operations for looking at an arc, and for a swap, beside those for each place.
PER_CONTOUR = 10  # Operations for taking a contour out of the queue.
KICKS = 2  # Random steps of a kick.
WIDTH = 8  # Nearest arcs that a kick draws from.
CHAIN_LONGEST = 16  # Length of stretches that a kick moves, where but one of its arcs is a near one.
CHAIN_DRAWS = 100  # Draws of a kick after which there is none.
PER_KICK = 50  # Operations for a kick, beside its swaps.

# search/moves/lin_kernighan_tables.py

CHAINS_NEAREST = 10  # Arcs out of every contour that steps make.
SPARSE, FEWEST, CHAINS_MOST = 0.5, 60, 3000
"""Chains are tried where orders decide less than this share of the pairs of contours, and for so many contours."""
DETOURS, SAMPLE = 0.1, 60
"""Share of arcs and contours that there is a cheaper way by, from which on costs are not taken for distances, and of
how many contours it is counted. Where they are distances, annealing does as well or better."""
TYPICAL = 5  # Nearest arcs by whose cost temperatures are chosen.
BREADTH = (5, 3, 1, 1, 1, 1)  # Steps that are tried at each place of a chain; it is as long as this list at the most.

# search/state/route_state.py

ROUTE_STATE_NEAR = 16  # neighbours of a contour that moves look at

# search/searcher.py

WORK_PER_S = 450_000_000  # elementary operations that a second of work stands for
CHUNK = 20_000_000  # operations between two looks at the clock and at whether to stop, of regions, too
WALKERS = 2  # a thread each: as many as a usual machine has at the least
SEARCHER_FIRST = 0.25  # share of the first run that may go into the descent from the first route, and
FIRST_DESCENT = 200_000  # the most operations a contour
REGIONS = 100_000_000  # operations in each half of a route between two such looks, where it goes by regions
WHOLE = 0.5  # share for an annealing of the whole route, where the rest can go region by region, and
WHOLE_MOST = 400_000  # the most operations for it, times n^1.5
FIRST_ROUTE, LATER_ROUTES = 800_000, 200_000
"""Operations, times n^1.5, for the first route, annealed and gone through by regions, after which others are searched
for from nothing and merged into it; and for each of these. Long searches end in one and the same route: it takes short
ones to have something to merge."""
SEARCHER_FEW, HOTTER = 30, 4.0  # contours up to which annealings are hotter, and how many times: fewer are caught then
LONGER = 1.5  # how much longer than those before it is, or there is none: the rest is better spent on regions
LEAST_CONTOURS = 150  # Contours from which on a route is searched by regions.
LARGEST_BLOCK = 40  # Contours that must follow each other, at the most: they are free together.
SEARCHER_COLD = 0.05  # The last temperature, as a share of the same.
SETTING_UP, PER_SITE, PER_MOVE = 2_000_000, 1_000, 8
"""Operations that it takes as long as to make a region's problem, and for each site of the whole, and for each move
between two sites of the region."""
MIDDLE = 0.3, 0.7  # Where a route is parted: between these shares of it.
NEIGHBOURS = 200  # Contours near a contour that are kept in mind.

# search/moves/tour_merging.py

ANNEALINGS = 2  # of each walker in a generation
CHILD = 0.02  # the most of a run that a child may take
MERGING_LEAST = 8  # contours of a merged problem that is worth a search
EACH = 400_000  # operations for each of its contours

# search/state/travel.py

MATRIX_SITES = 3000  # a travel matrix is kept up to this many sites
TRAVEL_NEAREST = 16  # ends of arcs that an exchange tries to make, the nearer the oftener
TRAVEL_DRAWS = 4096  # numbers in `falls`

# search/walker.py

WALKER_SHORT = 50_000  # operations for a single annealing, times n^1.5: with less there is no time for several
HEATS = (2.0, 4.0, 1.0)  # factors on the temperatures of annealings, by turns
COOL = 2  # where to begin in them if time is short: less is lost by not going uphill
ANNEALED = 0.5  # share for annealings that begin anew, where what they find is then bred from
WALKER_SHORTEST = 1_000_000
"""operations for an annealing, times n^1.5: what one contour asks for grows with their number"""
SIZE = 10  # routes kept

# shared_state.py

PORTFOLIO_FIRST, FIRST_S = 0.03, 0.9  # Share of the work for a first look by the search; as many seconds at the least.
PORTFOLIO_AT_ONCE = 0.6
"""Share of what is left that a first look, or a sweep over all sets before it, may take at the most."""
WITHOUT_WISHES = 0.1  # Share of what is left for the best plan without wishes that tie the whole order together.
PROOF, PROOF_SMALL, PROOF_ZONES = 0.45, 0.9, 0.75
"""Share that the proof by ideals may take, where it fits; most take next to nothing. On small problems the search has
found the best plan long since, and only the proof is left to do. Zones that linear programs hold have more: their
sweeps find better plans than a search does."""
SET_OUT_S = 0.2  # Seconds below which no further member begins: each has tables of its own to make first.
PORTFOLIO_LOOKS, SEEDS_APART = 3, 1_000_003
"""Searches from scratch in the first look, where contours are few, and how far their seeds are apart. With more they
are so short that orders which bind tightly hold all of them up."""
DENSE, PORTFOLIO_WIDENED = 0.15, 0.5
"""Share of the pairs of contours that hard orders decide, from which on the most promising sets lead to good plans; and
share of what is left for sweeps of these, each wider than the last."""
FLOW_FEW = 80
"""Contours up to which the bound by flows and its multipliers may prove a plan at once, so that they come before more
search; with more, plans are improved at the same time."""
FLOW_FIRST, FLOW_CARRIED, FLOW = 0.15, 0.4, 0.95
"""Shares for the bound by flows before more search; where CP-SAT alone holds all that is asked; and at last, after that
search or beside it: the better the plan, the more it closes."""
EXCUSES = 0.2  # Share for whether plans need as many excuses, before linear programs bound what they cost besides.
SEARCH_NEST = 0.3  # Share for more search in small nests that flows bound well.
PORTFOLIO_PRICED = 0.6
"""Share for the ideals with multipliers of the flow, where these hold all that is asked of a small nest."""
FIRST_BOUNDS = 1 / 30
"""Share of the work beside a search in which such programs must come to their first bounds: with less work sweeps are
far from the plan, and flows alone bound higher."""
SEARCH_ALONE, SEARCH_BESIDE = 0.1, 0.4
"""For larger ones shares for search alone, and then for search beside the bound, which keeps one core busy: the search
has what that leaves of two."""
SEARCH, SEARCH_PLAIN, SEARCH_LAST = 0.6, 0.9, 0.97
"""Shares for more search elsewhere: where CP-SAT alone can prove anything, as statements look further back than a state
does; where CP-SAT has the rest; and where that would not do for CP-SAT's model."""
PORTFOLIO_AT_ONCE_S, AT_ONCE_MANY_S = 1.5, 2.5
"""A sweep over all sets is begun with, before any search, if it takes no longer. Where contours are so many that no
bound makes the sets few, a plan known before helps less, and it may take longer."""
SURE = 0.4  # Share of what is left that a sweep over all sets may take so that nothing else is tried before it.
COUNTED, COUNTED_FEW = 2e7, 5e6
"""Entries that are counted beforehand at the most, where there are `COUNTED_S` seconds or more; and where contours are
so few that a bound is tried anyway."""
COUNTED_S, COUNTED_DENSE_S, COUNTED_ALONE_S = 15.0, 5.0, 2.5
"""The second where orders are dense, and sets often few enough; the third where nothing but a sweep is asked for,
beyond `LARGE_NEST`: there most of the work is a sweep's."""
PREVIEW_WORK, PREVIEW_MOST_CONTOURS, PREVIEW_AFTER_ENTRIES = 0.05, 200, 3_000_000
"""Work of a preview while sets are counted, contours up to which it takes less than a second, and entries that are
counted before, in less than a second: a plan is shown while many are counted, and where they are few the search need
not be compiled. It is no part of what a plan takes, so that a plan is the same whoever looks on."""
PORTFOLIO_LONGEST, LONGEST_ZONE = 36, 80
"""Contours in a stretch up to which a bound may make the ideals few; and in one of several, none of which is most of
all."""

# solution.py

MEMORY_GB = 2.0  # What a solve may hold where nobody says more or less.
BESIDE_GB, LEAST_SHARE = 0.4, 0.2
"""What libraries, nest and problem take beside the tables of engines; and the share that is left for those anyway."""
MAX_ARCS = 80_000
"""Arcs between sites above which CP-SAT's model is not made: it takes longer than flows take to a better bound."""
SOLUTION_ROWS_PER_S = 8e6  # Crossings that are put in order in a second.
ARCS_LISTED_PER_S, ARCS_PER_S, PAIRS_PER_S = 1e6, 1e5, 2.5e4
"""Arcs between sites that CP-SAT's model is made of: listed with their prices, and made, presolved and begun with; and
pairs of contours that may follow each other, of which there are orders and arcs."""
BYTES_A_ROW = 60  # What every crossing takes in the tables of the search while they are made.

# solve.py

ROUND = 0.7  # Share of what is left for one round, where geometry may have afterthoughts that ask for another.
SOLVE_ENOUGH, ENOUGH_WORK = 0.9, 0.95
"""Share of a limit in seconds, and of one of work, after which no further round is begun: a look takes no work."""
MOVES_SHARE = 0.3
"""Share of a limit in seconds that looking at moves over parts that are out may take: what is made of them takes as
long again."""
PACE_KNOWN = 0.2  # Share of some work from which on its pace tells how long the rest takes.
SOLVE_LEAST = 0.2  # Share that the first round has at the least, however long the problem has taken to be made.

# jobs/adaptive_zones.py

ZONES_TRIES = 2  # Ways to make zones along a plan that are tried, of those that do what zones are for.
ZONES_A_TRY = 0.6  # Share of what is left that one of them may take, but for the last.
ZONES_LEAST_S = 0.05  # Seconds of a limit that are left for it, however long its rules have taken to be stated.
ZONES_RUNGS, ZONES_FIRST = (1.0, 3.0), 0.1
"""Limits, times powers of 10, up to which looks and tries are the same under every larger limit; and the first one."""
RUNG_CONTOURS, PROOF_CONTOURS = 4000.0, 120.0
"""The first of them is one at least, for so many contours: with less, stating the rules takes longer than all else. And
one for so many is enough for a proof."""
ZONES_TIMES = 1.6
"""How many times a limit of work all looks and tries up to it may take: a proof that just fails is of no use."""
ZONES_TIMED, TIMED_S = 0.4, 1.0
"""Share of a limit in seconds for looks, and the first such limit, s: making the problem takes some of it."""
IN_VAIN = 2
"""Looks one after the other without a better plan, each longer than the last, after which there is no further one."""
ZONES_GAIN = 0.1
"""By what share of the best plan a proof may make one cheaper that zones have broken: by 0.02 to 0.09 on plates of 300
and 1000 contours. Where they have broken it more, no proof is tried."""
ZONES_GEOMETRY = 60  # Contours up to which a plan by the zones of geometry comes first: it is mostly proven at once.

# jobs/plan_without_zones.py

UNZONED_MOST_MOVES = 150  # Contours with more of which looking at every single move takes too long.
UNZONED_DEARER = 0.01
"""Share of its cost by which a plan by zones may be dearer than one that is not asked about moves over parts."""
UNZONED_SHARE = 0.15
"""Share of a limit in which a plan without zones is looked for, at the most: of one in seconds, of which it is left so
much, or of the work, beside it. As much again is there for a plan by other zones, and what the first plan has left."""
UNZONED_UNPROVEN = 0.5
"""The same where plans by zones alone pay for what single moves cross, and the limit is too low for a proof."""
UNZONED_LEAST, A_CONTOUR = 0.5, 0.01  # Work that it takes at the least, and for every contour.
MOST_CONTOURS = 12_000  # Contours up to which it is looked for.
LEAST_WORK, LEAST_LOOK_S, PROVEN_S = 1e-4, 1e-3, 1e-3
"""Work, and seconds by the clock, for every contour of a larger nest, with less of which a look is not begun there; and
seconds that other zones have beside `STATED`, at the least, where there is time for them at all."""
UNZONED_PROOF = 4.0
"""How many times as long as the first plan took is kept for plans by other zones there, or half of what is left."""
UNZONED_STATED = 3.0
"""How many times as long as stating the rules took it takes there to draw zones, to state the rules by them, to make
the problem, and to look at one plan: what comes beside a proof."""
HELD_GB = 1e-4  # What facts and statements of a contour take there in memory, beside the tables of a proof.

# jobs/first_plan.py

FIRST_PLAN_WORK, WORK_A_CONTOUR = 0.03, 1e-4  # Work of the search that makes a first plan, and for every contour.

# jobs/cooler_orders.py

COOLER_ORDERS_DRAWN = 240  # Random orders that the first prices are fitted to.
COOLER_ROUNDS = 3  # Plans made with prices, one after the other.
COOLER_NEARBY = 30  # Routes simulated near the best one in each round.
NEARBY_WEIGHT = 4.0  # How much plans and routes near them count beside a random order when prices are fitted.
COOLER_LOT = 8  # Routes simulated before it is asked again whether to go on.
COOLER_ATTEMPTS = 20  # changes of a route that are drawn for a lawful one
COOLER_MOST_MOVES = 3  # contours that one such change moves, at the most
MOST_PULLED = 4  # Contours that are entered at random, at the most.

# jobs/heat_control.py

HEAT_FIRST = 0.4  # Share of the limits for the plan without prices: what is proven is proven there.
HEAT_ROUNDS = 5  # Orders tried, the first included.
FIRST_PRICE_SHARE = 0.5  # Share of the limits for the first of them.
MARGIN_K = 1.0
"""How far below the limit plans aim: the check makes the torch's paths in its own way, and a point of the grid that
comes to lie on the other side of the kerf makes half a kelvin."""
SOON_S = 30.0
"""Where a shorter wait would do, something else is to be cut meanwhile; where not, kerfs hold the heat back, and the
contour is to be cut before they are all there."""
LONGEST_S = 3600.0  # Waits longer than this are not looked for.
REPEATS = 4  # times that waits of one order are made longer until no metal is too hot, at the most
HEAT_RAISE = 4.0  # How much dearer a demand becomes that an order has not met.

# jobs/time_limits.py

LIMITS_LEAST_SHARE = 0.2  # Share of a limit in seconds that the planning has, whatever comes before and after it takes.
CHECKED, ENDED_S = 3.5, 0.7
"""How many times as long as finding candidates the plan with its reasons, the program and the check take, once more
where zones move; and seconds to load what is first asked for then, to write the files, and to leave."""
PLANNED = 1.0
"""How many times as long as finding candidates the plan with its reasons takes, a part of `CHECKED` that a picture
beside the check waits for."""
TOLD_S = 1.0  # A command that takes so many seconds longer than its limit says so.
SAID_S = 5.0  # What takes longer beside a limit in seconds is told.

# pipeline.py, plan/explain/reasons.py

PASS_WORK = 0.5  # What the way of one pass may cost at the most.
WORK_SHARE = 0.05  # and the most of it as a share of the work of the whole
REASONS_SHARE, REASONS_S = 0.05, 1.0
"""Share of a limit in seconds that working out why cuts come where they do may take beside it, and the least, s."""

# jobs/request.py

REQUEST_RELAX = 0.5
"""Share of a limit in seconds in which what gives way is to be found; a plan is to be made in the rest."""
REQUEST_WORK = 30.0  # The deterministic limit where nobody gives another.
REQUEST_LONGER, REQUEST_ENOUGH_WORK = 8, 2.0
"""How many times a limit that was too short is tried again, and the work that finds a first plan of most nests."""

# jobs/warm_up.py

WARM_UP_COLUMNS, WARM_UP_ROWS = 7, 5  # Parts of the plate that is planned.
WARM_UP_FEW = 3  # Columns and rows that are enough where it is only searched.
SEARCHED = 100  # Contours from which on a nest is searched for sure: smaller ones are often proven by a sweep in numpy.
