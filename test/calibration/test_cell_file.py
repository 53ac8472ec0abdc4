# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A parameter file that grows: what each step adds, keeps and drops."""

from camera_to_base.calibration.cell_file import (
    BASE, cell_text, grown, parts_of, parts_to_lose, SURFACE)
from camera_to_base.parameters import read_parameter_file

OLD = {'source': '0', 'detector.threshold': 50, 'surface.model': 'homography',
       'surface.hull': [1.0, 2.0], 'surface.reject_outside_hull': True,
       'rotation_deg': [180, 0, 0], 'displacement_cm': [1, 2, 0], 'calibration.base': 'old',
       'work_area': [0, 0, 9, 0, 9, 9], 'ignored_areas': '', 'object_height_cm': 2.0,
       'surface.camera_height_cm': 60.0}
NEW = {'surface.model': 'homography', 'surface.image_size': [640, 480]}


def test_parts_are_told_by_their_parameters():
    assert parts_of(OLD) == [SURFACE, BASE]
    assert parts_of({'source': '0', 'surface.reject_outside_hull': True}) == []


def test_a_base_frame_replaces_only_itself():
    found = grown(OLD, {'rotation_deg': [0, 0, 0]}, BASE)
    assert found.dropped == []
    assert found.values == {**{name: value for name, value in OLD.items() if name not in (
        'rotation_deg', 'displacement_cm', 'calibration.base')}, 'rotation_deg': [0, 0, 0]}
    assert parts_to_lose(OLD, BASE) == [BASE]


def test_a_new_surface_drops_what_was_measured_on_the_old_one():
    found = grown(OLD, NEW, SURFACE)
    assert found.values == {
        'source': '0', 'detector.threshold': 50, 'surface.reject_outside_hull': True,
        'ignored_areas': '', **NEW}
    assert found.dropped == ['the base frame', 'work_area',
                             "object_height_cm, which needs the camera's height"]
    assert parts_to_lose(OLD, SURFACE) == [SURFACE, BASE]


def test_nothing_is_lost_where_there_was_nothing():
    assert parts_to_lose({'source': '0'}, SURFACE) == []
    assert grown({'source': '0'}, NEW, SURFACE) == ({'source': '0', **NEW}, [])


def test_file_begins_with_what_a_person_looks_for_and_ends_with_the_covariances(tmp_path):
    values = {'base_covariance': [0.1] * 21, 'surface.covariance': [0.2] * 3, **OLD, **NEW,
              'calibration.device': '/dev/video0', 'calibration.surface': '2026-01-31, new'}
    lines = cell_text(values, ['homography from a board, 2026-01-31']).splitlines()
    assert lines[1:6] == [
        '# camera      /dev/video0', '# pictures    640 x 480 px',
        '# surface     2026-01-31, new', '# base frame  old', '#']
    assert [line.split(':')[0].strip() for line in lines[9:]][:2] == ['source', 'surface']
    assert lines[-2].startswith('    base_covariance: [0.1')
    file = tmp_path / 'cell.yaml'
    file.write_text('\n'.join(lines) + '\n')
    read = read_parameter_file(file)
    assert read.values == values
    # Written again, it has one summary.
    again = cell_text(values, read.comments[1:]).splitlines()
    assert sum(line.startswith('# camera ') for line in again) == 1
