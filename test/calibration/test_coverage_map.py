# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The map of what a calibration covers."""

from camera_to_base.calibration.boards.placement import covered_shares, map_lines, uncovered
import numpy as np

LEFT_THIRD = np.array([[0, 0], [213, 0], [213, 480], [0, 480]])
SMALL = np.array([[300, 200], [400, 200], [400, 300], [300, 300]])


def test_map_shows_what_is_covered_and_what_in_part():
    shares = covered_shares([LEFT_THIRD, SMALL], (640, 480))
    assert map_lines(shares) == ['# . .', '# + .', '# . .']
    assert uncovered(shares)[-1] == 'middle' and len(uncovered(shares)) == 6
    assert 'left' not in uncovered(shares)


def test_nothing_lacks_where_everything_is_covered():
    everything = np.array([[0, 0], [640, 0], [640, 480], [0, 480]])
    assert uncovered(covered_shares([everything], (640, 480))) == []
