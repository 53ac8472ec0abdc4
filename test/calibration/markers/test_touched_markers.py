# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.
"""Surface and base frame from four touched markers, with lenses of another model than ours."""

from camera_to_base.calibration import calibrate_touched_markers, markers_to_touch
from camera_to_base.errors import CalibrationError
from camera_to_base.markers import see_markers
from camera_to_base.parameters import checked_values, TRANSFORM_SPECS
from camera_to_base.surface import make_surface, RadialDistortion, SURFACE_SPECS
from camera_to_base.uncertainty import (
    position_uncertainty, uncertain_transform_of, UNCERTAINTY_SPECS)
import numpy as np
import pytest
from rendered_markers import Camera, marker_corners, Table

SIZE = (1280, 720)
AREA = np.stack(np.meshgrid(np.linspace(2, 38, 7), np.linspace(2, 28, 6)), axis=-1).reshape(-1, 2)
# Where the robot stands: y is seen clockwise from x on the table, anticlockwise in its frame.
TURN, PLACE = np.array([[0.8, 0.6], [0.6, -0.8]]), np.array([12.0, -31.0])


def base(points):
    return np.asarray(points) @ TURN.T + PLACE


def touches(error_cm=0.0, seed=0):
    rng = np.random.default_rng(seed)
    return {number: base(corners.mean(axis=0)) + rng.normal(0, error_cm, 2)
            for number, corners in marker_corners().items()}


class View:
    """Finds the markers in one rendered frame."""

    def __init__(self, **camera):
        self.camera = Camera(**camera)
        self._frame = self.camera.frame(Table(), np.random.default_rng(0))

    def __call__(self, lens):
        return [see_markers(self._frame, lens).corners]


@pytest.fixture(scope='module')
def look():
    return View()


def calibrate(look, touched, marker_mm=40.0, **others):
    return calibrate_touched_markers(
        look, touched, marker_mm, SIZE, source='a picture', **others).calibration


def errors(values, camera, points):
    """Return errors in the base frame, in cm, (n, 2), and their covariances."""
    known = {**checked_values([*SURFACE_SPECS, *UNCERTAINTY_SPECS], values),
             'detector.method': 'precise', 'uncertainty.centre_floor_px': 0.0,
             'uncertainty.height_tolerance_cm': 0.0}
    surface, transform = make_surface(known), uncertain_transform_of(
        checked_values(TRANSFORM_SPECS, values))
    uncertainty = position_uncertainty(known, surface)
    missed, covariances = [], []
    for pixel, true in zip(camera.project(points), base(points)):
        found = (*surface.locate([pixel])[0], 0.0)
        missed.append(transform.settings.conversion.convert_point(*found)[:2] - true)
        covariances.append(transform.base_covariance(
            found, uncertainty.of_pixel(pixel, SIZE).matrix)[:2, :2])
    return np.array(missed), np.array(covariances)


@pytest.mark.parametrize('camera', [
    {'tilt_deg': 0.0, 'lens': (-0.22, 0.05)}, {'tilt_deg': 32.0, 'away_cm': 60.0},
    {'roll_deg': 180.0, 'lens': (0.02, 0.0), 'focal_px': 900.0}],
    ids=['strong lens', 'tilted', 'no distortion'])
def test_positions_are_within_the_uncertainty_that_is_told(camera):
    look = View(**camera)
    missed, covariances = errors(calibrate(look, touches(0.08, seed=1)).values, look.camera, AREA)
    squares = np.einsum('ij,ij->i', missed,
                        np.linalg.solve(covariances, missed[:, :, None])[:, :, 0])
    assert (squares < 9.21).mean() >= 0.95
    assert 10 * np.linalg.norm(missed, axis=1).max() < 3
    # Not so large that it says nothing.
    assert 10 * np.sqrt(np.linalg.eigvalsh(covariances).max()) < 3


def test_worse_touches_give_a_larger_uncertainty(look):
    def told(error_cm):
        return errors(calibrate(look, touches(error_cm, seed=4)).values, look.camera, AREA)[1]
    assert told(0.25).mean(axis=0).trace() > 1.5 * told(0.02).mean(axis=0).trace()


def test_lens_is_said_to_be_not_measured(look):
    report = calibrate(look, touches()).report
    assert 'lens not measured' in report['source']
    assert abs(report['distortion_coefficient'] + 0.06) < 3 * report['lens_deviation']


def test_robot_that_counts_z_downwards(look):
    touched = {number: (x, -y) for number, (x, y) in touches().items()}
    with pytest.raises(CalibrationError, match='mirrored.*--base-z down'):
        calibrate(look, touched)
    values = calibrate(look, touched, base_z='down').values
    assert values['rotation_deg'][:2] == pytest.approx([0, 0])


@pytest.mark.parametrize('change, told', [
    ({0: 1, 1: 0}, 'markers 0 and 1 are swapped'),
    ({0: 2, 2: 0}, 'markers 0 and 2 are swapped'),
    ({2: 3, 3: 2}, 'markers 2 and 3 are swapped')])
def test_swapped_touches_are_named(look, change, told):
    right = touches(0.05)
    with pytest.raises(CalibrationError, match=told):
        calibrate(look, {number: right[change.get(number, number)] for number in right})


@pytest.mark.parametrize('marker_mm', [50.0, 37.0, 30.0])
def test_wrong_size_is_named(look, marker_mm):
    with pytest.raises(CalibrationError, match=f'edges are (39|40|41).* not {marker_mm:g} mm'):
        calibrate(look, touches(0.05), marker_mm)


@pytest.mark.parametrize('off_cm', [2.0, 8.0])
def test_touch_beside_its_marker_is_named(look, off_cm):
    touched = touches(0.05)
    touched[3] = touched[3] + [0.6 * off_cm, 0.8 * off_cm]
    with pytest.raises(CalibrationError, match='marker 3 was touched .* mm from where'):
        calibrate(look, touched)


def test_touch_that_is_a_little_off_is_a_warning(look):
    touched = touches(0.03)
    touched[1] = touched[1] + [0.5, 0.4]
    assert 'marker 1 was touched' in ' '.join(calibrate(look, touched).report['warnings'])


@pytest.mark.parametrize('points, told', [
    ([(0, 0), (10, 0), (20, 0), (30, 0)], 'were touched on one line'),
    ([(0, 0), (10, 0), (20, 0), (30, 9)], 'all markers but 3 were touched on one line'),
    ([(0, 0), (0, 0.1), (20, 30), (30, 0)], 'markers 0 and 1 were touched at the same place'),
    ([(0.1, 0), (0.4, 0), (0.4, 0.3), (0.1, 0.3)], 'in m instead of cm'),
    ([(3, 7), (40, 60), (-9, 12), (25, -30)], 'touch')])
def test_impossible_touches_are_refused(look, points, told):
    with pytest.raises(CalibrationError, match=told):
        calibrate(look, dict(enumerate(map(np.array, points))))


def test_marker_that_is_not_seen_is_named():
    places = {0: (2.0, 2.0, 0.0), 1: (38.0, 2.0, 0.0), 3: (2.0, 28.0, 0.0)}
    frame = Camera().frame(Table(places), np.random.default_rng(0))
    seen = see_markers(frame, RadialDistortion.of_picture(SIZE)).corners
    with pytest.raises(CalibrationError, match='marker 2 is not seen, only 0, 1, 3'):
        markers_to_touch([seen])
