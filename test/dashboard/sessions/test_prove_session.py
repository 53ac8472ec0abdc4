# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The proof of a calibration: what is published beside where the robot touches."""

import json
import time
import zipfile

from camera_to_base.errors import CameraToBaseError
from camera_to_base.settings import camera_settings
import pytest
from session_cell import Cell

ELLIPSE = {'major_mm': 1.0, 'minor_mm': 0.5, 'angle_deg': 90.0, 'frame': 'base'}
PLACE = (12.0, 9.0)


def published(x, y, base, ellipse=ELLIPSE):
    """Return an object as the page shows it."""
    return {'number': 1, 'camera': {'x': x, 'y': y, 'yaw_deg': None},
            'base': base and {'x': base[0], 'y': base[1], 'yaw_deg': None}, 'ellipse': ellipse}


def calibrated(params_file=''):
    one = Cell(params_file, **{
        'surface.model': 'parallel', 'surface.width_cm': 36.0, 'calibration.surface': 'by hand'})
    one.values['transform']['calibration.base'] = 'by hand'
    one.tell()
    return one


@pytest.fixture
def cell():
    """Return a cell whose surface and base frame are calibrated by hand."""
    return calibrated()


def click(cell, point=PLACE):
    (u, v), = camera_settings(cell.values['camera']).surface.pixels([point])
    return cell.do('prove', 'see', u=u, v=v)


def wait_for(condition, seconds=30):
    end = time.monotonic() + seconds
    while not (result := condition()):
        assert time.monotonic() < end
        time.sleep(0.02)
    return result


def prove(cell, true, base=(-5.8, 15.4), ellipse=ELLIPSE):
    """Prove a place that is published at `base`, and truly is at `true`, in cm."""
    click(cell)
    for number in range(20):
        cell.sessions.see_published(number, [
            published(PLACE[0] + 9.0, PLACE[1], (0.0, 0.0)), published(*PLACE, base, ellipse)])
    return cell.do('prove', 'touch', text=f'{true[0]} {true[1]}')


def test_nothing_can_be_proved_before_both_frames_are_calibrated():
    cell = Cell()
    assert 'There is no surface yet' in cell.state('prove')['needs']
    cell.values['camera']['calibration.surface'] = 'by hand'
    cell.tell()
    assert 'The base frame is not calibrated' in cell.state('prove')['needs']
    with pytest.raises(CameraToBaseError, match='The base frame is not calibrated'):
        click(cell)


def test_error_is_judged_by_the_published_ellipse(cell):
    state = prove(cell, (-5.8, 15.31))
    proof, = state['proofs']
    assert proof['error_mm'] == {'x': 0.0, 'y': 0.9} and proof['within'] is True
    assert state['good'] and '0.90 mm off; 1 of 1 within the 95 % ellipse' in state['sentence']
    # As far off, but across the ellipse.
    state = prove(cell, (-5.71, 15.4))
    assert state['proofs'][1]['within'] is False and state['good'] is False
    assert '1 of 2 within' in state['sentence'] and 'worse than they say' in state['sentence']


def test_position_is_the_mean_of_twenty_different_frames(cell):
    click(cell)
    for stamp in (1, 1, 1, 2):
        cell.sessions.see_published(stamp, [published(*PLACE, (0.0, 0.0))])
    assert cell.state('prove')['open']['frames'] == 2
    with pytest.raises(CameraToBaseError, match='wait until it is measured'):
        cell.do('prove', 'touch', text='1 2')
    for stamp in range(3, 21):
        cell.sessions.see_published(stamp, [published(*PLACE, (0.02, 0.0))])
    assert cell.state('prove')['open']['seen']['x'] == pytest.approx(0.018)


def test_object_that_moves_or_has_no_base_position_is_not_compared(cell):
    for bases, why in (([(0.0, 0.0), (1.0, 0.0)], 'the object has moved'),
                       ([None, None], 'no position of this object is published')):
        click(cell)
        for stamp in range(20):
            cell.sessions.see_published((why, stamp), [published(*PLACE, bases[stamp % 2])])
        state = cell.state('prove')
        assert why in state['error'] and state['open'] is None


def test_proof_does_not_count_for_another_calibration(cell):
    assert prove(cell, (-5.8, 15.4))['good'] is True
    cell.values['transform']['displacement_cm'] = [1.0, 2.0, 0.0]
    cell.tell()
    state = cell.state('prove')
    assert 'another calibration' in state['proofs'][0]['invalid_because']
    assert state['good'] is None and state['sentence'] is None


def test_without_an_ellipse_nothing_is_called_good(cell):
    state = prove(cell, (-5.8, 15.4), ellipse=None)
    assert state['good'] is None and 'not known how much' in state['sentence']


def test_removed_place_comes_back(cell):
    prove(cell, (-5.8, 15.4))
    assert cell.do('prove', 'remove', number=1)['proofs'] == []
    assert [one['number'] for one in cell.do('prove', 'undo')['proofs']] == [1]
    with pytest.raises(CameraToBaseError, match='there is no place'):
        cell.do('prove', 'remove', number=7)


def test_proofs_are_there_after_a_restart_of_the_dashboard(tmp_path):
    cell = calibrated(tmp_path / 'cell.yaml')
    prove(cell, (-5.8, 15.31))
    before = prove(cell, (-5.8, 15.2), ellipse=None)
    cell.sessions.close()
    again = calibrated(tmp_path / 'cell.yaml')
    after = again.state('prove')
    assert after['proofs'] == before['proofs'] and after['sentence'] == before['sentence']
    assert all(proof['invalid_because'] is None for proof in after['proofs'])
    assert prove(again, (-5.8, 15.4))['proofs'][-1]['number'] == 3
    for number in (1, 2, 3):
        again.do('prove', 'remove', number=number)
    again.sessions.close()
    assert list(tmp_path.iterdir()) == []


def test_file_of_proofs_that_somebody_has_broken_gives_none(tmp_path):
    cell = calibrated(tmp_path / 'cell.yaml')
    prove(cell, (-5.8, 15.31))
    cell.sessions.close()
    path, = tmp_path.iterdir()
    with zipfile.ZipFile(path) as file:
        steps = json.loads(file.read('steps.json'))
    for broken in ('no list', [[1]], [[1, [0, 0], [0, 0], [0, None], None, {}]],
                   [[1, [0, 0], [0, 0], [0, 0], {'major_mm': 'x'}, {}]]):
        with zipfile.ZipFile(path, 'w') as file:
            file.writestr('steps.json', json.dumps({**steps, 'prove': broken}))
        assert calibrated(tmp_path / 'cell.yaml').state('prove')['proofs'] == []


def test_steps_that_cannot_be_kept_are_told_until_they_are(tmp_path):
    folder = tmp_path / 'cell'
    folder.mkdir()
    cell = calibrated(folder / 'cell.yaml')
    folder.rmdir()
    prove(cell, (-5.8, 15.31))
    told = wait_for(lambda: cell.sessions.setup.not_kept)
    assert 'No such file' in told
    folder.mkdir()
    prove(cell, (-5.8, 15.31))
    wait_for(lambda: cell.sessions.setup.not_kept is None)
    cell.sessions.close()
