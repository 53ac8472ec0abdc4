# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Markers in a browser: seen, learned by one click, touched by the robot in place of objects."""

from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.simulation import SimulatedBoard
from dashboard_page import wait_until
import pytest
import yaml

pytestmark = pytest.mark.slow

# The simulated robot's base frame is the tutorial's.
TRUE_FRAME = CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0)
CELL = """/**:
  ros__parameters:
    source: simulated
    simulated: {markers: true, shows: empty}
    surface:
      model: homography
      homography: {surface_from_pixel: [0.05625, 0.0, 0.0, 0.0, 0.05625, 0.0, 0.0, 0.0, 1.0]}
"""


@pytest.fixture
def page(open_page, start_cell, tmp_path):
    file = tmp_path / 'cell.yaml'
    file.write_text(CELL)
    page = open_page(start_cell(params_file=str(file)))
    page.file = file
    return page


def test_from_seen_markers_to_a_saved_base_frame(page):
    page.go_to('calibrate')
    page.wait_for('No markers are learned', '#part-calibrate')
    page.click('Look for markers', '#part-calibrate')
    page.wait_for('Seen: 0, 1, 2, 3.', '#part-calibrate')
    wait_until(lambda: len(page.elements('#part-calibrate .picture circle.pair')) == 4,
               lambda: page.read('#part-calibrate'))
    page.click('Learn these markers', '#part-calibrate')
    page.wait_for('knows the markers 0, 1, 2, 3', '#part-calibrate')
    page.go_to('robot')
    page.click('Start', '#part-robot')
    markers = SimulatedBoard(image_size=(640, 480)).true_markers
    for number, corners in markers.items():
        page.click(f'Marker {number}', '#part-robot')
        page.wait_for(f'Marker {number} lies at', '#part-robot')
        x, y, _ = TRUE_FRAME.convert_point(*corners.mean(axis=0))
        page.fill("x and y on the robot's display", f'{x:.2f} {y:.2f}')
        wait_until(lambda: len(page.elements('#part-robot tbody tr')) == number + 1,
                   lambda: page.read('#part-robot'))
    page.click('Accept: use it now', '#part-robot')
    page.wait_for('Next: save the file', '#part-robot')
    page.go_to('save')
    page.click('Save', '#part-save')
    page.wait_for('Nothing has changed', '#part-save')
    saved = yaml.safe_load(page.file.read_text())['/**']['ros__parameters']
    assert saved['markers']['numbers'] == [0, 1, 2, 3]
    assert saved['displacement_cm'] == pytest.approx([-17.8, 24.4, 0.0], abs=0.05)


@pytest.mark.parametrize('size, scheme', [((1280, 900), 'light'), ((390, 800), 'dark')])
def test_everybody_can_use_the_steps(page, size, scheme):
    page.resize(*size, scheme)
    page.go_to('calibrate')
    page.click('Look for markers', '#part-calibrate')
    page.wait_for('Seen: 0, 1, 2, 3.', '#part-calibrate')
    assert page.serious_problems() == []
    page.click('Stop looking', '#part-calibrate')
    page.resize(1280, 900)
