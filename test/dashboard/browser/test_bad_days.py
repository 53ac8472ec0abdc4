# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Bad days: what a person reads on the page when something is broken, and what is lost."""

import os
import re
import resource
import signal
import time
from types import SimpleNamespace

from dashboard_page import wait_until
from mjpeg_server import MjpegServer
import numpy as np
import pytest
from ros_helpers import assert_in_time
from slow_line import SlowLine

pytestmark = pytest.mark.slow


def test_dead_camera_node_is_told_and_its_return(page, cell):
    cell.kill('camera_publisher')
    page.wait_for('camera_publisher', '#banner')
    assert 'published' not in page.read('#banner-text')
    page.go_to('calibrate')
    # Nobody knows any more whether there are pictures and a background.
    wait_until(lambda: not {'Camera', 'Background'} & set(page.run(
        "return [...document.querySelectorAll('.steps .done a')].map((one) => one.textContent)")),
        lambda: page.read('.steps'))
    assert page.serious_problems_by_part() == {}
    assert 'camera_publisher' in page.read('#banner')
    cell.start('camera_publisher')
    page.wait_for('published', '#banner')


def test_dead_transform_node_is_told_and_its_return(page, cell):
    cell.kill('robot_base_publisher')
    page.wait_for('robot_base_publisher', '#banner')
    assert page.serious_problems_by_part() == {}
    assert 'robot_base_publisher' in page.read('#banner')
    cell.start('robot_base_publisher')
    wait_until(lambda: 'robot_base_publisher' not in page.read('#banner'),
               lambda: page.read('#banner'))


def test_robot_node_that_is_killed_is_told_within_three_seconds_on_all_parts(page, cell):
    cell.kill('robot_base_publisher')
    killed = time.monotonic()
    wait_until(lambda: 'published' not in page.read('#banner-text'), lambda: page.read('#banner'))
    assert_in_time(time.monotonic() - killed, 3.5)
    page.wait_for('robot_base_publisher', '#banner')
    page.go_to('health')
    page.wait_for('robot_base_publisher', '#cell-state')
    cell.start('robot_base_publisher')
    page.wait_for('published', '#banner')


def test_nudge_in_the_middle_of_a_calibration_is_told_and_not_called_normal(page):
    page.go_to('calibrate')
    page.click('Start', '#part-calibrate')
    page.go_to('watch')
    page.click('Bump', '#simulated')
    page.wait_for('nudged', '#banner')
    assert 'normal' not in page.read('#banner')
    assert page.serious_problems_by_part() == {}
    assert 'nudged' in page.read('#banner')
    page.click('Put back', '#simulated')
    page.go_to('calibrate')
    page.click('Board', '#simulated')
    page.wait_for('This is normal', '#banner')
    page.keep_placement()
    assert page.serious_problems_by_part() == {}
    page.go_to('calibrate')
    page.click('Stop, and drop the placements', '#part-calibrate')
    page.click('Moving objects', '#simulated')
    page.wait_for('published', '#banner')


def test_dead_dashboard_is_told_and_its_return(page, cell):
    cell.kill('dashboard')
    page.wait_for('The dashboard does not answer', '#banner')
    page.wait_for('Not connected', 'header')
    page.go_to('detect')
    page.click('Take the background now')
    page.wait_for('Nothing was changed', '#notices')
    assert page.serious_problems() == []
    cell.start('dashboard')
    page.wait_for('Connected', '#connection')
    page.wait_for('published', '#banner')


def test_dashboard_that_hangs_is_told_and_its_return(start_cell, open_page):
    # Nothing is closed, as on a network that is cut. A cell of its own: after seconds without a
    # reader, the shared memory of Fast DDS may pass on no pictures any more.
    cell = start_cell(namespace='/hangs')
    page = open_page(cell)
    page.wait_for('published', '#banner')
    os.kill(cell.pid('dashboard'), signal.SIGSTOP)
    try:
        page.wait_for('The dashboard does not answer', '#banner')
        assert 'published' not in page.read('#banner')
        assert 'now' not in page.read('#part-watch .figures')
    finally:
        os.kill(cell.pid('dashboard'), signal.SIGCONT)
    page.wait_for('published', '#banner')
    cell.close()


def test_picture_that_comes_late_is_told_with_its_age(cell, open_page):
    line = SlowLine(cell.port, 200_000)
    try:
        page = open_page(SimpleNamespace(url=cell.url.replace(str(cell.port), str(line.port))))
        wait_until(lambda: not page.elements('#part-watch .picture.empty'), lambda: 'no picture')
        assert 'was taken' not in page.read('#part-watch .picture')
        line.bytes_per_s = 2_000
        page.wait_for('This picture was taken', '#part-watch .picture')
        # It grows older while no other one comes.
        line.bytes_per_s = 20
        wait_until(lambda: re.search(r'taken ([5-9]|\d\d) s', page.read('#part-watch .picture')),
                   lambda: page.read('#part-watch .picture'))
    finally:
        line.close()


def test_nothing_is_drawn_where_no_picture_has_come(start_cell, open_page):
    cell = start_cell('-p', 'source:=/dev/video99', namespace='/none')
    page = open_page(cell)
    page.wait_for('/dev/video99', '#banner')
    page.wait_for('Waiting for a picture', '#part-watch .picture')
    wait_until(lambda: page.elements('#part-watch .frame-grid text'), lambda: 'no grid')
    assert not page.element('#part-watch .picture > svg').is_displayed()
    assert page.serious_problems() == []
    cell.close()


