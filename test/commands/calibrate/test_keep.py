# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""`calibrate keep` and `calibrate status --live`, with a running camera node that was nudged."""

import math
import os
import re
import signal

from camera_to_base.calibration import cell_text
from camera_to_base.commands.calibrate.command import main
from camera_to_base.parameters import read_parameter_file
from camera_to_base.uncertainty import triangle_of
from mjpeg_server import MjpegServer
from nudged_table import CM_PER_PX, nudge, NudgedTable, SIZE
import numpy as np
import pytest
from ros_helpers import CAMERA_TOPIC

COIN = 300, 200
TRUE = tuple(side * CM_PER_PX for side in COIN)
MATRIX = nudge(7, -5, 3, 3, (4, -3))
RECORD = '2026-01-02T03:04:05+00:00, homography from board.png, rms 0.10 mm at 54 points'


class NudgedCamera:
    """What the stream shows: a table, a coin on it or not, seen by a camera that is nudged."""

    def __init__(self):
        self._table, self.matrix, self.coins = NudgedTable(), None, []

    def __call__(self):
        """Take a frame."""
        return self._table.shoot(self.matrix, self.coins)


class Cell:
    """A parameter file, and a camera node that runs with it in a process of its own."""

    def __init__(self, ros, start, folder, url):
        self._ros, self._start = ros, start
        self.file, self.background = str(folder / 'cell.yaml'), folder / 'background.png'
        values = {
            'source': url, 'background_file': str(self.background), 'surface.model': 'homography',
            'surface.image_size': list(SIZE), 'surface.homography.surface_from_pixel':
                [CM_PER_PX, 0.0, 0.0, 0.0, CM_PER_PX, 0.0, 0.0, 0.0, 1.0],
            'surface.homography.distortion_centre': [(side - 1) / 2 for side in SIZE],
            'surface.covariance': triangle_of(1e-12 * np.eye(14)),
            'surface.hull': [40.0, 40.0, 420.0, 40.0, 420.0, 320.0, 40.0, 320.0],
            'calibration.surface': RECORD, 'displacement_cm': [1.0, 2.0, 3.0],
            'work_area': [1.0, 1.0, 20.0, 1.0, 20.0, 15.0, 1.0, 15.0]}
        with open(self.file, 'w') as file:
            file.write(cell_text(values, ['homography from board.png, 2026-01-02T03:04:05+00:00']))
        self.positions = ros.listen(CAMERA_TOPIC)
        self.statuses = ros.listen_to_diagnostics('/camera_publisher')

    @property
    def values(self):
        """The file's parameters."""
        return read_parameter_file(self.file).values

    def run(self):
        """Start the node, and wait for its first positions."""
        node = self._start('camera_publisher', '--params-file', self.file)
        self._ros.spin_until(lambda: self.statuses, 20.0)
        return node

    def wait_for(self, kind, count=5):
        """Wait until the node gives this reason, and then for as many positions."""
        self.statuses.clear()
        assert self._ros.spin_until(
            lambda: self.statuses and self.statuses[-1].values['reason'] == kind, 20.0), (
                self.statuses[-1:])
        self.positions.clear()
        assert self._ros.spin_until(lambda: len(self.positions) >= count, 20.0)
        return 10 * max(math.dist(position, TRUE) for position in self.positions)


@pytest.fixture
def camera():
    return NudgedCamera()


@pytest.fixture
def cell(ros, start, tmp_path, camera):
    with MjpegServer(camera, quality=95) as server:
        cell = Cell(ros, start, tmp_path, server.url)
        cell.node = cell.run()
        assert ros.spin_until(cell.background.exists, 20.0)
        camera.coins = [COIN]
        assert cell.wait_for('ok') < 0.1
        yield cell


@pytest.mark.slow
def test_kept_correction_holds_for_the_running_node_and_for_a_restarted_one(
        cell, camera, run_main, tell):
    camera.matrix = MATRIX
    corrected_mm = cell.wait_for('view_corrected')
    before = cell.values
    code, output, _ = run_main(main, 'status', '--live', cell.file)
    assert code == 0 and 'the camera was nudged by 11.' in output
    assert re.search(f'next: .*calibrate.* keep {cell.file}\n', output)
    assert cell.values == before  # to ask changes nothing

    code, output, error = run_main(main, 'keep', cell.file)
    assert code == 0 and error == '' and 'warning' not in output
    assert f'the old one is kept: {cell.file}.bak' in output
    running_mm = cell.wait_for('ok')
    after = cell.values
    assert 'board.png' in after['calibration.surface'] and 'nudge' in after['calibration.surface']
    changed = {name for name in after if after[name] != before.get(name)}
    assert all(name.startswith(('surface.', 'calibration.surface')) for name in changed)

    assert cell.node.end(signal.SIGTERM, 10.0) == 0
    node = cell.run()
    restarted_mm = cell.wait_for('ok')
    tell(f'positions off by {corrected_mm:.2f} mm when corrected, {running_mm:.2f} mm when kept, '
         f'{restarted_mm:.2f} mm after a restart')
    assert max(corrected_mm, running_mm, restarted_mm) < 0.2
    assert node.end(signal.SIGTERM, 10.0) == 0
    assert 'the camera was nudged' not in node.output


@pytest.mark.slow
def test_node_that_dies_before_it_writes_its_background_is_silent_not_wrong(
        cell, camera, run_main, ros):
    camera.matrix = MATRIX
    cell.wait_for('view_corrected')
    old = cell.background.read_bytes()
    assert run_main(main, 'keep', cell.file)[0] == 0
    cell.wait_for('ok')
    cell.node.kill()
    ros.spin_for(0.5)  # what it published before may still be on its way
    cell.background.write_bytes(old)
    os.utime(cell.background, (1e9, 1e9))
    cell.positions.clear()
    cell.statuses.clear()
    cell.run()
    assert ros.spin_until(lambda: any(
        status.values['reason'] == 'view_moved' for status in cell.statuses), 20.0)
    assert cell.positions == []


@pytest.mark.slow
def test_camera_that_stands_still_has_nothing_to_keep(cell, run_main):
    before = cell.values
    code, _, error = run_main(main, 'keep', cell.file)
    assert code == 1 and 'there is no correction to keep' in error
    code, output, _ = run_main(main, 'status', '--live', cell.file)
    assert code == 0 and 'there is no correction to keep' in output
    assert cell.values == before


@pytest.mark.slow
def test_correction_is_not_written_into_the_file_of_another_surface(
        cell, camera, run_main, tmp_path):
    camera.matrix = MATRIX
    cell.wait_for('view_corrected')
    other = tmp_path / 'other.yaml'
    values = {**cell.values, 'surface.homography.distortion_coefficient': -0.1}
    other.write_text(cell_text(values))
    before = other.read_bytes()
    code, _, error = run_main(main, 'keep', other)
    assert code == 1 and 'has another surface.homography.distortion_coefficient' in error
    assert other.read_bytes() == before


@pytest.mark.slow
def test_without_a_node_nothing_is_kept(run_main, tmp_path):
    file = tmp_path / 'cell.yaml'
    file.write_text(cell_text({'surface.parallel.width_cm': 30.0}))
    before = file.read_bytes()
    code, _, error = run_main(main, 'keep', file, '--namespace', 'nobody')
    assert code == 1 and '/nobody/camera_publisher does not run' in error
    assert file.read_bytes() == before
