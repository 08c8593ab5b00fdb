"""Apps: what is built on the core, each in a folder with its verbs and its part of the Python interface.

The core imports none of them. It finds what it calls by name, in the tables here, through `kerfwise.app_modules`.
"""

from __future__ import annotations

VERBS = {
    "heat": ("heat.verbs", "Simulate how hot a plan or a program makes the sheet."),
    "distort": ("distortion.verbs", "Predict how far each part will be off, in mm."),
    "pareto": ("pareto.verbs", "Trade idle travel against overheats: a front of plans."),
    "compare": ("viewer.compare.verbs", "Put two plans, programs, profiles or sets of rules side by side."),
    "nest": ("nesting.verbs", "Lay parts with quantities on sheets and remnants."),
    "make": ("nesting.verbs", "Turn a list of parts into checked programs: nest, plan, check."),
    "edit": ("edit.verbs", "Change a nest: drop, move, turn, add parts, another sheet."),
    "batch": ("batch.verbs", "Plan folders of nests on every machine, and say which is cheaper."),
    "resequence": ("resequence.verbs", "Put old programs into a better order, or plan them afresh."),
    "serve": ("viewer.serve.verbs", "Show a nest in the browser: ask why, move, plan again, save."),
    "sheet": ("work_sheets.verbs", "Print a plan as a work sheet for the operator (PDF)."),
    "profile": ("authoring.verbs", "Check a profile, or show it with every default filled in."),
    "dialects": ("authoring.verbs", "List the languages of controls, or begin one of a plant's own."),
    "rules": ("authoring.verbs", "List the rules, print one rule's page, begin a new one, run the cases."),
    "bench": ("bench.verbs", "Measure engines on nests and on the field's routing instances."),
}
"""Verb → the module that has its command, and what it does in a line."""

NAMES = {
    "Comparison": "viewer.compare.comparison",
    "EditedNest": "edit.edited_nest",
    "Nests": "nesting.nest_list",
    "Offer": "pareto.pareto",
    "Resequenced": "resequence.result",
    "Simulation": "heat.simulation",
    "compare": "viewer.compare.api",
    "distort": "distortion.api",
    "edit": "edit.api",
    "make": "nesting.api",
    "nest": "nesting.api",
    "resequence": "resequence.api",
    "simulate": "heat.api",
    "trade_off": "pareto.api",
}
"""Name of the Python interface → the module that has it."""
