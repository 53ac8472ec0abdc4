# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math

from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.detection.locator import ObjectLocator
from camera_to_base.detection.settings import DetectorSettings
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.simulation.view import BoardView, Oval
from camera_to_base.surface.models import HomographySurface, ParallelSurface, SURFACE_DEFAULTS
from camera_to_base.surface.parameters import make_surface
import numpy as np
import pytest

# The coin's whole round takes a minute.
FRAME_RATE, FRAMES_OF_A_ROUND = 2.0, 120


def parallel_surface(board):
    return ParallelSurface(36.0, 640)


def homography_surface(board):
    return HomographySurface(board.surface_from_pixel, (640, 480))


def base_points(tilt_deg, surface_of, frame_count):
    """Give the measured and the true base point of each frame, in cm."""
    board = SimulatedBoard(tilt_deg=tilt_deg, frame_rate=FRAME_RATE, seed=tilt_deg)
    locator = ObjectLocator(board.read(), surface_of(board))
    conversion = CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0)
    for _ in range(frame_count):
        coin, = locator.locate(board.read())
        x, y = board.true_point
        yield conversion.convert_surface_points([coin.point])[0], (x - 17.8, 24.4 - y, 0.0)


def errors_mm(*flow):
    return [10 * math.dist(measured, true) for measured, true in base_points(*flow)]


@pytest.mark.parametrize('tilt_deg, surface_of', [
    (0, parallel_surface), (0, homography_surface), (30, homography_surface)])
def test_coin_is_within_2_mm_of_the_truth_in_the_base_frame_all_the_way(tilt_deg, surface_of):
    errors = errors_mm(tilt_deg, surface_of, FRAMES_OF_A_ROUND)
    assert len(errors) == FRAMES_OF_A_ROUND
    assert max(errors) < 2.0


def test_parallel_surface_is_wrong_for_a_tilted_camera():
    assert max(errors_mm(30, parallel_surface, 20)) > 5.0


def picture_of_a_coin(view, point, radius):
    """Render a dark coin on the surface; None for the surface alone."""
    everything = slice(0, view.height), slice(0, view.width)
    grey = np.full((view.height, view.width), 200.0)
    if point is not None:
        grey -= 140 * view.coverage(Oval(point, radius, radius, 0.0), *everything)
    return np.repeat(grey.round().astype(np.uint8)[:, :, None], 3, axis=2)


@pytest.mark.parametrize('tilt_deg, model, from_foot_cm, off_mm', [
    (0, 'parallel', 10, 7.1), (0, 'homography', 10, 7.1), (30, 'homography', 30, 25.0)])
def test_coin_on_a_block_of_4_cm_is_off_unless_its_height_is_told(
        tilt_deg, model, from_foot_cm, off_mm):
    # The simulated camera is 60 cm from where the picture's centre looks, at (18, 13.5) cm.
    view, tilt = BoardView((640, 480), 36.0, tilt_deg), math.radians(tilt_deg)
    foot, height = np.array([18.0, 13.5 + 60 * math.sin(tilt)]), 60 * math.cos(tilt)
    coin = foot + from_foot_cm * np.array([0.28, -0.96])
    # It looks like a larger coin on the surface that is farther from the foot point.
    nearness = 1 - 4 / height
    frame = picture_of_a_coin(view, foot + (coin - foot) / nearness, 1.2 / nearness)
    values = {**SURFACE_DEFAULTS, 'surface.model': model,
              'surface.homography.surface_from_pixel': view.surface_from_pixel.ravel().tolist()}
    told = {'object_height_cm': 4.0, 'surface.camera_height_cm': height,
            'surface.camera_foot_cm': [] if model == 'parallel' else foot.tolist()}

    def error_mm(values):
        locator = ObjectLocator(picture_of_a_coin(view, None, None), make_surface(values),
                                DetectorSettings(method='precise'))
        located, = locator.locate(frame)
        return 10 * math.dist(located.point, coin)

    assert error_mm({**values, **told}) < 0.5
    assert error_mm(values) == pytest.approx(off_mm, abs=0.5)
