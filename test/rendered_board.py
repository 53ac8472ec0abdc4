# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Render chessboards for tests, with everything about them known."""

from functools import lru_cache

import cv2
import numpy as np

WIDTH, HEIGHT = 640, 480
IMAGE_SIZE = (WIDTH, HEIGHT)
CENTRE = ((WIDTH - 1) / 2, (HEIGHT - 1) / 2)
RADIUS = float(np.hypot(WIDTH, HEIGHT) / 2)


def pixel_from_surface(tilt_deg=30.0, yaw_deg=10.0, *, away_cm=45.0, focal_px=600.0,
                       middle=(10.0, 6.25)):
    """Return the homography from cm to pixels of a camera that looks at `middle`, (3, 3)."""
    tilt, yaw = np.radians([tilt_deg, yaw_deg])
    about_x = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)],
                        [0, np.sin(tilt), np.cos(tilt)]])
    about_z = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    rotation = about_x @ about_z
    displacement = np.array([0, 0, away_cm]) - rotation @ np.array([*middle, 0])
    camera = np.array([[focal_px, 0, CENTRE[0]], [0, focal_px, CENTRE[1]], [0, 0, 1]])
    return camera @ np.column_stack([rotation[:, :2], displacement])


def camera_place(tilt_deg=30.0, yaw_deg=10.0, *, away_cm=45.0, middle=(10.0, 6.25)):
    """Return the foot point (2,) and the height of that camera, in cm."""
    tilt, yaw = np.radians([tilt_deg, yaw_deg])
    back = np.sin(tilt) * np.array([np.sin(yaw), np.cos(yaw)])
    return middle - away_cm * back, away_cm * np.cos(tilt)


def project(homography, points, coefficient=0.0, centre=CENTRE):
    """Show points (n, 2) through a homography and the division model, solved independently."""
    u, v, w = homography @ np.vstack([np.transpose(points), np.ones(len(points))])
    offsets = (np.stack([u / w, v / w], axis=1) - centre) / RADIUS
    length = np.linalg.norm(offsets, axis=1)
    radii = np.array([_distorted_radius(value, coefficient) for value in length])
    return centre + RADIUS * offsets * (radii / np.maximum(length, 1e-300))[:, None]


def _distorted_radius(undistorted, coefficient):
    """Bisect r / (1 + k r^2) = undistorted."""
    low, high = 0.0, 1.0 if coefficient == 0 else min(3.0, 0.999999 / np.sqrt(abs(coefficient)))
    high = max(high, undistorted) if coefficient == 0 else high
    for _ in range(200):
        middle = (low + high) / 2
        if middle / (1 + coefficient * middle ** 2) < undistorted:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def render(homography, *, columns=9, rows=6, square_cm=2.5, coefficient=0.0, noise=0.0, blur=0.0,
           seed=0):
    """Render a board whose first inner corner is the origin, 3 x 3 samples to a pixel."""
    image = _render_grey(tuple(np.ravel(homography)), columns, rows, square_cm, coefficient)
    if blur:
        image = cv2.GaussianBlur(image, (0, 0), blur)
    image = image + np.random.default_rng(seed).normal(0, noise, image.shape)
    return cv2.cvtColor(image.round().clip(0, 255).astype(np.uint8), cv2.COLOR_GRAY2BGR)


@lru_cache
def _render_grey(homography, columns, rows, square_cm, coefficient):
    offsets = (np.arange(3) - 1) / 3
    u = (np.arange(WIDTH)[:, None] + offsets).ravel() - CENTRE[0]
    v = (np.arange(HEIGHT)[:, None] + offsets).ravel()[:, None] - CENTRE[1]
    scale = 1 / (1 + coefficient * (u ** 2 + v ** 2) / RADIUS ** 2)
    u, v = CENTRE[0] + u * scale, CENTRE[1] + v * scale
    x, y, w = (row[0] * u + row[1] * v + row[2]
               for row in np.linalg.inv(np.reshape(homography, (3, 3))))
    samples = _board_at(x / (w * square_cm), y / (w * square_cm), columns, rows)
    return samples.reshape(HEIGHT, 3, WIDTH, 3).mean(axis=(1, 3))


def _board_at(x, y, columns, rows):
    column, row = np.floor(x).astype(int) + 1, np.floor(y).astype(int) + 1
    inside = (column >= 0) & (column <= columns) & (row >= 0) & (row <= rows)
    margin = (x > -2) & (x < columns + 1) & (y > -2) & (y < rows + 1)
    square = np.where((column + row) % 2 == 0, 30.0, 220.0)
    return np.where(inside, square, np.where(margin, 220.0, 120.0))
