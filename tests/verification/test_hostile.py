"""No hostile case hangs, gives NaN quietly, or ends beyond the limit of its energy error without saying so."""

import os

import pytest
from hostile import FAILED, FINISHED, STOPPED, Hostile, end_of, ends_of, matrix, sample


@pytest.mark.parametrize("hostile", sample(1), ids=lambda hostile: " ".join(map(str, hostile)))
def test_a_hostile_case_finishes_or_a_guard_says_why_not(hostile: Hostile):
    end = end_of(hostile)
    assert end.how in (FINISHED, STOPPED), end


def test_a_sparse_history_hides_nothing():
    violent = Hostile("fem", speed=1500.0, ratio=1.0, decay=1e9)
    ends = [end_of(violent._replace(rows=rows)) for rows in (0.0, 1.0)]
    assert [end.how for end in ends] == [STOPPED, STOPPED], ends


@pytest.mark.long
def test_every_hostile_case_finishes_or_a_guard_says_why_not():
    ends = ends_of(matrix(), os.cpu_count() or 1)
    assert [(hostile, end) for hostile, end in ends.items() if end.how == FAILED] == []
    assert sum(end.how == FINISHED for end in ends.values()) > len(ends) / 2  # of what is hostile, most is no matter
