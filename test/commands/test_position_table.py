# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math

from camera_to_base.commands.positions import csv_cells, positions, table_header, table_line
from camera_to_base.detection.detection import Box, Detection, Pixel
from camera_to_base.detection.left_out import Point
from camera_to_base.detection.locator import LocatedObject
from camera_to_base.settings import read_node_settings
from camera_to_base.sources.recording import TimedFrame
from camera_to_base.surface.models import ParallelSurface
from camera_to_base.uncertainty import PositionCovariance, uncertain_transform
import numpy as np
import pytest

TRANSFORM = uncertain_transform(read_node_settings(None).transform)


def located(u, v, x, y, yaw=None):
    detection = Detection(Box(0, 0, 1, 1), Pixel(u, v), 1.0, np.zeros((1, 1, 2), np.int32), False)
    return LocatedObject(detection, Point(x, y), yaw)


def covariance_of(found):
    """Give a camera that is off by 3 cm along x, 4 cm along y and 1 rad."""
    return PositionCovariance(9.0, 0.0, 16.0, 0.01, 1.0)


def test_lines_of_one_frame():
    timed = TimedFrame(7, 1_700_000_000_000_000_009, lambda: None)
    long, round_, far = positions(timed, [
        located(390.0, 275.25, 19.5, 13.75, math.radians(30)), located(1.0, 2.0, 3.0, 4.0),
        located(0.0, 0.0, 2000.0, 0.0)], TRANSFORM, covariance_of, ParallelSurface())
    # The default base frame looks from below: its y and the yaw change their signs.
    assert csv_cells(long)[:11] == [
        '7', '1700000000.000000009', '1', '390.0000', '275.2500', '19.5000', '13.7500',
        '1.7000', '10.6500', '0.0000', '-30.0000']
    assert csv_cells(round_)[2:11] == [
        '2', '1.0000', '2.0000', '3.0000', '4.0000', '-14.8000', '20.4000', '0.0000', '']
    assert csv_cells(far)[2:] == [
        '3', '0.0000', '0.0000', '2000.0000', '0.0000', *8 * [''], *3 * ['0.0000']]
    assert table_line(long).split()[:-1] == [
        '7', '1700000000.000', '1', '390.0', '275.2', '19.50', '13.75', '1.70', '10.65', '-30.0']
    assert table_line(far).split()[-4:] == ['-'] * 4
    assert {len(line) for line in (
        table_header(), table_line(long), table_line(round_), table_line(far))} == {
            len(table_header())}


def test_ellipse_contains_what_camera_and_transform_make_uncertain():
    timed = TimedFrame(7, 1, lambda: None)
    position, round_ = positions(
        timed, [located(0, 0, 0.0, 0.0, 0.0), located(0, 0, 0.0, 0.0)], TRANSFORM, covariance_of,
        ParallelSurface())
    long, short, angle, yaw = (float(cell) for cell in csv_cells(position)[-7:-3])
    # The default of the transform: 1 cm; 95 % lie within 2.448 deviations.
    assert long == pytest.approx(24.477 * math.sqrt(17), rel=1e-3)
    assert short == pytest.approx(24.477 * math.sqrt(10), rel=1e-3)
    assert abs(angle) == 90
    assert yaw == pytest.approx(math.degrees(1), rel=1e-3)
    assert csv_cells(round_)[-4] == '' and csv_cells(round_)[-5] != ''
