# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Boxes and footprints as the page draws them, on the picture and on the map."""

import math

from camera_to_base.coordinate_transform import Pose
from camera_to_base.dashboard.live.geometry import Geometry, shapes_data
from camera_to_base.dashboard.live.positions import SeenFrame
from camera_to_base.parameters import default_values, TRANSFORM_SPECS
from camera_to_base.ros import SolidBox, SurfaceSilhouette, UncertainPose
from camera_to_base.settings import CAMERA_SPECS
import cv2
import numpy as np
import pytest

HEIGHT, FOOT = 60.0, np.array([18.0, 60.0])
CAMERA = {**default_values(CAMERA_SPECS), 'surface.model': 'parallel',
          'surface.camera_height_cm': HEIGHT, 'surface.camera_foot_cm': FOOT.tolist()}
TRANSFORM = default_values(TRANSFORM_SPECS)
BASE = np.array([[-2.0, -1.0], [2.0, -1.0], [2.0, 1.0], [-2.0, 1.0]]) + [10.0, 12.0]


def seen(height):
    """Give a frame with a block on the base rectangle, as a camera above FOOT sees it."""
    raised = FOOT + (BASE - FOOT) / (1 - height / HEIGHT)
    outline = cv2.convexHull(np.concatenate([BASE, raised]).astype(np.float32))[:, 0]
    return SeenFrame(
        boxes=[SolidBox(Pose(10.0, 12.0, -height / 2, 0.0), 4.0, 2.0, height)],
        silhouettes=[SurfaceSilhouette(
            np.column_stack([outline, np.zeros(len(outline))]),
            UncertainPose(Pose(10.0, 12.0, 0.0, 0.0), np.eye(6)))]), raised


def area(points):
    return cv2.contourArea(np.array(points, np.float32))


def test_block_stands_on_its_footprint_and_its_box_has_its_top_where_it_is_seen():
    frame, raised = seen(6.0)
    shape, = shapes_data(frame, Geometry(CAMERA, TRANSFORM))
    assert shape['size_cm'] == [4.0, 2.0, 6.0]
    picture = shape['picture']
    # The parallel camera shows 36 cm on 640 px.
    np.testing.assert_allclose(picture['box'], BASE / 36 * 640 - 0.5, atol=0.6)
    np.testing.assert_allclose(picture['top'], raised / 36 * 640 - 0.5, atol=0.6)
    assert area(picture['footprint']) == pytest.approx(8 * (640 / 36) ** 2, rel=0.03)
    assert area(picture['silhouette']) > 1.3 * area(picture['footprint'])
    # In the tutorial's base frame: x - 17.8, 24.4 - y.
    np.testing.assert_allclose(np.mean(shape['map']['box'], axis=0), [-7.8, 12.4], atol=0.02)
    assert area(shape['map']['footprint']) == pytest.approx(8, rel=0.03)


def test_flat_object_stands_on_its_outline_and_has_no_top():
    frame, _ = seen(0.0)
    # A marker has an extent: its thinnest box is 1 mm high.
    frame.boxes[0] = frame.boxes[0]._replace(height=0.1)
    shape, = shapes_data(frame, Geometry(CAMERA, TRANSFORM))
    assert shape['size_cm'] == [4.0, 2.0, 0.0]
    assert shape['picture']['top'] is None and shape['picture']['silhouette'] is None
    assert area(shape['picture']['footprint']) == pytest.approx(area(shape['picture']['box']))


def test_without_the_place_of_the_camera_or_the_robot_there_is_a_box_alone():
    frame, _ = seen(6.0)
    frame.silhouettes = []
    unknown = {**CAMERA, 'surface.camera_height_cm': 0.0, 'surface.camera_foot_cm': []}
    shape, = shapes_data(frame, Geometry(unknown, {}))
    assert [name for name, one in shape['picture'].items() if one] == ['box']
    assert not any(shape['map'].values())
    assert shapes_data(None, Geometry(unknown, {})) == shapes_data(frame, None) == []


def test_round_object_whose_silhouette_has_not_come_has_a_size_alone():
    frame, _ = seen(6.0)
    frame.boxes[0] = frame.boxes[0]._replace(length=2.0, width=1.98)
    frame.silhouettes = []
    shape, = shapes_data(frame, Geometry(CAMERA, TRANSFORM))
    assert shape['size_cm'] == [2.0, 2.0, 6.0]
    assert not any([*shape['picture'].values(), *shape['map'].values()])


def test_what_is_turned_is_drawn_turned():
    frame, _ = seen(0.0)
    pose = Pose(10.0, 12.0, 0.0, math.radians(30))
    frame.boxes[0] = frame.boxes[0]._replace(pose=pose)
    shape, = shapes_data(frame, Geometry(CAMERA, TRANSFORM))
    (x0, y0), (x1, y1) = shape['picture']['box'][:2]
    assert math.degrees(math.atan2(y1 - y0, x1 - x0)) == pytest.approx(30, abs=0.5)


def test_box_of_a_round_object_which_has_no_direction_is_not_drawn():
    frame, _ = seen(0.0)
    angles = np.linspace(0, 2 * math.pi, 40, endpoint=False)
    disc = np.column_stack([10 + np.cos(angles), 12 + np.sin(angles), np.zeros(40)])
    frame.boxes[0] = frame.boxes[0]._replace(length=2.0, width=1.98)
    frame.silhouettes[0] = frame.silhouettes[0]._replace(corners=disc)
    shape, = shapes_data(frame, Geometry(CAMERA, TRANSFORM))
    assert shape['picture']['box'] is None and shape['map']['box'] is None
    assert len(shape['picture']['footprint']) == 40
    frame.boxes[0] = frame.boxes[0]._replace(height=1.0)
    top = shapes_data(frame, Geometry(CAMERA, TRANSFORM))[0]['picture']['top']
    assert len(top) > 8
