# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""A camera that is moved while the pipeline runs, with markers on its table."""

from itertools import count

from camera_to_base.parameters import checked_values
from camera_to_base.pipeline import CameraPipeline
from camera_to_base.settings import camera_settings, CAMERA_SPECS
from camera_to_base.sources import DEVICE
import cv2
import numpy as np
import pytest
from rendered_markers import Camera, marker_corners, PLACES, Table

SIZE = (640, 360)
COIN = 14.0, 20.0


def camera(**place):
    return Camera(lens=(0.0, 0.0), size=SIZE, **place)


HERE = camera()
THERE = camera(tilt_deg=25, azimuth_deg=200, away_cm=60, roll_deg=6)


def given(**others):
    corners = np.array([[0, 0], [40, 0], [40, 30], [0, 30]], np.float32)
    matrix = cv2.getPerspectiveTransform(HERE.project(corners).astype(np.float32), corners)
    markers = marker_corners()
    values = {'surface.model': 'homography', 'surface.image_size': list(SIZE),
              'surface.homography.surface_from_pixel': matrix.ravel().tolist(),
              'surface.homography.distortion_centre': [(side - 1) / 2 for side in SIZE],
              'markers.numbers': sorted(markers),
              'markers.corners_cm': np.concatenate(
                  [markers[number].ravel() for number in sorted(markers)]).tolist(), **others}
    return camera_settings(checked_values(CAMERA_SPECS, values))


class Cell:
    """A pipeline with the frames of a camera, ten a second on a clock of its own."""

    def __init__(self, **others):
        settings = given(**others)
        self.pipeline = CameraPipeline(
            settings.surface, settings.detector, settings.limits._replace(max_frame_age_s=1e9), 1,
            DEVICE, settings.markers)
        self._times, self._rng, self._frames = count(), np.random.default_rng(0), {}

    def look(self, place, table, frames):
        """Return the sightings of some frames."""
        key = id(place), id(table)
        if key not in self._frames:
            self._frames[key] = [place.frame(table, self._rng, noise=1.0) for _ in range(2)]
        pair = self._frames[key]
        return [self.pipeline.process(pair[number % 2], next(self._times) / 10)
                for number in range(frames)]

    def start(self, place=HERE):
        return self.look(place, EMPTY, 4)


def table_with(coin=None, places=PLACES):
    table = Table(places)
    if coin is not None:
        table.lay_coin(*coin)
    return table


EMPTY, WITH_COIN = table_with(), table_with(COIN)


def published(sightings):
    return [found.point for sighting in sightings if sighting.reason is None
            for found in sighting.objects]


def kinds(sightings):
    return {sighting.reason.kind for sighting in sightings if sighting.reason is not None}


def assert_at_the_coin(points):
    assert points
    assert 10 * np.linalg.norm(np.subtract(points, COIN), axis=1).max() < 1.0


def test_camera_in_its_place_needs_no_new_surface():
    cell = Cell()
    cell.start()
    assert_at_the_coin(published(cell.look(HERE, WITH_COIN, 4)))
    assert cell.pipeline.doubt is None


def test_camera_that_was_moved_before_the_start_gives_right_positions():
    cell = Cell()
    cell.start(THERE)
    assert_at_the_coin(published(cell.look(THERE, WITH_COIN, 4)))
    assert cell.pipeline.doubt.kind == 'surface_by_markers'


@pytest.mark.slow
def test_moved_camera_waits_for_its_background():
    cell = Cell()
    cell.start()
    moved = cell.look(THERE, EMPTY, 25)
    assert published(moved) == []
    assert moved[-1].reason.kind == 'background_awaited'
    assert '~/capture_background' in moved[-1].reason.sentence
    cell.pipeline.capture_background(1)
    cell.look(THERE, EMPTY, 4)
    assert_at_the_coin(published(cell.look(THERE, WITH_COIN, 4)))


@pytest.mark.slow
def test_moved_camera_takes_its_background_where_that_is_allowed():
    cell = Cell(background_retake='auto')
    cell.start()
    cell.look(THERE, EMPTY, 30)
    assert_at_the_coin(published(cell.look(THERE, WITH_COIN, 4)))


@pytest.mark.slow
def test_background_is_not_taken_while_something_moves():
    cell = Cell(background_retake='auto')
    cell.start()
    hands = [table_with((10 + 4 * number, 15)) for number in range(3)]
    for number in range(30):
        cell.look(THERE, hands[number % 3], 5)
    assert cell.pipeline.counts['frames held back: background_missing'] <= 2


