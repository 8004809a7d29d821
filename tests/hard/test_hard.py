"""Every hard case ends as expected, or under a known limit that has not been lifted."""

import dataclasses

import der
import pytest
from hard import CASES, MODELS, complaints, play
from hard.case import Limit
from hard.report import counts, markdown

IN_CI = [case for case in CASES if any(case.settings(long=False))]


@pytest.mark.parametrize("case", IN_CI, ids=lambda case: case.measure.__name__)
def test_ends_as_expected(case):
    rows = [play(case, setting) for setting in case.settings(long=False)]
    assert complaints(rows) == []


def test_all_models_and_steppers_are_tried():
    settings = [setting for case in CASES for setting in case.settings(long=False)]
    assert {setting.model for setting in settings} == set(MODELS)
    tried = {setting.stepper.name for setting in settings if setting.stepper}
    assert tried == {stepper.name for stepper in der.steppers()}


def test_surprises_and_lifted_limits_fail():
    case = next(case for case in CASES if case.measure.__name__ == "few_bent")
    right = [play(case, setting) for setting in case.settings(long=False)]
    lifted = dataclasses.replace(case, limits=(Limit("once", ("wrong",), lambda s: True),))
    rows = [dataclasses.replace(row, case=lifted) for row in right]
    assert "take it out: once" in complaints(rows)[0]
    wrong = dataclasses.replace(right[0], outcome="wrong")
    assert "not as 'solved'" in complaints([wrong])[0]
    assert "**not as expected**" in markdown([wrong])
    assert "1 not as expected" in counts([wrong, *right[1:]])
    # Under the limit the wrong row may stand.
    assert complaints([dataclasses.replace(wrong, case=lifted), *rows[1:]]) == []
