"""The profile's rules, each judged on the cuts by its own geometry."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.profile import Profile

from .each_torch import asked_of, torch_of_each
from .excuses import excuse
from .judgement import Judgement
from .relaxed import Relaxed, excuse_relaxed


def judge(nest: Nest, cuts: CutSequence, profile: Profile, relaxed: Sequence[Relaxed] = ()) -> list[Judgement]:
    """A judgement on every rule, the hard ones first; those that the profile switches off are listed last, unjudged.

    `relaxed` are statements that the plan or program says are relaxed. Cuts that were made before a stop are facts,
    and not judged.
    """
    settings, book, torches = profile.settings(), profile.rulebook(), torch_of_each(cuts)
    judged = [
        Judgement(
            name,
            setting.strength,
            book[name].sentence,
            tuple(
                v
                for v in book[name].violations(nest, cuts, setting.options)
                if book[name].still_counts(v, cuts.made) and asked_of(book[name], v.contours, torches)
            ),
            unjudged=book[name].unjudged(nest, cuts, setting.options),
            must_be_judged=book[name].must_be_judged and setting.strength == "hard",
        )
        for name, setting in sorted(settings.items(), key=lambda item: (item[1].strength != "hard", item[0]))
    ]
    off = [Judgement(name, "off", rule.sentence) for name, rule in sorted(book.items()) if name not in settings]
    return [*excuse_relaxed(nest, cuts, profile, excuse(nest, cuts, profile, judged), relaxed), *off]
