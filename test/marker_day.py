# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
Days with markers: drives the pipeline, without ROS, through moves of the camera; knows the truth.

A day is a number. Its camera is calibrated from points that a board would give, and learns the
markers from a picture. A point is wrong if it is more than 2 mm from the coin, 1 mm and 1 px. At
the end the markers are put back and freed, the camera is put where it sees them, the user takes a
background, and the coin must be found.
"""

from collections import Counter
import time
from typing import List, NamedTuple, Optional, Tuple

from camera_to_base.calibration.checks import surface_error
from camera_to_base.calibration.homography_fit import fit_homography
from camera_to_base.calibration.marker_learning import learned_markers
from camera_to_base.markers import lens_of_values, see_markers
from camera_to_base.parameters import checked_values
from camera_to_base.pipeline import CameraPipeline
from camera_to_base.settings import camera_settings, CAMERA_SPECS
from camera_to_base.sources import DEVICE
from camera_to_base.surface import Hull, MatchedPoints, SURFACE_DEFAULTS, surface_values
from camera_to_base.uncertainty import radius_for, SURFACE_COVARIANCE, triangle_of
from marker_events import EVENTS, SHARES
from marker_world import SIZE, World
import numpy as np

FRAMES_PER_S, WRONG_MM, EVENT_COUNT = 10, 2.0, 9
_BOARD = np.stack(np.meshgrid(np.linspace(6, 34, 9), np.linspace(5, 25, 6)), -1).reshape(-1, 2)
_END_S = 14


class Wrong(NamedTuple):
    """A published point that is wrong: when, in s, how far off, in mm, and what went before."""

    at: float
    off_mm: float
    events: Tuple[str, ...]


class Course(NamedTuple):
    """
    What came of a day.

    :param errors_mm: Of the points that are published where the coin is.
    :param outside: How many of these are outside of their own 99 % ellipse.
    :param wrong: Points that are more than WRONG_MM from the coin.
    :param back_s: How long after the last background the coin was published; None for never.
    :param reasons: How many frames each reason has held back.
    """

    events: Tuple[str, ...]
    errors_mm: List[float]
    outside: int
    wrong: List[Wrong]
    back_s: Optional[float]
    reasons: Counter


class Cell:
    """A pipeline of a calibrated camera, with a clock of its own."""

    def __init__(self, world, retake):
        self._settings = camera_settings(checked_values(CAMERA_SPECS, {
            **_calibrated(world), 'background_retake': retake, 'detector.faintest': 15.0}))
        self._now, self.reason = time.monotonic() + 3600, None
        self.pipeline: CameraPipeline = None
        self.restart()

    def restart(self, with_file=False):
        """Start anew, with the background of before or without one."""
        kept = self.pipeline and self.pipeline.standpoint.background_as_calibrated
        settings = self._settings
        self.pipeline = CameraPipeline(
            settings.surface, settings.detector, settings.limits, 1, DEVICE, settings.markers)
        if with_file and kept is not None:
            self.pipeline.restore_background(kept.picture, 10.0, unknown=kept.unknown)

    def see(self, frame):
        """Give the positions, in mm, and their covariances, in mm²."""
        self._now += 1 / FRAMES_PER_S
        sighting = self.pipeline.process(frame, self._now)
        self.reason = sighting.reason
        if sighting.reason is not None:
            return []
        uncertainty = self.pipeline.frame_uncertainty(frame, self._settings.uncertainty)
        return [(np.array(one.point) * 10, uncertainty.of(one).matrix[:2, :2] * 100)
                for one in sighting.objects]


def play(seed, kinds=None):
    """
    Play a day.

    :param kinds: Its events, by name; None for random ones.
    """
    random = np.random.default_rng([seed, 0])
    world = World(seed)
    cell = Cell(world, str(random.choice(['auto', 'never'])))
    share = np.array([SHARES.get(name, 1.0) for name in EVENTS])
    kinds = kinds or tuple(str(kind) for kind in random.choice(
        list(EVENTS), EVENT_COUNT, p=share / share.sum()))
    course = Course(kinds, [], 0, [], None, Counter())
    frames = 0
    for number, kind in enumerate(('start', *kinds)):
        steps = EVENTS.get(kind, _start)(world, np.random.default_rng([seed, 2, number]), cell)
        for _ in steps:
            course = _judged(course, world, cell, frames / FRAMES_PER_S, kinds[:number])
            frames += 1
            world.begin_frame()
    return _ended(course, world, cell, frames)


def _start(world, random, cell):
    yield from (None for _ in range(6))


def _ended(course, world, cell, frames):
    tidy, coin = EVENTS['tidy'], EVENTS['coin']
    world.lamp, world.coin, world.covers, world.glare = 1.0, None, [], None
    random = np.random.default_rng(0)
    for _ in tidy(world, random, cell):
        course = _judged(course, world, cell, frames / FRAMES_PER_S, course.events)
        frames += 1
    if world.free_marker_count() < 4:
        world.camera = world.home
    cell.pipeline.capture_background(1)
    taken = frames + 8
    for number, _ in enumerate(coin(world, random, cell, at=(20.0, 15.0), frames=_END_S * 10)):
        if number == 0:
            continue
        before = len(course.errors_mm)
        course = _judged(course, world, cell, frames / FRAMES_PER_S, course.events)
        frames += 1
        if len(course.errors_mm) > before:
            return course._replace(back_s=(frames - taken) / FRAMES_PER_S)
    return course


def _judged(course, world, cell, at, events):
    points = cell.see(world.shoot())
    if cell.reason is not None:
        course.reasons[cell.reason.kind] += 1
    outside = course.outside
    for point, covariance in points:
        off = point - (np.inf if world.coin is None else 10 * world.coin.at)
        error = float(np.hypot(*off))
        if error > WRONG_MM:
            course.wrong.append(Wrong(round(at, 1), round(error, 2), events))
        else:
            course.errors_mm.append(error)
        if np.isfinite(error):
            outside += off @ np.linalg.solve(covariance, off) > radius_for(0.99) ** 2
    return course._replace(outside=outside)


def _calibrated(world):
    random = np.random.default_rng(1)
    pixels = world.camera.project(_BOARD) + random.normal(0, 0.07, _BOARD.shape)
    matched = MatchedPoints(_BOARD, pixels)
    surface = fit_homography(matched, SIZE).surface
    covariance = surface_error(surface, matched, SIZE, 'corner').covariance
    values = {**SURFACE_DEFAULTS, **surface_values(surface, Hull(pixels)),
              SURFACE_COVARIANCE: triangle_of(covariance)}
    frames = [see_markers(world.shoot(), lens_of_values(values)).corners for _ in range(3)]
    learned = learned_markers(frames, values, source='the world').values
    return {**{name: value for name, value in values.items() if name != 'surface.hull'}, **learned}
