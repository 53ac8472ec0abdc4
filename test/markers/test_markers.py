# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Markers in pictures: their corners, and the surface anew from them, on rendered tables."""

from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.markers import find as aruco
from camera_to_base.markers.find import corners_by_edges, see_markers
from camera_to_base.markers.fit import known_markers, MARKER_SPECS, marker_values, outward_moves
from camera_to_base.markers.marked_surface import MarkedSurface, new_surface_values
from camera_to_base.parameters import default_values
from camera_to_base.surface import (
    HomographySurface, Hull, RadialDistortion, SURFACE_DEFAULTS, surface_values)
from camera_to_base.uncertainty import SURFACE_COVARIANCE, triangle_of
import cv2
import numpy as np
import pytest
from rendered_markers import Camera, marker_corners, PLACES, random_camera, Table

SIZE = (1280, 720)
PLAIN = RadialDistortion.of_picture(SIZE)
AREA = np.stack(np.meshgrid(np.linspace(2, 38, 7), np.linspace(2, 28, 6)), axis=-1).reshape(-1, 2)


@pytest.fixture(scope='module')
def table():
    return Table()


@pytest.fixture(scope='module')
def frame(table):
    return CAMERA.frame(table, np.random.default_rng(1))


def pinhole(**place):
    return Camera(lens=(0.0, 0.0), **place)


CAMERA = pinhole()


def surface_of(camera):
    """Return the surface of a camera without distortion."""
    corners = np.array([[0, 0], [40, 0], [40, 30], [0, 30]], np.float32)
    matrix = cv2.getPerspectiveTransform(camera.project(corners).astype(np.float32), corners)
    return HomographySurface(matrix, camera.size, RadialDistortion.of_picture(camera.size))


def shown(camera, places=PLACES, without=(), noise=0.04, seed=0):
    """Return the markers as they would be found: a little too small, and with noise."""
    rng = np.random.default_rng(seed)
    found = {}
    for number, corners in marker_corners(places).items():
        pixels = camera.project(corners)
        if number not in without:
            found[number] = pixels - 0.4 * outward_moves(pixels) + rng.normal(0, noise, (4, 2))
    return found


def calibrated(camera=CAMERA, **others):
    values = {**SURFACE_DEFAULTS, **surface_values(surface_of(camera), Hull(camera.project(AREA))),
              SURFACE_COVARIANCE: [], **others}
    surface = surface_of(camera)
    return {**values, **marker_values(
        {number: surface.locate(pixels) for number, pixels in shown(camera, seed=9).items()})}


def errors_mm(values, camera):
    surface = HomographySurface(
        np.reshape(values['surface.homography.surface_from_pixel'], (3, 3)), camera.size)
    return 10 * np.linalg.norm(surface.locate(camera.project(AREA)) - AREA, axis=1)


def test_corners_are_found_to_a_few_hundredths_of_a_pixel(frame):
    seen = see_markers(frame, PLAIN).corners
    assert sorted(seen) == [0, 1, 2, 3]
    for number, corners in marker_corners().items():
        error = seen[number] - CAMERA.project(corners)
        outwards = outward_moves(CAMERA.project(corners))
        # The rest of gamma makes all markers look smaller or larger by the same.
        inset = np.sum(error * outwards) / np.sum(outwards ** 2)
        assert abs(inset) < 0.1
        assert np.abs(error - inset * outwards).max() < 0.12


@pytest.mark.parametrize('seed', [16, 20])
def test_marker_is_not_taken_for_its_paper(seed):
    rng = np.random.default_rng(seed)
    frame = random_camera(rng).frame(Table(seed=2), rng, blur=rng.uniform(0.4, 1.4), noise=3.0)
    assert sorted(see_markers(frame, PLAIN).corners) == [0, 1, 2, 3]


def test_surface_that_is_not_exact_enough_is_refused_and_says_so():
    vague = np.diag(np.square([*[0.003] * 8, *[0.05] * 6]))
    marked = MarkedSurface.of({**calibrated(), SURFACE_COVARIANCE: triangle_of(vague)})
    verdict = marked.judge(shown(pinhole(tilt_deg=32, azimuth_deg=200), without=[1]))
    assert verdict.fit is None
    assert 'marker 1 not used' in verdict.trouble


def test_lines_along_the_edges_are_nearer_than_corners_by_opencv(frame):
    grey = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
    by_opencv = aruco.find_markers(grey)
    errors = {'opencv': [], 'lines': []}
    for number, corners in marker_corners().items():
        middle = CAMERA.project(corners).mean(axis=0)
        lines = corners_by_edges(grey, by_opencv[number], PLAIN)
        errors['opencv'].append(np.linalg.norm(by_opencv[number].mean(axis=0) - middle))
        errors['lines'].append(np.linalg.norm(lines.mean(axis=0) - middle))
    assert max(errors['lines']) < 0.05
    assert np.mean(errors['lines']) < np.mean(errors['opencv'])


def test_marker_with_a_covered_edge_is_not_seen(frame):
    covered = frame.copy()
    corners = CAMERA.project(marker_corners()[2])
    middle = (corners[0] + corners[1]) / 2
    cv2.circle(covered, tuple(middle.astype(int).tolist()), 30, (120, 150, 190), -1)
    assert sorted(see_markers(covered, PLAIN).corners) == [0, 1, 3]


