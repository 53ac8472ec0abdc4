# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Objects that stand up from the surface, as a pinhole camera sees them."""

import re

from camera_to_base.detection.locator import ObjectLocator
from camera_to_base.detection.settings import DetectorSettings
from camera_to_base.errors import FrameSizeError, HorizonError, InvalidValueError
from camera_to_base.parameters.spec import checked_values
from camera_to_base.surface.models import HomographySurface, ParallelSurface, SURFACE_SPECS
from camera_to_base.surface.parameters import make_surface
from camera_to_base.surface.raised_nudged import RaisedSurface
import numpy as np
import pytest

# A camera that looks along a road: x = (u - 320) / (v - 112), y = 128 / (v - 112).
ROAD = HomographySurface(np.array([[1, 0, -320], [0, 0, 128], [0, 1, -112]]))
MM = ParallelSurface(64.0)  # 1 px is 1 mm


def raised(**values):
    return make_surface(checked_values(
        SURFACE_SPECS, {'surface.parallel.width_cm': 64.0, **values}))


def test_an_object_of_4_cm_is_7_mm_nearer_to_the_foot_point_than_it_is_seen():
    surface = RaisedSurface(MM, 4.0, 60.0, (30.0, 20.0))
    located = surface.locate([[300 + 107.142857, 200], [300, 200], [300, 200 - 107.142857]])
    np.testing.assert_allclose(located, [[40.0, 20.0], [30.0, 20.0], [30.0, 10.0]], atol=1e-6)


def test_any_point_above_the_surface_is_located_below_itself():
    # Truth: the straight line from the camera through the point, down to z = 0.
    random = np.random.default_rng(0)
    for _ in range(200):
        camera = np.append(random.uniform(-50, 50, 2), random.uniform(20, 200))
        point = np.append(random.uniform(-50, 50, 2), random.uniform(0, 0.9) * camera[2])
        ray = point - camera
        seen = camera - ray * camera[2] / ray[2]
        assert seen[2] == pytest.approx(0, abs=1e-9)
        surface = RaisedSurface(MM, point[2], camera[2], camera[:2])
        np.testing.assert_allclose(surface.locate(10 * seen[None, :2]), [point[:2]], atol=1e-9)


def test_parallel_camera_is_above_the_pictures_centre_whatever_the_pictures_size():
    surface = raised(**{'object_height_cm': 5.0, 'surface.camera_height_cm': 50.0})
    for width, height in ((640, 480), (1280, 720), (100, 300)):
        cm_per_px = 64.0 / width
        for sized in (surface.for_image_size((width, height)),
                      surface.for_image_size((320, 320)).for_image_size((width, height))):
            centre = [[(width - 1) / 2, (height - 1) / 2], [(width - 1) / 2 + 10, 0]]
            middle, end = sized.locate(centre)
            assert middle == pytest.approx(np.array(centre[0]) * cm_per_px)
            assert end - middle == pytest.approx(
                0.9 * cm_per_px * np.array([10, -(height - 1) / 2]))


def test_foot_point_that_was_given_stays_for_every_picture_size():
    surface = raised(**{'object_height_cm': 5.0, 'surface.camera_height_cm': 50.0,
                        'surface.camera_foot_cm': [3.0, 4.0]}).for_image_size((320, 240))
    assert surface.locate([[15, 20]])[0] == pytest.approx([3.0, 4.0])


def test_flat_objects_need_neither_height_nor_foot_point():
    assert type(raised()) is ParallelSurface
    assert type(raised(**{'surface.camera_height_cm': 60.0})) is ParallelSurface


def test_what_the_surface_refuses_stays_refused():
    surface = RaisedSurface(ROAD, 4.0, 60.0, (0.0, 0.0))
    with pytest.raises(HorizonError):
        surface.locate([[320, 100]])
    with pytest.raises(FrameSizeError):
        surface.for_image_size((320, 240))
    with pytest.raises(InvalidValueError, match='pixels'):
        surface.locate([[np.nan, 100]])


def test_size_limits_hold_for_the_face_that_is_seen():
    # 80 px are 8 cm on the surface, but half of that half the way up to the camera.
    empty = np.full((480, 640, 3), 220, np.uint8)
    frame = empty.copy()
    frame[200:280, 280:360] = 20
    flat, high = raised(), raised(
        **{'object_height_cm': 30.0, 'surface.camera_height_cm': 60.0})
    small = DetectorSettings(method='precise', min_area_cm2=10.0, max_area_cm2=20.0)
    large = DetectorSettings(method='precise', min_area_cm2=50.0, max_area_cm2=80.0)
    counts = [len(ObjectLocator(empty, surface, limits).locate(frame))
              for surface in (flat, high) for limits in (small, large)]
    assert counts == [0, 1, 1, 0]


HOMOGRAPHY = {'surface.model': 'homography', 'object_height_cm': 4.0}
CANNOT_BE_USED = {
    'unknown camera height': ({'object_height_cm': 4.0}, 'needs surface.camera_height_cm.*'
                              'set it, or let `calibrate board` with --intrinsics find it'),
    'unknown foot point': ({**HOMOGRAPHY, 'surface.camera_height_cm': 60.0},
                           'needs surface.camera_foot_cm.*--intrinsics'),
    'object above the camera': (
        {'object_height_cm': 61.0, 'surface.camera_height_cm': 60.0},
        "object_height_cm must be below the camera's height, 60 cm, got 61"),
    'object as high as the camera': (
        {'object_height_cm': 60.0, 'surface.camera_height_cm': 60.0}, 'got 60'),
    'negative height': ({'object_height_cm': -1.0}, 'object_height_cm must be 0'),
    'height that is not finite': ({'surface.camera_height_cm': np.nan},
                                  'surface.camera_height_cm must be 0 to 100000 cm, got nan'),
    'foot point of one number': (
        {'surface.camera_foot_cm': [1.0]},
        r'surface.camera_foot_cm must be 0 or 2 numbers in cm, got \[1.0\]'),
    'foot point in three dimensions': (
        {'surface.camera_foot_cm': [1.0, 2.0, 3.0]}, r'got \[1.0, 2.0, 3.0\]'),
    'foot point that is no number': ({'surface.camera_foot_cm': ['left']},
                                     'surface.camera_foot_cm must be of type list of double'),
}


@pytest.mark.parametrize('case', CANNOT_BE_USED)
def test_values_that_cannot_be_used_are_refused_by_name_and_with_the_cure(case):
    values, said = CANNOT_BE_USED[case]
    with pytest.raises(InvalidValueError) as error:
        raised(**values)
    assert re.search(said, str(error.value)), error.value
