# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The whole way in a browser, from a new simulated camera to a file that a new start uses."""

import time

from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from dashboard_page import wait_until
from geometry_msgs.msg import PoseArray
import numpy as np
import pytest
import yaml

pytestmark = pytest.mark.slow

# The simulated robot's base frame is the tutorial's.
TRUE_FRAME = CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0)
PLACES = (1, 2, 3, 4)
PAIRS = 5
MOST_CLICKS = 40


@pytest.fixture
def way(open_page, start_cell, tmp_path):
    file = tmp_path / 'cell.yaml'
    file.write_text('/**:\n  ros__parameters:\n    source: simulated\n')
    cell = start_cell(params_file=str(file))
    return open_page(cell), cell, file


def place_board(page, place):
    """Lay the simulated board down, and wait until it can be kept."""
    select = page.element('#placement')
    page.run("arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('change'))",
             select, str(place))
    page.clicks += 2


def calibrate_board(page):
    page.go_to('calibrate')
    page.click('Board', '#simulated')
    page.click('Start', '#part-calibrate')
    for place in PLACES:
        place_board(page, place)
        page.keep_placement(place)
    page.click('Fit', '#part-calibrate')
    page.click('Accept: use it now', '#part-calibrate')
    page.wait_for('Next: clear the table', '#part-calibrate')


def take_background(page):
    page.click('Nothing', '#simulated')
    time.sleep(0.5)
    page.go_to('detect')
    page.click('Take the background now')
    page.wait_for('The background is new', '#notices')


def measure_pairs(page):
    page.click('Objects at rest', '#simulated')
    page.go_to('robot')
    page.click('Start', '#part-robot')
    wait_until(lambda: page.button(f'Object {PAIRS}', '#part-robot'), lambda: page.read())
    for number in range(1, PAIRS + 1):
        page.click(f'Object {number}', '#part-robot')
        page.click(f'Object {number}', '#simulated')
        page.wait_for("robot's display", '#part-robot')
        x, y = display(page, number)
        page.fill("x and y on the robot's display", f'{x} {y}')
        wait_until(lambda: len(page.elements('#part-robot tbody tr')) == number,
                   lambda: page.read('#part-robot'))
    page.click('Accept: use it now', '#part-robot')
    page.wait_for('Next: save the file', '#part-robot')


def display(page, number):
    """Read the simulated robot's display once it touches an object."""
    button = page.button(f'Object {number}', '#simulated')
    wait_until(lambda: button.get_attribute('aria-pressed') == 'true'
               and 'cm' in page.read('#simulated .display'), lambda: page.read('#simulated'))
    time.sleep(0.5)  # a person reads slower than the display changes
    words = page.read('#simulated .display').replace('−', '-').split()
    return words[1], words[3]


def listed(page):
    """Return the base positions in the list, in cm; None while they are not all there."""
    texts = page.run("return [...document.querySelectorAll('#part-watch .numbers tbody tr')]"
                     '.map((row) => row.cells[1].textContent.replaceAll("−", "-"))')
    pairs = [[float(number) for number in text.split(', ')] for text in texts if ', ' in text]
    return pairs if len(pairs) == PAIRS else None


def true_positions(ros):
    """Return where the simulated objects lie in the base frame, shape (n, 2), in cm."""
    messages = ros.listen_to(PoseArray, '/true_objects_in_cam_frame')
    ros.spin_until(lambda: messages and messages[-1].poses)
    ros.stop_listening('/true_objects_in_cam_frame')
    return np.array([TRUE_FRAME.convert_point(
        100 * pose.position.x, 100 * pose.position.y)[:2] for pose in messages[-1].poses])


def largest_error_mm(page, ros):
    """Return how far the listed objects are from the nearest true ones, at most."""
    page.go_to('watch')
    found = np.array(wait_until(lambda: listed(page), lambda: page.read('#part-watch')))
    true = true_positions(ros)
    away = np.linalg.norm(found[:, None] - true[None], axis=2)
    assert len(set(away.argmin(axis=1))) == PAIRS
    return 10 * away.min(axis=1).max()


def test_whole_way_from_a_new_camera_to_a_saved_cell(way, start_cell, open_page, ros, tell):
    page, cell, file = way
    page.wait_for('Save', '.setup .steps')
    assert 'done' not in page.element('.setup a[href="#save"] + .state').text
    began = time.monotonic()
    calibrate_board(page)
    take_background(page)
    measure_pairs(page)
    page.go_to('save')
    page.click('Save', '#part-save')
    page.wait_for('Nothing has changed', '#part-save')
    took = time.monotonic() - began
    clicks, typed = page.clicks, len(page.typed)
    for part in ('calibrate', 'robot', 'prove', 'save'):
        page.go_to(part)
        assert page.serious_problems() == [], part
        assert 'take the background' not in page.read(f'#part-{part}'), part
    before = largest_error_mm(page, ros)
    saved = yaml.safe_load(file.read_text())
    cell.close()

    again = open_page(start_cell(params_file=str(file)))
    again.click('Objects at rest', '#simulated')
    after = largest_error_mm(again, ros)
    tell(f'whole way in a browser: {took:.0f} s, {clicks} clicks, {typed} fields typed; '
         f'{before:.2f} mm off at most, {after:.2f} mm after a new start')
    assert saved
    assert clicks <= MOST_CLICKS and typed <= PAIRS
    assert before < 1.0
    assert after < 1.0
