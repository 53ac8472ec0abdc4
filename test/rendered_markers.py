# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
Render a wooden table with markers, seen by a camera that stands anywhere.

Nothing of the package but the markers' bits is used: light is linear until the camera's gamma, the
lens has two radial coefficients in OpenCV's model, and the frame has blur, noise and JPEG.
"""

from camera_to_base.markers import marker_cells
import cv2
import numpy as np

MARKER_CM = 4.0
# x, y and turn of each marker: 36 x 26 cm between their middles.
PLACES = {0: (2.0, 2.0, 0.05), 1: (38.0, 2.0, 1.4), 2: (38.0, 28.0, -0.1), 3: (2.0, 28.0, 3.0)}
_PX_PER_CM = 40
_LEFT, _TOP, _RIGHT, _BOTTOM = -15, -15, 60, 50
_WHITE, _BLACK, _FLOOR, _GAMMA = 0.75, 0.04, 0.15, 2.2
_SAMPLES, _NODES = 2, 24


def marker_corners(places=PLACES):
    """Return the corners of the markers, by number, shape (4, 2), in cm."""
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * MARKER_CM / 2
    return {number: square @ _turn(yaw).T + (x, y) for number, (x, y, yaw) in places.items()}


def _turn(yaw):
    return np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])


class Table:
    """A wooden table; `picture` is its brightness in linear light, from straight above."""

    def __init__(self, places=PLACES, seed=0):
        rng = np.random.default_rng(seed)
        height, width = (_BOTTOM - _TOP) * _PX_PER_CM, (_RIGHT - _LEFT) * _PX_PER_CM
        grain = cv2.GaussianBlur(
            rng.normal(0, 1, (height // 8, width)).astype(np.float32), (0, 0), 6)
        grain = cv2.resize(grain, (width, height))
        self.picture = 0.25 + 0.06 * grain / grain.std()
        for number, place in places.items():
            self.lay(number, *place)

    def lay(self, number, x, y, yaw):
        """Lay a marker on the table, over what lies there."""
        paper = np.full((8, 8), _WHITE, np.float32)
        paper[1:7, 1:7][marker_cells(number)] = _BLACK
        paper = cv2.resize(paper, None, fx=40, fy=40, interpolation=cv2.INTER_NEAREST)
        cell = MARKER_CM / 6 / 40
        to_table = _PX_PER_CM * cell * _turn(yaw)
        middle = _PX_PER_CM * np.subtract((x, y), (_LEFT, _TOP)) - 0.5
        matrix = np.column_stack([to_table, middle - to_table @ (159.5, 159.5)])
        size = self.picture.shape[::-1]
        laid = cv2.warpAffine(paper, matrix, size)
        share = cv2.warpAffine(np.ones_like(paper), matrix, size)
        self.picture = np.where(share > 0.5, laid / np.maximum(share, 0.5), self.picture)

    def light_at(self, places):
        """Return the light from places, shape (h, w, 2), in cm."""
        places = ((places - (_LEFT, _TOP)) * _PX_PER_CM - 0.5).astype(np.float32)
        return cv2.remap(self.picture.astype(np.float32), places[..., 0], places[..., 1],
                         cv2.INTER_LINEAR, borderValue=_FLOOR)

    def lay_coin(self, x, y, diameter_cm=2.4):
        """Lay a bright coin on the table."""
        centre = _PX_PER_CM * np.subtract((x, y), (_LEFT, _TOP)) - 0.5
        cv2.circle(self.picture, tuple(int(round(16 * value)) for value in centre),
                   int(8 * _PX_PER_CM * diameter_cm), 0.6, -1, cv2.LINE_AA, 4)


class Camera:
    """
    A camera above the table.

    :param lens: Two radial coefficients, in units of the focal length.
    :param centre_off: By how much its axis is beside the middle of the picture, in px.
    """

    def __init__(self, tilt_deg=20.0, azimuth_deg=70.0, away_cm=55.0, looks_at=(20.0, 15.0),
                 roll_deg=0.0, size=(1280, 720), lens=(-0.1, 0.03), focal_px=None,
                 centre_off=(0.0, 0.0)):
        self.pose = {'tilt_deg': tilt_deg, 'azimuth_deg': azimuth_deg, 'away_cm': away_cm,
                     'looks_at': tuple(looks_at), 'roll_deg': roll_deg, 'size': size,
                     'lens': lens, 'focal_px': focal_px, 'centre_off': centre_off}
        tilt, azimuth, roll = np.radians([tilt_deg, azimuth_deg, roll_deg])
        # z of the camera frame points into the table.
        self.place = np.array([looks_at[0] + away_cm * np.sin(tilt) * np.cos(azimuth),
                               looks_at[1] + away_cm * np.sin(tilt) * np.sin(azimuth),
                               -away_cm * np.cos(tilt)])
        forward = np.array([*looks_at, 0.0]) - self.place
        forward /= np.linalg.norm(forward)
        right = np.array([np.cos(roll), np.sin(roll), 0.0])
        right -= forward * (forward @ right)
        right /= np.linalg.norm(right)
        self.rotation = np.array([right, np.cross(forward, right), forward])
        self.size, self.lens = size, lens
        self.focal_px = focal_px or 1000.0 * size[0] / 1280
        self.centre = np.subtract(size, 1) / 2 + centre_off

    def project(self, points):
        """Return the pixels (n, 2) that show points (n, 2), in cm."""
        seen = (np.column_stack([points, np.zeros(len(points))]) - self.place) @ self.rotation.T
        offsets = seen[:, :2] / seen[:, 2:]
        squares = np.sum(offsets ** 2, axis=1, keepdims=True)
        return self.centre + self.focal_px * offsets * (
            1 + self.lens[0] * squares + self.lens[1] * squares ** 2)

    def sees(self, places=PLACES, margin=8):
        """Return whether all markers are in the picture."""
        pixels = self.project(np.concatenate(list(marker_corners(places).values())))
        return bool((pixels > margin).all() and (pixels < np.array(self.size) - 1 - margin).all())

    def frame(self, table, rng, **webcam):
        """Return a picture of the table, shape (h, w, 3), uint8, BGR, see `exposed`."""
        return self.exposed(table.light_at(self.seen_places()), rng, **webcam)

    def exposed(self, light, rng, blur=0.8, noise=2.0, jpeg=85, gamma=_GAMMA):
        """
        Return the picture of what reaches the lens, shape (h, w, 3), uint8, BGR.

        :param light: At the places of `seen_places`.
        """
        width, height = self.size
        light = cv2.resize(light, self.size, interpolation=cv2.INTER_AREA)
        light = cv2.GaussianBlur(light, (0, 0), blur)
        down, along = np.mgrid[:height, :width] / width
        light *= 1 + 0.2 * (along - 0.5) + 0.15 * down
        grey = 255 * np.clip(light, 0, 1) ** (1 / gamma) + rng.normal(0, noise, light.shape)
        picture = cv2.cvtColor(grey.clip(0, 255).round().astype(np.uint8), cv2.COLOR_GRAY2BGR)
        _, coded = cv2.imencode('.jpg', picture, [cv2.IMWRITE_JPEG_QUALITY, jpeg])
        return cv2.imdecode(coded, cv2.IMREAD_COLOR)

    def seen_places(self):
        """Return where the camera looks, two samples to a pixel, (2 h, 2 w, 2), in cm."""
        # The map is smooth.
        nodes = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
        grid = [(nodes + 1) / 2 * length - 0.5 for length in self.size]
        places = self._points(np.stack(np.meshgrid(*grid), axis=-1).reshape(-1, 2))
        inverse = np.linalg.inv(np.polynomial.chebyshev.chebvander(nodes, _NODES - 1))
        across, down = (np.polynomial.chebyshev.chebvander(
            (np.arange(length * _SAMPLES) + 0.5) / (length * _SAMPLES) * 2 - 1, _NODES - 1
        ) @ inverse for length in self.size)
        return np.stack([down @ one.reshape(_NODES, _NODES) @ across.T
                         for one in places.T], axis=-1)

    def _points(self, pixels):
        shown = (pixels - self.centre) / self.focal_px
        offsets = shown.copy()
        for _ in range(6):
            squares = np.sum(offsets ** 2, axis=1, keepdims=True)
            offsets = shown / (1 + self.lens[0] * squares + self.lens[1] * squares ** 2)
        rays = np.column_stack([offsets, np.ones(len(offsets))]) @ self.rotation
        return self.place[:2] - self.place[2] * rays[:, :2] / rays[:, 2:]


def random_camera(rng, **fixed):
    """Return a camera that sees all markers, from another place each time."""
    while True:
        camera = Camera(
            rng.uniform(0, 35), rng.uniform(0, 360), rng.uniform(42, 70),
            (20 + rng.normal(0, 3), 15 + rng.normal(0, 2)),
            rng.choice([0, 180]) + rng.normal(0, 12), **fixed)
        if camera.sees():
            return camera
