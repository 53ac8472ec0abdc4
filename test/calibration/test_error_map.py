# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A map of expected errors is summed up in a word."""

import re

from camera_to_base.calibration.report import verdict_of
import numpy as np
import pytest


def errors(middle, corners):
    rows = np.full((6, 8), 1.0)
    rows[2:4, 3:5] = middle
    rows[::5, ::7] = corners
    return [[None if np.isnan(error) else error for error in row] for row in rows.tolist()]


@pytest.mark.parametrize('middle, corners, said', [
    (0.9, 1.9, 'good: 95 % of positions within 0.9 mm in the middle and 1.9 mm in the corners'),
    (2.1, 1.9, 'fair: .* 2.1 mm in the middle .*; good is 2 mm and 5 mm: measure more points'),
    (0.5, 9.9, 'fair: .* 9.9 mm in the corners; good is'),
    (0.5, 10.1, 'poor: '), (5.1, 1.0, 'poor: '),
    (0.5, np.nan, 'good: .* and the corners do not show the surface')])
def test_word_follows_the_middle_and_the_corners(middle, corners, said):
    verdict = verdict_of(errors(middle, corners))
    assert pytest.approx(middle) == verdict.middle_mm
    assert re.match(said, verdict.sentence)


def test_middle_beyond_the_horizon_has_no_word():
    assert verdict_of(errors(np.nan, 1.0)) is None
