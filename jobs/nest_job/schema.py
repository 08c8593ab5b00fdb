"""The JSON Schema of a job file: `python -m kerfwise.jobs.nest_job.schema > jobs/nest_job/job.schema.json`."""

from __future__ import annotations

import json
import sys
from typing import Any

from kerfwise.rules.lock import Lock
from kerfwise.rules.options.kind import OptionKind, Text
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.quantities import PointOrOff, PointXY

from .job import Job

Json = dict[str, Any]


def job_schema() -> Json:
    """The schema, made from the declarations that job files are read with."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "kerfwise job",
        "description": "What belongs to one nest: written beside it, in NEST.job.yaml.",
        "type": ["object", "null"],
        "additionalProperties": False,
        "properties": {
            **{o.key: {"description": o.help, **_value(o.kind)} for o in options_of(Job)},
            "locks": {
                "description": "decisions of the planner: lines such as P2 first, or mappings as in a profile",
                "type": ["array", "null"],
                "items": {"anyOf": [{"type": "string", "minLength": 1}, _lock()]},
            },
            "tabs": {
                "description": "contour or part: a point where a tab holds it, several points, or off",
                "type": ["object", "null"],
                "additionalProperties": _tab(),
            },
            "set": {
                "description": "values of the profile that this nest has otherwise, such as leads.lead_in: 4 mm",
                "type": ["object", "null"],
            },
        },
    }


def _value(kind: OptionKind) -> Json:
    """A text may be a number to readers of YAML, such as that of an order."""
    return kind.schema() | ({"type": ["string", "number"]} if isinstance(kind, Text) else {})


def _lock() -> Json:
    keys = {o.key: {"description": o.help, **o.kind.schema()} for o in options_of(Lock)}
    one = [{"required": ["contour"]}, {"required": ["part", "zone"]}]
    return {"type": "object", "properties": keys, "additionalProperties": False, "oneOf": one}


def _tab() -> Json:
    return {"anyOf": [PointOrOff().schema(), {"type": "array", "items": PointXY().schema(), "minItems": 1}]}


def schema_text() -> str:
    """The schema as the text of its file."""
    return json.dumps(job_schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.stdout.write(schema_text())