@pytest.mark.slow
def test_background_is_not_taken_while_a_marker_is_covered():
    cell = Cell(background_retake='auto')
    cell.start()
    covered = table_with(PLACES[1][:2])
    cell.look(THERE, covered, 30)
    assert cell.pipeline.counts['frames held back: background_missing'] <= 2


@pytest.mark.slow
def test_background_is_not_taken_while_an_object_lies_there():
    cell = Cell(background_retake='auto')
    cell.start()
    sightings = cell.look(THERE, WITH_COIN, 30)
    assert sightings[-1].reason.kind == 'background_awaited'
    assert 'clear the surface' in sightings[-1].reason.sentence
    cell.look(THERE, EMPTY, 30)
    assert_at_the_coin(published(cell.look(THERE, WITH_COIN, 4)))


@pytest.mark.slow
def test_camera_that_is_put_back_has_its_calibrated_surface_again():
    cell = Cell(background_retake='auto')
    cell.start(THERE)
    cell.look(HERE, EMPTY, 30)
    assert_at_the_coin(published(cell.look(HERE, WITH_COIN, 4)))
    assert cell.pipeline.doubt is None


def test_nothing_is_published_where_no_marker_is_seen():
    cell = Cell()
    bare = table_with(places={})
    sightings = cell.look(THERE, bare, 6)
    assert published(sightings) == []
    assert sightings[-1].reason.kind == 'markers_unclear'
    assert 'no marker is seen' in sightings[-1].reason.sentence


@pytest.mark.slow
def test_marker_that_was_moved_is_named_and_never_an_object():
    cell = Cell()
    cell.start()
    moved = table_with(places={**PLACES, 2: (30.0, 20.0, 0.4)})
    assert published(cell.look(HERE, moved, 60)) == []
    assert cell.pipeline.doubt.kind == 'marker_moved'
    assert 'marker 2 was moved' in cell.pipeline.doubt.sentence


@pytest.mark.slow
def test_markers_that_move_without_the_rest_of_the_view_stop_the_cell():
    cell = Cell()
    cell.start()
    shifted = {number: (x + 0.4, y, yaw) for number, (x, y, yaw) in PLACES.items()}
    sightings = cell.look(HERE, table_with(places=shifted), 60)
    assert sightings[-1].reason is not None
    assert published(sightings[-5:]) == []


def test_new_settings_keep_what_the_markers_say():
    cell = Cell()
    cell.start(THERE)
    settings = given(**{'detector.faintest': 20.0})
    cell.pipeline.configure(settings.surface, settings.detector, settings.limits._replace(
        max_frame_age_s=1e9), settings.markers)
    assert_at_the_coin(published(cell.look(THERE, WITH_COIN, 4)))


def test_another_calibration_is_compared_with_the_markers_before_it_is_used():
    cell = Cell()
    cell.start(THERE)
    settings = given(**{'surface.camera_height_cm': 51.0})
    cell.pipeline.configure(settings.surface, settings.detector, settings.limits._replace(
        max_frame_age_s=1e9), settings.markers)
    points = published(cell.look(THERE, WITH_COIN, 8))
    assert all(10 * np.hypot(*np.subtract(point, COIN)) < 1.0 for point in points)


def test_without_aruco_one_sentence_says_what_to_install_and_the_rest_works(monkeypatch):
    cell = Cell()
    monkeypatch.delattr(cv2, 'aruco')
    cell.start()
    assert_at_the_coin(published(cell.look(HERE, WITH_COIN, 4)))
    assert 'built without markers: install' in cell.pipeline.doubt.sentence


def test_nothing_is_published_until_the_markers_have_been_compared():
    cell, random = Cell(), np.random.default_rng(3)
    background, frame = (HERE.frame(table, random, noise=1.0) for table in (EMPTY, WITH_COIN))
    cell.pipeline.restore_background(background, age_s=1.0)
    covered = cell.pipeline.process(random.integers(0, 255, background.shape, np.uint8), 0.0)
    assert covered.reason is not None
    soon = [cell.pipeline.process(frame, 0.1 + number / 100).reason for number in range(3)]
    assert [reason and reason.kind for reason in soon] == [
        'unconfirmed', 'markers_unclear', 'markers_unclear']
