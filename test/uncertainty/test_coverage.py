# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Ellipses contain as many errors as they say, in random cells and on rendered boards."""

from pathlib import Path
import sys

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / 'benchmarks'))
import uncertainty  # noqa: E402, I100, I202
import uncertainty_cells  # noqa: E402, I100, I202

CELLS = 120


@pytest.fixture(scope='module')
def rows():
    return {row['what']: row['contained'] for row in uncertainty.simulated(CELLS, seed=11)}


@pytest.mark.slow
@pytest.mark.parametrize('term', uncertainty_cells.TERMS)
def test_ellipses_of_a_term_contain_the_share_that_they_name(rows, term):
    for share, found in zip(uncertainty.SHARES, rows[term]):
        # One of a hundred thousand runs of an honest term would fail.
        assert abs(found - share) < 4.5 * np.sqrt(share * (1 - share) / CELLS) + 0.5 / CELLS


@pytest.mark.slow
def test_a_covariance_of_half_the_size_is_noticed():
    outcomes = [uncertainty_cells.Cell(np.random.default_rng([11, number])).outcomes()
                for number in range(60)]
    squares = 4 * np.array([outcome['all'].square for outcome in outcomes])
    assert uncertainty.contained(squares)[1] < 0.75
