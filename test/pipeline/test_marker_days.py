# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Days with markers: the camera is moved, and nothing wrong is published."""

from marker_day import play
import pytest

DAYS = {
    'camera that is carried while a marker is covered': (
        7, ('coin', 'cover', 'carry', 'capture', 'coin')),
    'marker that is moved before the camera is': (
        8, ('shift_marker', 'coin', 'carry', 'capture', 'coin')),
    'swapped markers and a restart': (9, ('swap', 'restart', 'coin')),
    'zoom with a coin on the table': (10, ('coin', 'zoom', 'capture', 'coin')),
}


@pytest.mark.slow
@pytest.mark.parametrize('seed, kinds', DAYS.values(), ids=DAYS)
def test_day_with_markers_goes_well(seed, kinds, tell):
    course = play(seed, kinds)
    tell(f'{len(course.errors_mm)} points, {dict(course.reasons)}')
    assert course.wrong == []
    assert course.errors_mm
    assert course.outside <= 0.05 * len(course.errors_mm)
    assert course.back_s is not None
