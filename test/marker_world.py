# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
A table with markers, its camera, and what happens on it: the renderer of the days with markers.

It knows nothing of the checks. Lengths are in cm of the table. A frame's events set what lasts for
one frame: `hands`.
"""

import cv2
import numpy as np
from rendered_markers import Camera, marker_corners, PLACES, random_camera, Table

SIZE = WIDTH, HEIGHT = 640, 360
_SAMPLES = 2
_POSE = 'tilt_deg', 'azimuth_deg', 'away_cm', 'roll_deg', 'focal_px'


class Thing:
    """A disc or a sheet that lies on the table: `at` in cm, `light` in linear light."""

    def __init__(self, at, half, light, yaw=None):
        self.at, self.half, self.light, self.yaw = np.array(at, float), half, light, yaw

    def share(self, places, px_per_cm):
        """Return how much of each sample it covers."""
        x, y = (places[..., axis] - self.at[axis] for axis in (0, 1))
        if self.yaw is None:
            inside = self.half - np.sqrt(x * x + y * y)
        else:
            cos, sin = np.cos(self.yaw), np.sin(self.yaw)
            inside = np.minimum(self.half - np.abs(cos * x + sin * y),
                                0.75 * self.half - np.abs(cos * y - sin * x))
        return np.clip(inside * px_per_cm * _SAMPLES + 0.5, 0, 1)


class World:
    """
    The table, what lies on it, and the camera.

    `camera` is where it stands; `coin` is a Thing or None, `covers` are others; `lamp` is a
    factor, `glare` is None, or its place as shares of the picture's sides and its strength.
    """

    def __init__(self, seed):
        self._random = random = np.random.default_rng([seed, 1])
        self._bare = Table({}, int(random.integers(1000)))
        self._wood = self._bare.picture
        self.fixed = {'lens': (random.uniform(-0.15, 0.02), random.uniform(-0.03, 0.03)),
                      'size': SIZE, 'centre_off': tuple(random.normal(0, 6, 2))}
        self._webcam = {'blur': random.uniform(0.4, 0.9), 'noise': random.uniform(1, 2.5),
                        'jpeg': int(random.choice([85, 95])), 'gamma': random.uniform(1.9, 2.4)}
        self.home = self.camera = random_camera(
            random, focal_px=random.uniform(430, 600), **self.fixed)
        self.places, self.coin, self.covers = dict(PLACES), None, []
        self.lamp, self.glare, self._laid, self._seen, self._light = 1.0, None, None, None, None
        self.begin_frame()

    def begin_frame(self):
        """Forget what lasts for one frame."""
        self.hands = []

    @property
    def things(self):
        """What lies on the table beside the markers."""
        return [*self.covers, *([] if self.coin is None else [self.coin])]

    def shoot(self):
        """Take a picture, shape (360, 640, 3), uint8, BGR."""
        light = self._empty().copy()
        for thing in self.things:
            share = thing.share(self._seen[1], self.camera.focal_px / 55)
            light += share * (thing.light - light)
        for begin, tip, width, shade in self.hands:
            _draw_hand(light, begin, tip, width, shade)
        light *= self.lamp
        if self.glare is not None:
            light += _glare(*self.glare)
        return self.camera.exposed(light, self._random, **self._webcam)

    def _empty(self):
        if self._laid != self.places:
            self._laid, self._seen = dict(self.places), None
            self._bare.picture = self._wood
            for number, place in self.places.items():
                self._bare.lay(number, *place)
        if self._seen is None or self._seen[0] is not self.camera:
            places = self.camera.seen_places()
            self._seen = self.camera, places.astype(np.float32)
            self._light = self._bare.light_at(places)
        return self._light

    def free_marker_count(self):
        """Return how many markers are seen whole, with some of their paper."""
        margin = 4
        count = 0
        for corners in marker_corners(self.places).values():
            pixels = self.camera.project(corners)
            in_view = (pixels > margin).all() and (pixels < np.subtract(SIZE, margin + 1)).all()
            middle, reach = corners.mean(axis=0), 3.8
            is_free = all(np.hypot(*(thing.at - middle)) > reach + thing.half
                          for thing in self.things)
            count += bool(in_view and is_free)
        return count

    def sees(self, point, margin=25):
        """Return whether a place on the table is in the picture."""
        pixel, = self.camera.project(np.atleast_2d(point))
        return bool((pixel > margin).all() and (pixel < np.subtract(SIZE, margin + 1)).all())


def moved_camera(camera, random, share):
    """Return a camera near another: `share` 1 moves the picture by some dozen px."""
    pose = dict(camera.pose)
    for name, step in zip(_POSE, (1.5, 2.0, 1.0, 1.5, 0.0)):
        pose[name] += share * step * random.uniform(-1, 1)
    pose['looks_at'] = tuple(np.add(pose['looks_at'], share * random.uniform(-1, 1, 2)))
    return Camera(**pose)


def between(one, other, share):
    """Return a camera on the way from one place to another."""
    pose = {name: value if name not in (*_POSE, 'looks_at') else tuple(
        np.add(np.multiply(value, 1 - share), np.multiply(other.pose[name], share)))
        if name == 'looks_at' else (1 - share) * value + share * other.pose[name]
        for name, value in one.pose.items()}
    return Camera(**pose)


def _draw_hand(light, begin, tip, width, shade):
    mask = np.zeros(light.shape, np.uint8)
    begin, tip = (tuple(int(_SAMPLES * value) for value in point) for point in (begin, tip))
    cv2.line(mask, begin, tip, 255, int(_SAMPLES * width), cv2.LINE_AA)
    cv2.circle(mask, tip, int(0.75 * _SAMPLES * width), 255, -1, cv2.LINE_AA)
    light += (mask / np.float32(255)) * (shade - light)


def _glare(across, down, strength):
    v, u = np.mgrid[:HEIGHT * _SAMPLES, :WIDTH * _SAMPLES].astype(np.float32)
    squares = (u - across * u.shape[1]) ** 2 + (v - down * u.shape[0]) ** 2
    return strength * np.exp(-squares / (2 * (60 * _SAMPLES) ** 2))
