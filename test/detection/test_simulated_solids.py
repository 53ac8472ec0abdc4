# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The whole way from rendered solid objects to where they stand, how they lie, and their size."""

import math

from camera_to_base.detection import DetectorSettings, ObjectLocator
from camera_to_base.simulation import SimulatedBoard, SimulatedScene
from camera_to_base.simulation.specs import SHAPES
import numpy as np
import pytest

ELONGATION = 1.5


def located(height, **parameters):
    """Give what is found of five objects, with the true one of each, and the camera."""
    board = SimulatedBoard(elongation=ELONGATION, yaw_deg=10.0, heights_cm=(height,), **parameters)
    locator = ObjectLocator(board.read(), board.pinhole, DetectorSettings(heights_cm=(height,)))
    found = locator.find(board.read()).objects
    return [(one, min(board.true_objects, key=lambda true: math.dist(true.point, one.point)))
            for one in found], board.pinhole


@pytest.mark.parametrize('table', [
    'grey', pytest.param('wood', marks=pytest.mark.slow)])
@pytest.mark.parametrize('height', [2.0, 5.0])
@pytest.mark.parametrize('shape', SHAPES)
@pytest.mark.parametrize('tilt_deg', [0, 30])
def test_solid_objects_are_located_to_half_a_millimetre_and_a_degree(
        tilt_deg, shape, height, table):
    pairs, surface = located(height, tilt_deg=tilt_deg, shapes=(shape,),
                             scene=SimulatedScene('still_objects', table=table))
    assert len({true.point for _, true in pairs}) == len(pairs) == 5
    errors_mm = [10 * math.dist(one.point, true.point) for one, true in pairs]
    assert np.mean(errors_mm) < 0.5 and max(errors_mm) < 1.0
    turns_deg = [math.degrees(abs(math.remainder(one.yaw - true.yaw, math.pi)))
                 for one, true in pairs]
    assert np.mean(turns_deg) < 1.0
    lengths = sorted(one.size(surface).length_cm for one, _ in pairs)
    assert lengths == pytest.approx([2.2, 2.4, 2.6, 2.8, 3.0], abs=0.2)


def test_objects_are_off_by_their_sides_where_nobody_tells_their_height():
    # So that a detector that ignores heights cannot pass.
    board = SimulatedBoard(elongation=ELONGATION, yaw_deg=10.0, heights_cm=(5.0,), tilt_deg=30,
                           shapes=('box',), scene=SimulatedScene('still_objects'))
    locator = ObjectLocator(board.read(), board.pinhole, DetectorSettings())
    found = locator.find(board.read()).objects
    assert len(found) == 5
    for one in found:
        assert min(math.dist(one.point, true.point) for true in board.true_objects) > 0.8