def test_a_picture_without_markers_shows_none():
    noise = np.random.default_rng(0).integers(0, 255, (720, 1280, 3), dtype=np.uint8)
    assert see_markers(noise, PLAIN).corners == {}


def test_without_aruco_one_sentence_says_what_to_install(monkeypatch, frame):
    monkeypatch.delattr(cv2, 'aruco')
    assert not aruco.has_markers()
    with pytest.raises(CalibrationError, match='built without markers: install'):
        see_markers(frame, PLAIN)


def test_camera_in_its_place_keeps_its_surface():
    verdict = MarkedSurface.of(calibrated()).judge(shown(CAMERA))
    assert verdict.in_place == (0, 1, 2, 3)
    assert verdict.fit is None and verdict.moved == () and verdict.trouble == ''


@pytest.mark.parametrize('without', [(), (0,), (3,)])
def test_after_any_move_positions_are_right(without):
    values = calibrated()
    rng = np.random.default_rng(4)
    worst = []
    for seed in range(12):
        camera = random_camera(rng, lens=(0.0, 0.0))
        verdict = MarkedSurface.of(values).judge(shown(camera, without=without, seed=seed))
        assert verdict.fit is not None, verdict
        worst.append(errors_mm(new_surface_values(values, verdict.fit), camera).max())
    assert max(worst) < (2.0 if without else 0.4)


def test_moved_marker_is_named_and_not_used():
    moved = {**PLACES, 2: (37.4, 28.3, 0.0)}
    values = calibrated()
    in_place = MarkedSurface.of(values).judge(shown(CAMERA, moved))
    assert in_place.moved == (2,) and in_place.fit is None
    camera = pinhole(tilt_deg=30, azimuth_deg=200, away_cm=60)
    elsewhere = MarkedSurface.of(values).judge(shown(camera, moved))
    assert elsewhere.moved == (2,) and elsewhere.fit.numbers == (0, 1, 3)
    assert errors_mm(new_surface_values(values, elsewhere.fit), camera).max() < 2.0


def test_two_moved_markers_give_no_surface():
    moved = {**PLACES, 1: (37.5, 2.4, 1.4), 2: (37.4, 28.3, 0.0)}
    verdict = MarkedSurface.of(calibrated()).judge(
        shown(pinhole(tilt_deg=30, azimuth_deg=200, away_cm=60), moved))
    assert verdict.fit is None and 'do not lie to each other as they did' in verdict.trouble


@pytest.mark.parametrize('without, told', [
    ((0, 1, 2, 3), 'no marker is seen'), ((0, 1), 'only 2 of 4 markers are seen')])
def test_too_few_markers_give_no_surface(without, told):
    camera = pinhole(tilt_deg=30, azimuth_deg=200, away_cm=60)
    verdict = MarkedSurface.of(calibrated()).judge(shown(camera, without=without))
    assert verdict.fit is None and told in verdict.trouble


def test_one_of_three_markers_elsewhere_is_not_taken_for_a_moved_camera():
    moved = {**PLACES, 2: (37.0, 28.3, 0.0)}
    verdict = MarkedSurface.of(calibrated()).judge(shown(CAMERA, moved, without=(0,)))
    assert verdict.fit is None and 'marker 2 is not where' in verdict.trouble


def test_height_of_the_camera_follows_a_move():
    foot, height = CAMERA.place[:2].tolist(), -float(CAMERA.place[2])
    values = calibrated(**{'surface.camera_foot_cm': foot, 'surface.camera_height_cm': height,
                           'object_height_cm': 3.0})
    camera = pinhole(tilt_deg=30, azimuth_deg=200, away_cm=60)
    marked = MarkedSurface.of(values)
    new = marked.anew(marked.judge(shown(camera)).fit)
    assert new.values['surface.camera_height_cm'] == pytest.approx(-camera.place[2], abs=1.0)
    assert new.values['surface.camera_foot_cm'] == pytest.approx(camera.place[:2], abs=1.5)


def test_pixels_of_the_calibrated_camera_are_those_of_the_same_points():
    values = calibrated()
    camera = pinhole(tilt_deg=30, azimuth_deg=200, away_cm=60)
    marked = MarkedSurface.of(values)
    there = marked.anew(marked.judge(shown(camera)).fit).frame_from_calibrated
    assert np.abs(there.pixels(CAMERA.project(AREA)) - camera.project(AREA)).max() < 1.0


def test_parameters_are_read_as_they_were_written():
    corners = marker_corners()
    read = known_markers({**SURFACE_DEFAULTS, **marker_values(corners)})
    assert sorted(read) == [0, 1, 2, 3]
    assert all(np.allclose(read[number], corners[number], atol=1e-5) for number in corners)
    assert known_markers({**SURFACE_DEFAULTS, **default_values(MARKER_SPECS)}) == {}


@pytest.mark.parametrize('change, told', [
    ({'markers.numbers': [0.0, 1.0, 2.0]}, '8 numbers for each'),
    ({'markers.numbers': [0.0, 1.0, 1.0, 3.0]}, 'different whole numbers'),
    ({'markers.corners_cm': [0.0] * 32}, 'has no area'),
    ({'surface.model': 'polynomial'}, 'homography or parallel')])
def test_parameters_that_do_not_belong_together_are_refused(change, told):
    values = {**SURFACE_DEFAULTS, **marker_values(marker_corners()), **change}
    with pytest.raises(InvalidValueError, match=told):
        known_markers(values)
