# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""`calibrate board` with a board that lies in several places, one picture each."""

from functools import partial
import io
import json
from pathlib import Path
import time

from camera_to_base.commands.calibrate.command import main
from camera_to_base.commands.calibrate.live_camera import FreshFrames
from camera_to_base.settings import read_node_settings
from camera_to_base.sources import DEVICE
import cv2
import numpy as np
import pytest
from rendered_board import IMAGE_SIZE, pixel_from_surface, project, render

CAMERA = pixel_from_surface(25, 10, away_cm=90.0)
# Turn in degrees and shift in cm of each further place.
PLACES = [(0, -12.0, -10.0), (8, 14.0, -9.0), (-5, -13.0, 11.0), (176, 35.0, 22.0)]


@pytest.fixture
def run(run_main):
    """Run the command; give exit code, standard output and standard error."""
    return partial(run_main, main)


def placed(turn_deg, x, y):
    turn = np.radians(turn_deg)
    return np.array([[np.cos(turn), -np.sin(turn), x], [np.sin(turn), np.cos(turn), y],
                     [0, 0, 1]])


def pictures(places=PLACES, camera=CAMERA, coefficient=-0.15):
    names = []
    for number, place in enumerate(places):
        names.append(f'{number}.png')
        cv2.imwrite(names[-1], render(
            camera @ placed(*place), coefficient=coefficient, noise=2, seed=number))
    return names


def test_four_places_calibrate_the_whole_picture(run):
    code, output, error = run('board', *pictures(), '-o', 'cell.yaml', '--json')
    assert (code, error) == (0, '')
    report = json.loads(output)
    assert report['points'] == 216 and report['source'].endswith('3.png, in 4 places')
    surface = read_node_settings('cell.yaml').camera.surface
    # In the first place's frame, all over the picture.
    x, y = np.meshgrid(np.linspace(-10, 40, 9), np.linspace(-8, 30, 7))
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    pixels = project(CAMERA @ placed(*PLACES[0]), points, -0.15)
    seen = ((pixels > 0) & (pixels < np.array(IMAGE_SIZE) - 1)).all(axis=1)
    assert seen.sum() > 40
    errors = 10 * np.linalg.norm(surface.locate(pixels[seen]) - points[seen], axis=1)
    assert errors.max() < 1.0
    # One place alone knows the surface there only.
    assert run('board', '0.png', '-o', 'one.yaml')[0] == 0
    alone = read_node_settings('one.yaml').camera.surface
    worse = 10 * np.linalg.norm(alone.locate(pixels[seen]) - points[seen], axis=1)
    assert errors.max() < worse.max() / 3


@pytest.mark.slow
def test_origin_options_move_the_frame_of_the_first_place_alone(run):
    names = pictures()
    for corner in range(4):
        code, _, error = run('board', *names, '--origin-corner', corner, '--yaw-deg', 20,
                             '-o', f'{corner}.yaml')
        assert code == 0, error
    surface = read_node_settings('0.yaml').camera.surface
    first = project(CAMERA @ placed(*PLACES[0]), np.array([[0.0, 0.0]]), -0.15)
    np.testing.assert_allclose(surface.locate(first), [[0, 0]], atol=0.05)


def seen_from(**camera):
    return render(pixel_from_surface(29, 10, **camera) @ placed(*PLACES[2]), coefficient=-0.15)


@pytest.mark.slow
def test_a_camera_that_was_moved_a_little_is_doubted(run):
    names = pictures(PLACES[:2])
    cv2.imwrite('c.png', seen_from(away_cm=85.0))
    code, output, _ = run('board', *names, 'c.png', '-o', 'cell.yaml')
    assert code == 0
    assert 'warning: the placements of the board do not fit each other' in output


@pytest.mark.slow
@pytest.mark.parametrize('spoil, said', [
    (lambda: cv2.imread('1.png'), 'the board lies in the same place twice, in 1.png and in c.png'),
    (lambda: cv2.imread('1.png')[:, :600],
     '640 x 480 px in 0.png, but 600 x 480 px in c.png: use pictures of one size'),
    (lambda: np.zeros((480, 640, 3), np.uint8),
     'c.png: no chessboard with 9 x 6 inner corners found'),
    (lambda: seen_from(away_cm=75.0),
     'the placements of the board do not fit each other: number')])
def test_pictures_that_do_not_belong_together_are_refused(run, spoil, said):
    names = pictures(PLACES[:2])
    cv2.imwrite('c.png', spoil())
    code, output, error = run('board', *names, 'c.png', '-o', 'cell.yaml')
    assert (code, output) == (1, '') and said in error and error.count('\n') == 1
    assert not Path('cell.yaml').exists()


@pytest.mark.slow
def test_q_ends_with_the_placements_so_far(run, monkeypatch):
    video = cv2.VideoWriter('a.avi', cv2.VideoWriter_fourcc(*'MJPG'), 10.0, IMAGE_SIZE)
    for number in range(40):
        place = PLACES[0] if number < 9 else PLACES[1]
        video.write(render(CAMERA @ placed(*place), noise=1, seed=number))
    video.release()
    monkeypatch.setattr('sys.stdin', io.StringIO('\nq\n'))
    code, output, error = run(
        'board', '--camera', 'a.avi', '--placements', '4', '--json', '-o', 'cell.yaml')
    assert code == 0, error
    assert '2 of 4 taken' in error and 'q to end with those so far' in error
    assert json.loads(output)['points'] == 108


class WaitingFrames:
    """A camera whose frames wait in a buffer until they are read; the first pixel counts them."""

    kind = DEVICE

    def __init__(self):
        self._begun, self._number = time.monotonic(), 0
        self._picture = np.random.default_rng(0).integers(0, 255, (48, 64, 3), np.uint8)

    def read(self):
        self._number += 1
        time.sleep(max(0.0, self._begun + 0.01 * self._number - time.monotonic()))
        frame = self._picture.copy()
        frame[0, 0, :2] = divmod(self._number, 256)
        return frame

    def release(self):
        pass


def test_frames_that_came_before_the_key_are_not_used():
    camera = WaitingFrames()
    begun, frames = time.monotonic(), FreshFrames(camera, 'the camera')
    try:
        time.sleep(0.3)
        frames.drop()
        pressed = (time.monotonic() - begun) / 0.01
        high, low = map(int, frames.read()[0, 0, :2])
        # One that is not read all the time gives the frame after the first few.
        assert 256 * high + low >= pressed - 10
    finally:
        frames.release()
