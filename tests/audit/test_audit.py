"""Short runs of the audit: what must hold of every error bar, and of scenes of extreme numbers."""

from audit import KINDS, aims_missed
from audit.answers import aims_of_answers_missed
from audit.score import report
from run import answers, audit

# Scenes of each kind; about 45 s on one core. The long run: docs/validation.md.
SCENES = {
    "static": 40,
    "modes": 12,
    "buckling": 12,
    "fall": 12,
    "motion": 4,
    "paths": 3,
    "space_static": 40,
    "space_motion": 2,
}


def test_true_values_are_inside_and_right_values_are_not_flagged() -> None:
    assert SCENES.keys() == KINDS.keys()
    outcomes = [o for kind, scenes in SCENES.items() for o in audit([kind], scenes, seed=1)]
    rows = [row for outcome in outcomes for row in outcome.rows]
    assert sum(row.in_space for row in rows) > 200
    assert sum(not row.in_space for row in rows) > 500
    assert not aims_missed(rows), report(outcomes)


def test_extreme_scenes_are_right_or_refused() -> None:
    """The first that take a few seconds together. The long run: docs/robustness.md."""
    assert aims_of_answers_missed(answers(36, seed=1)) == []
