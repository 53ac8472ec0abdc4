# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A person keeps the correction of a nudge with a click."""

from camera_to_base.parameters import read_parameter_file
from dashboard_page import wait_until
import pytest

pytestmark = pytest.mark.slow

BUMP = """
return fetch('/api/parameters?cell=/', {
  method: 'POST', headers: {'Content-Type': 'application/json'},
  body: JSON.stringify({node: 'camera', values: {
    'simulated.camera_shift_px': [5, -4], 'simulated.camera_turn_deg': 0.4}})
}).then((answer) => answer.status)"""


def test_the_offer_appears_after_a_nudge_and_a_click_writes_the_file(
        start_cell, open_page, tmp_path):
    path = tmp_path / 'cell.yaml'
    path.write_text('/**:\n  ros__parameters:\n    source: simulated\n    simulated:\n'
                    '      table: wood\n      shows: still_objects\n')
    page = open_page(start_cell(params_file=str(path)))
    page.wait_for('not calibrated', '#banner')
    # Nothing can be set before the node has told its parameters.
    page.go_to('detect')
    page.wait_for('detector.method', '#part-detect')
    page.go_to('save')
    page.wait_for('Nothing has changed', '#part-save')
    assert 'nudged' not in page.read('#part-save')
    assert page.run(BUMP) == 200
    page.wait_for('The camera was nudged by', '#part-save')
    assert page.serious_problems() == []
    page.click('Keep the correction', '#part-save')
    page.wait_for(f'Written to {path}', '#part-save')
    assert 'nudge' in read_parameter_file(str(path)).values['calibration.surface']
    wait_until(lambda: 'nudged' not in page.read('#part-save'), lambda: page.read('#part-save'))
