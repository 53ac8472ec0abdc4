# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Where objects count."""

from camera_to_base.detection import ObjectLocator, read_areas
from camera_to_base.detection.settings import Area, DetectorSettings
from camera_to_base.drawing import AreaOverlay
from camera_to_base.errors import InvalidValueError
from camera_to_base.surface.models import HomographySurface, ParallelSurface
import numpy as np
import pytest

# 0.1 cm a pixel.
SURFACE = ParallelSurface(64.0)


def frame_with(*boxes):
    frame = np.full((480, 640, 3), 220, np.uint8)
    for x, y, width, height in boxes:
        frame[y:y + height, x:x + width] = 20
    return frame


def located(areas):
    settings = DetectorSettings(areas=areas)
    locator = ObjectLocator(frame_with(), SURFACE, settings)
    return locator.find(frame_with((100, 100, 41, 41), (400, 300, 61, 61)))


def test_only_objects_in_the_work_area_are_published_and_the_others_are_told():
    found = located(read_areas([35.0, 25.0, 60.0, 25.0, 60.0, 45.0, 35.0, 45.0], ''))
    assert [one.point for one in found.objects] == [pytest.approx((43.0, 33.0), abs=0.1)]
    assert [one.reason.kind for one in found.left_out] == ['outside_work_area']


def test_objects_in_an_ignored_area_are_not_published():
    found = located(read_areas([], '0 0, 20 0, 20 20, 0 20; 50 0, 60 0, 60 5'))
    assert [one.point for one in found.objects] == [pytest.approx((43.0, 33.0), abs=0.1)]
    assert [one.reason.kind for one in found.left_out] == ['in_ignored_area']


def test_no_areas_leave_nothing_out():
    found = located(read_areas([], ' '))
    assert len(found.objects) == 2 and found.left_out == ()


def test_area_may_have_a_bay():
    bay = Area(np.array([[0, 0], [10, 0], [10, 10], [5, 2], [0, 10]]))
    assert bay.contains((1, 5)) and bay.contains((9, 5)) and not bay.contains((5, 5))


@pytest.mark.parametrize('work, ignored, message', [
    ([1.0, 2.0, 3.0], '', 'work_area must be x and y in turn'),
    ([0.0, 0.0, 1.0, 1.0, 2.0, 2.0], '', 'work_area: expected at least three corners'),
    ([0.0, 0.0, 4.0, 4.0, 4.0, 0.0, 0.0, 4.1], '', 'crosses itself'),
    ([0.0, 0.0, 1.0, 0.0, float('nan'), 1.0], '', 'work_area'),
    ([], '0 0, 5 0', 'ignored_areas: expected at least three corners'),
    ([], '0 0, 5 0, 5', 'must be polygons as'),
    ([], 'a b, c d, e f', 'must be polygons as')])
def test_what_is_no_polygon_is_refused_by_its_parameters_name(work, ignored, message):
    with pytest.raises(InvalidValueError, match=message):
        read_areas(work, ignored)


def test_areas_are_drawn_where_they_are():
    picture = frame_with()
    AreaOverlay(SURFACE, read_areas([10.0, 10.0, 50.0, 10.0, 50.0, 40.0, 10.0, 40.0],
                                    '20 20, 30 20, 30 30')).draw(picture)
    changed = np.argwhere((picture != 220).any(axis=2))
    assert changed.min(axis=0) == pytest.approx([100, 100], abs=4)
    assert changed.max(axis=0) == pytest.approx([400, 500], abs=4)
    red, green = picture[..., 2].astype(int), picture[..., 1].astype(int)
    ignored = np.argwhere(red > green + 50)
    assert ignored.min(axis=0) == pytest.approx([200, 200], abs=8)


def test_areas_beside_the_horizon_are_drawn_without_an_error():
    road = HomographySurface(np.array([[1, 0, -320], [0, 0, 128], [0, 1, -112]]))
    picture = frame_with()
    AreaOverlay(road, read_areas([-1.0, 0.4, 1.0, 0.4, 1.0, 0.9, -1.0, 0.9], '')).draw(picture)
    rows = np.argwhere((picture != 220).any(axis=2))[:, 0]
    assert rows.min() > 200