OLD = '/**: {ros__parameters: {source: simulated, reach_cm: 55.5}}\n'

# Keeps the page's sockets, and each text that its banner shows.
WATCH_SOCKETS = """
window.sockets = [];
window.WebSocket = class extends WebSocket {
  constructor(...parts) { super(...parts); window.sockets.push(this); }
};
window.addEventListener('load', () => {
  const text = document.getElementById('banner-text');
  if (!text) return;
  window.shown = [];
  new MutationObserver(() => window.shown.push(text.textContent)).observe(
    text, {childList: true, characterData: true, subtree: true});
});
"""


def test_connection_that_is_closed_and_opens_again_at_once_is_not_told(cell, browser, open_page):
    script = browser.execute_cdp_cmd(
        'Page.addScriptToEvaluateOnNewDocument', {'source': WATCH_SOCKETS})
    try:
        page = open_page(cell)
        page.wait_for('published', '#banner')
        count = page.run('sockets.forEach((one) => one.close()); return sockets.length')
        wait_until(lambda: page.run(
            'return sockets.slice(arguments[0]).some((one) => one.readyState === 1)', count),
            lambda: page.read('header'))
        page.wait_for('published', '#banner')
        assert not [text for text in page.run('return shown') if 'does not answer' in text]
        assert page.read('#connection') == 'Connected'
    finally:
        browser.execute_cdp_cmd('Page.removeScriptToEvaluateOnNewDocument', script)


def test_camera_that_is_unplugged_is_told_and_its_return(cell, start_cell, open_page):
    def take_frame():
        frame = np.full((480, 640, 3), 190, np.uint8)
        frame[::40] = 170
        return frame + np.random.default_rng().integers(0, 4, frame.shape, np.uint8)

    with MjpegServer(take_frame) as camera:
        other = start_cell('-p', f'source:={camera.url}', namespace='/network')
        page = open_page(other)
        page.wait_for('/network', '#cell-choice')
        page.wait_for('The surface is not calibrated', '#banner')
        camera.kill()
        wait_until(lambda: 'error' in page.element('#banner').get_attribute('class'),
                   lambda: page.read('#banner'))
        page.wait_for(str(camera.port), '#banner')
        assert page.serious_problems_by_part() == {}
        assert str(camera.port) in page.read('#banner')
        camera.start()
        page.wait_for('The surface is not calibrated', '#banner')
        other.close()


def keep_a_placement(page):
    page.go_to('calibrate')
    page.click('Board', '#simulated')
    page.click('Start', '#part-calibrate')
    page.keep_placement()
    page.wait_for('54 corners', '#part-calibrate .placements')


def test_reload_in_the_middle_of_a_calibration_loses_nothing(page):
    keep_a_placement(page)
    page.driver.refresh()
    page.wait_for('54 corners', '#part-calibrate .placements')
    page.click('Stop, and drop the placements', '#part-calibrate')
    page.click('Moving objects', '#simulated')


def test_killed_dashboard_loses_no_placement_and_a_stop_is_undone(
        start_cell, open_page, tmp_path):
    path = tmp_path / 'cell.yaml'
    path.write_text(OLD)
    cell = start_cell(params_file=str(path), namespace='/kept')
    page = open_page(cell)
    page.wait_for('The surface is not calibrated', '#banner')
    keep_a_placement(page)
    wait_until((tmp_path / '.cell.yaml.steps').exists, lambda: 'nothing is kept')
    cell.kill('dashboard')
    page.wait_for('The dashboard does not answer', '#banner')
    cell.start('dashboard')
    page.wait_for('Connected', '#connection')
    page.wait_for('54 corners', '#part-calibrate .placements')
    page.click('Stop, and drop the placements', '#part-calibrate')
    page.click('Undo: stop', '#part-calibrate')
    page.wait_for('54 corners', '#part-calibrate .placements')
    cell.close()


def test_full_disk_is_told_on_save_and_the_old_file_stays(start_cell, open_page, tmp_path):
    path = tmp_path / 'cell.yaml'
    path.write_text(OLD)
    cell = start_cell(params_file=str(path), namespace='/disk')
    page = open_page(cell)
    page.wait_for('The surface is not calibrated', '#banner')
    page.go_to('save')
    page.wait_for(str(path), '#part-save')
    number = cell.pid('dashboard')
    limits = resource.prlimit(number, resource.RLIMIT_FSIZE)
    resource.prlimit(number, resource.RLIMIT_FSIZE, (50, limits[1]))
    try:
        page.click('Save', '#part-save')
        wait_until(lambda: page.read('#part-save .verdict') or page.read('#notices'),
                   lambda: page.read())
        assert 'cell.yaml' in page.read('#part-save .verdict') + page.read('#notices')
    finally:
        resource.prlimit(number, resource.RLIMIT_FSIZE, limits)
    assert path.read_text() == OLD
    page.click('Save', '#part-save')
    page.wait_for('Written to', '#part-save')
    page.wait_for('cell.yaml.bak.1', '#part-save')
    cell.close()
