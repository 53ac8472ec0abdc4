# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Whether a view shows the surface of a thumbnail."""

from camera_to_base.errors import InvalidValueError
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.surface.thumbnail import read_thumbnail, shares_structure, view_thumbnail
import cv2
import numpy as np
import pytest


def wood(seed):
    """Make a surface with streaks."""
    noise = np.random.default_rng(seed).normal(0, 1, (480, 640))
    streaks = cv2.GaussianBlur(noise, (0, 0), sigmaX=25, sigmaY=6)
    grey = 150 + 25 * streaks / streaks.std()
    return np.repeat(np.clip(grey, 0, 255).astype(np.uint8)[:, :, None], 3, axis=2)


def thumbnail(picture, hidden=None):
    return read_thumbnail(view_thumbnail(picture, hidden))


@pytest.mark.parametrize('light', [
    lambda picture: picture // 3, lambda picture: 255 - (255 - picture) // 2,
    lambda picture: (picture * np.linspace(0.4, 1, 640)[None, :, None]).astype(np.uint8),
    lambda picture: np.roll(picture, (8, -12), (0, 1))])
def test_the_same_surface_is_known_in_other_light_and_after_a_nudge(light):
    assert shares_structure(thumbnail(wood(1)), light(wood(1))) is True


@pytest.mark.parametrize('seed', range(2, 8))
def test_another_surface_is_told(seed):
    assert shares_structure(thumbnail(wood(1)), wood(seed)) is False


def test_what_the_board_hid_is_not_compared():
    board = np.array([[150, 120], [500, 120], [500, 380], [150, 380]])
    with_board = cv2.fillConvexPoly(wood(1).copy(), board.astype(np.int32), (0, 0, 0))
    cv2.fillConvexPoly(with_board, (board // 2 + 150).astype(np.int32), (255, 255, 255))
    assert shares_structure(thumbnail(with_board, [board]), wood(1)) is True
    assert shares_structure(thumbnail(with_board, [board]), wood(2)) is False


def test_a_bare_surface_tells_nothing():
    plain = np.full((480, 640, 3), 180, np.uint8)
    assert shares_structure(thumbnail(plain), wood(1)) is None
    assert shares_structure(thumbnail(wood(1)), plain) is None
    assert shares_structure(thumbnail(SimulatedBoard().read()), wood(1)) is None
    everything = np.array([[0, 0], [640, 0], [640, 480], [0, 480]])
    assert shares_structure(thumbnail(wood(1), [everything]), wood(2)) is None


@pytest.mark.parametrize('text', ['no base64!', 'YWJj', view_thumbnail(wood(1))[:-40] + '===='])
def test_a_text_that_is_no_thumbnail_is_refused(text):
    with pytest.raises(InvalidValueError, match='must be a PNG of 64 x 48 px'):
        read_thumbnail(text)


def test_no_thumbnail_is_none():
    assert read_thumbnail('') is None
