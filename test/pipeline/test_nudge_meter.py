# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""How well a nudge is measured on a surface, and when it is not."""

from camera_to_base.pipeline.view.nudge import NudgeMeter
from camera_to_base.surface import RadialDistortion
from camera_to_base.uncertainty import warp_design
import cv2
from nudged_table import grid, HEIGHT, nudge, NudgedTable, plain, SIZE, WIDTH
import numpy as np
import pytest

PLACES = np.stack(np.meshgrid(np.linspace(20, WIDTH - 21, 6), np.linspace(20, HEIGHT - 21, 5)),
                  axis=2).reshape(-1, 2)
NUDGES = {
    'none': nudge(), 'shift': nudge(11, -8), 'turn': nudge(2, 1, turn=12),
    'zoom': nudge(0, -3, growth=-9), 'tilt': nudge(5, 4, tilt=(8, -10)),
    'all': nudge(-6, 5, 4, 5, (-6, 5))}


def errors_px(measured, matrix, lens=None):
    """Give how far each of PLACES is off in the frame, shape (n, 2)."""
    undistorted = PLACES if lens is None else lens.undistort(PLACES)
    true = cv2.perspectiveTransform(undistorted[None], matrix)[0]
    true = true if lens is None else lens.distort(true)
    return measured.frame_from_background.pixels(PLACES) - true


@pytest.mark.parametrize('matrix', NUDGES.values(), ids=NUDGES)
@pytest.mark.parametrize('scene', [{}, {'arm': True}, {'light': 0.6}, {'coins': [(200, 150)]}],
                         ids=['empty', 'arm', 'light', 'coin'])
def test_nudge_is_measured_to_a_fraction_of_a_pixel(matrix, scene):
    table = NudgedTable()
    meter = NudgeMeter(table.shoot(), None)
    measured = meter.measure(table.shoot(matrix, **scene))
    off = np.hypot(*errors_px(measured, matrix).T)
    assert off.mean() < 0.1 and off.max() < 0.5


def test_nudge_is_a_homography_of_undistorted_pixels():
    lens = RadialDistortion.of_picture(SIZE, -0.2)
    table, matrix = NudgedTable(coefficient=-0.2), NUDGES['all']
    background, frame = table.shoot(), table.shoot(matrix)
    right, wrong = (NudgeMeter(background, one).measure(frame) for one in (lens, None))
    assert np.hypot(*errors_px(right, matrix, lens).T).max() < 0.3
    assert isinstance(wrong, str) or np.hypot(*errors_px(wrong, matrix, lens).T).max() > 0.5


@pytest.mark.slow
def test_covariance_describes_the_errors():
    squares = []
    for seed in range(12):
        table = NudgedTable(seed=seed)
        measured = NudgeMeter(table.shoot(), None).measure(table.shoot(NUDGES['all']))
        off = errors_px(measured, NUDGES['all'])
        design = warp_design(PLACES, SIZE, None)[:, :, :8]
        spread = design @ measured.covariance @ design.transpose(0, 2, 1)
        squares.append(np.einsum('ni,nij,nj->n', off, np.linalg.inv(spread), off).mean() / 2)
    assert 0.3 < np.mean(squares) < 2.0


@pytest.mark.parametrize('surface, doubt', [(plain, 'too few corners'), (grid, 'repeats itself')])
def test_surface_that_cannot_tell_a_nudge_gives_none(surface, doubt):
    table = NudgedTable(surface)
    assert doubt in NudgeMeter(table.shoot(), None).measure(table.shoot(nudge(10, 2)))


def test_corners_of_a_part_of_the_picture_are_not_believed():
    table = NudgedTable()
    background, frame = table.shoot(), table.shoot(nudge(6, 2))
    for picture in background, frame:
        picture[:, 200:] = 150
    assert 'corners' in NudgeMeter(background, None).measure(frame)


def test_sheet_that_moves_on_the_table_is_not_followed():
    table = NudgedTable()
    background, moved = table.shoot(), table.shoot(nudge(10, 4))
    frame = table.shoot()
    frame[40:220, 40:240] = moved[40:220, 40:240]
    measured = NudgeMeter(background, None).measure(frame)
    assert np.hypot(*errors_px(measured, nudge()).T).max() < 0.3


def test_lens_of_the_uncertainty_is_that_of_the_surface():
    lens = RadialDistortion.of_picture(SIZE, -0.2)
    table = NudgedTable(coefficient=-0.2)
    measured = NudgeMeter(table.shoot(), lens).measure(table.shoot(NUDGES['shift']))
    design = warp_design(PLACES, SIZE, lens)[:, :, :8]
    spread = design @ measured.covariance @ design.transpose(0, 2, 1)
    assert np.sqrt(np.linalg.eigvalsh(spread)[:, 1]).max() < 0.5
