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
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.surface.models import HomographySurface, ParallelSurface
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
