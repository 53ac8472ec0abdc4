# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What a parameter file holds of a calibration."""

from datetime import datetime, timezone

from camera_to_base.calibration.cell_file import file_status, next_step, without_report

NOW = datetime(2026, 5, 17, 12, tzinfo=timezone.utc)
SURFACE = ['Written by `calibrate` of camera_to_base.',
           'homography from a chessboard, in a.png, 2026-05-01T10:00:00+00:00',
           'for pictures of 640 x 480 px', 'error at 54 points: rms 0.12 mm',
           'warning: the points cover only 5 % of the picture']
BASE = ['rigid from pairs.csv, 2026-05-17T11:00:00+02:00', 'error at 6 points: rms 1.10 mm', '']
VALUES = {'surface.model': 'homography', 'surface.image_size': [640, 480],
          'surface.hull': [0.0, 0.0, 320.0, 0.0, 320.0, 480.0, 0.0, 480.0],
          'surface.homography.surface_from_pixel': [0.05, 0, 0, 0, 0.05, 0, 0, 0, 1.0]}
TRANSFORM = {'rotation_deg': [180.0, 0.0, 0.0], 'displacement_cm': [-17.8, 24.4, 0.0]}


def test_surface_alone_lacks_the_base_frame():
    status = file_status('cell.yaml', VALUES, SURFACE, NOW)
    assert status['holds'] == [
        'surface: homography for pictures of 640 x 480 px, from a chessboard, in a.png, '
        '2026-05-01T10:00:00+00:00 (16 days ago)', '  error at 54 points: rms 0.12 mm',
        '  measured in 50 % of the picture; outside of it the figures do not hold']
    assert status['lacks'][0].startswith("the camera's height")
    assert status['lacks'][1:] == ['the base frame']
    assert next_step('cell.yaml', VALUES) == (('base', '--live', 'cell.yaml'), '0')
    assert status['warnings'] == ['the points cover only 5 % of the picture']


def test_whole_file_is_to_be_checked():
    values = {**VALUES, **TRANSFORM, 'surface.camera_height_cm': 45.5}
    status = file_status('cell.yaml', values, [*BASE, *SURFACE], NOW)
    assert status['lacks'] == []
    assert next_step('cell.yaml', {**values, 'source': 'simulated'}) == ((), 'simulated')
    assert status['holds'][3:] == [
        'camera: 45.5 cm above the surface',
        'base frame, from pairs.csv, 2026-05-17T11:00:00+02:00 (less than a day ago)',
        '  rotation_deg: 180.00, 0.00, 0.00', '  displacement_cm: -17.80, 24.40, 0.00',
        '  error at 6 points: rms 1.10 mm']


def test_file_that_was_written_by_hand_tells_no_figures():
    status = file_status('cell.yaml', TRANSFORM, [], NOW)
    assert status['holds'][0] == ('base frame: the comments do not tell from what, when, or how '
                                  'good')
    assert status['lacks'][0] == 'the surface'
    assert next_step('my cell.yaml', TRANSFORM).arguments == (
        'board', '--camera', '0', '-o', 'my cell.yaml')


def test_older_report_of_a_base_frame_is_left_out():
    assert without_report(['mine', *BASE, *SURFACE], 'rigid') == ['mine', '', *SURFACE]
    assert without_report(SURFACE, 'rigid') == SURFACE
