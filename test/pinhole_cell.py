# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Corners of a board in a cell whose camera is known: on the table, and held at a tilt."""

from camera_to_base.surface import LensModel, MatchedPoints, PinholeSurface
import cv2
import numpy as np

SIZE = 1280, 720
COEFFICIENTS = -0.18, 0.06, 0.0012, -0.0008, 0.0
LENS = LensModel(SIZE, (1010.0, 1010.0), (651.0, 352.0), COEFFICIENTS)
COLUMNS, ROWS, SQUARE_CM = 9, 6, 2.5
# Where flat boards lie, as shares of half the picture, and their turn in degrees.
FLAT = ((-0.6, -0.5, 0.0), (0.55, 0.45, 8.0), (-0.5, 0.5, -6.0), (0.6, -0.5, 4.0))
# Where tilted boards are held, about which direction they are tilted in degrees, and how far.
TILTED = ((-0.2, -0.1, 0.0, 30.0), (0.25, 0.1, 180.0, 32.0), (0.0, 0.2, 95.0, 28.0),
          (0.1, -0.2, 270.0, 33.0))


def board_grid(square_cm=SQUARE_CM):
    """Return the corners of the board in its own coordinates, shape (n, 2), in cm."""
    row, column = np.mgrid[:ROWS, :COLUMNS].astype(float)
    return square_cm * np.stack([column.ravel(), row.ravel()], axis=1)


class PinholeCell:
    """A camera over a table; the table's coordinates have their origin below it."""

    def __init__(self, tilt_deg=0.0, height_cm=80.0, lens=LENS, noise=0.0, seed=0):
        self.lens, self.height_cm, self.noise = lens, height_cm, noise
        self._random = np.random.default_rng(seed)
        self._camera = cv2.Rodrigues(np.array([np.radians(tilt_deg), 0.0, 0.0]))[0]

    def flat(self, place, square_cm=SQUARE_CM):
        """Return a placement on the table, and its own place there: middle and turn."""
        middle, yaw = self._on_table(place[:2]), np.radians(place[2])
        grid = board_grid(square_cm)
        turned = self._turned(grid - grid.mean(axis=0), yaw) + middle
        points = np.column_stack([turned, np.full(len(turned), self.height_cm)])
        return MatchedPoints(grid, self._seen(points @ self._camera.T))

    def tilted(self, place, square_cm=SQUARE_CM, lens=None, bend_cm=0.0):
        """Return a board that is held above the table at a tilt."""
        middle, grid = self._on_table(place[:2]), board_grid(square_cm)
        direction, angle = np.radians(place[2:])
        tilt = cv2.Rodrigues(angle * np.array([np.cos(direction), np.sin(direction), 0.0]))[0]
        offsets = grid - grid.mean(axis=0)
        lift = bend_cm * (offsets[:, 0] / offsets[:, 0].max()) ** 2
        held = np.column_stack([offsets, lift]) @ tilt.T
        points = held + 0.8 * np.array([*middle, self.height_cm])
        return MatchedPoints(grid, self._seen(points @ self._camera.T, lens))

    def flats(self):
        """Return four placements on the table."""
        return [self.flat(place) for place in FLAT]

    def tilts(self, **changes):
        """Return four boards that are tilted to all sides."""
        return [self.tilted(place, **changes) for place in TILTED]

    def true_surface(self):
        """Return the camera over the frame of the first placement."""
        middle, yaw = self._on_table(FLAT[0][:2]), np.radians(FLAT[0][2])
        foot = self._turned(-middle[None], -yaw)[0] + board_grid().mean(axis=0)
        about_z = cv2.Rodrigues(np.array([0.0, 0.0, yaw]))[0]
        rotation = cv2.Rodrigues(self._camera @ about_z)[0].ravel()
        return PinholeSurface(self.lens, rotation, [*foot, -self.height_cm])

    def _on_table(self, share):
        pixel = (np.array(self.lens.image_size) - 1) / 2 * (1 + np.array(share))
        ray = self._camera.T @ [*self.lens.rays([pixel])[0], 1.0]
        return ray[:2] / ray[2] * self.height_cm

    def _seen(self, points, lens=None):
        pixels = (lens or self.lens).project(points)
        return pixels + self._random.normal(0.0, self.noise, pixels.shape)

    @staticmethod
    def _turned(points, yaw):
        return points @ [[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]]
