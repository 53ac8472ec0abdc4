# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Solid objects on the simulated table: upright boxes, cylinders and hexagons, with their shadows.

The faces are projected and painted as polygons, the farthest object first. Each face is as light
as two lamps and the light from all sides make it. This module shares no code with detection.
"""

import math
from typing import List, NamedTuple, Sequence

from camera_to_base.simulation.disturbances import BoardConditions
from camera_to_base.simulation.specs import BOX, DISC, HEXAGON
from camera_to_base.simulation.view import BoardView, Oval, SeenEllipse
import cv2
import numpy as np

# Blue, green and red as shares of the grey level: painted wood.
_PAINTS = {DISC: (1.7, 0.8, 0.4), BOX: (0.35, 0.6, 1.8), HEXAGON: (0.4, 1.5, 0.7)}
# A cylinder's side has so many faces.
_CYLINDER_FACES = 48
# Light from all sides, as a share of what the lamps give a face that is turned to them.
_AMBIENT = 1.2
# Sides are painted so much wider that no seam is left between them; the top comes last.
_SEAM_PX = 1.0
# Half of the rim in which a lamp is partly covered: standard deviation in cm on the table.
_PENUMBRA_CM = 0.06


class Lamp(NamedTuple):
    """
    A lamp above the table.

    :param place: From the middle of what is seen at tilt 0: x, y and the height, in cm.
    :param strength: The light of a face that is turned to it.
    """

    place: Sequence[float]
    strength: float


_LAMPS = Lamp((-45.0, -35.0, 95.0), 0.6), Lamp((50.0, 15.0, 120.0), 0.35)


class Prism:
    """
    An upright object.

    :param oval: What it stands on, and its height.
    :param view: The camera's.
    """

    def __init__(self, oval: Oval, view: BoardView) -> None:
        self.corners = _footprint(oval)
        self.height = oval.height_cm
        self._top = view.pixels_above(self._at(self.height))
        self._bottom = view.pixels(self.corners)
        self.silhouette = cv2.convexHull(
            np.concatenate([self._bottom, self._top]).astype(np.float32))[:, 0].astype(float)
        self._paint = np.array(_PAINTS[oval.shape], np.float32)
        self._foot = view.camera_cm[:2]
        self.away = math.dist(oval.point, self._foot)
        self._view = view

    def paint(self, picture: np.ndarray, level: float, lamps: Sequence[Lamp]) -> None:
        """
        Paint its sides and its top.

        :param picture: Shape (h, w, 3), float32, BGR; it is changed.
        :param level: The brightness of its top.
        """
        rows, columns = self._view.box(self.silhouette)
        window = picture[rows, columns]
        if window.size == 0:
            return
        colour = np.float32(level) * self._paint
        faces = np.empty_like(window)
        faces[:] = colour
        for face, shade in self._sides(lamps):
            covered = polygon_coverage(face, rows, columns, _SEAM_PX)[:, :, None]
            faces += covered * (colour * np.float32(shade) - faces)
        covered = polygon_coverage(self._top, rows, columns)[:, :, None]
        faces += covered * (colour - faces)
        window += polygon_coverage(self.silhouette, rows, columns)[:, :, None] * (faces - window)

    def shadow(self, lamp: Lamp) -> np.ndarray:
        """Return its shadow's corners on the table, its own place included: (n, 2), in px."""
        place = np.array(lamp.place)
        cast = place[:2] + (self.corners - place[:2]) * place[2] / (place[2] - self.height)
        hull = cv2.convexHull(np.concatenate([self.corners, cast]).astype(np.float32))[:, 0]
        return self._view.pixels(hull.astype(float))

    def _at(self, height: float) -> np.ndarray:
        return np.column_stack([self.corners, np.full(len(self.corners), height)])

    def _sides(self, lamps: Sequence[Lamp]):
        """Give the polygon, in px, and the lightness of each side that the camera sees."""
        middle = self.corners.mean(axis=0)
        for index in range(len(self.corners) if self.height else 0):
            ends = [index, (index + 1) % len(self.corners)]
            first, second = self.corners[ends]
            normal = np.array([second[1] - first[1], first[0] - second[0]])
            normal /= np.hypot(*normal)
            normal *= np.sign(normal @ (first - middle))
            if normal @ (self._foot - first) > 0:
                at = np.array([*(first + second) / 2, self.height / 2])
                yield (np.concatenate([self._bottom[ends], self._top[ends[::-1]]]),
                       _light(at, np.array([*normal, 0.0]), lamps) / _light(
                           at, np.array([0.0, 0.0, 1.0]), lamps))


def draw_solids(
    picture: np.ndarray, ovals: Sequence[Oval], view: BoardView, conditions: BoardConditions
) -> None:
    """
    Draw objects with their shadows on the table, the farthest object first.

    :param picture: Shape (h, w, 3), float32, BGR; it is changed.
    """
    lamps = _placed_lamps(view)
    prisms = sorted((Prism(oval, view) for oval in ovals), key=lambda prism: -prism.away)
    _cast_shadows(picture, [prism for prism in prisms if prism.height], view, lamps)
    for prism in prisms:
        prism.paint(picture, conditions.table_level - conditions.contrast, lamps)


def seen_ellipse(oval: Oval, view: BoardView) -> SeenEllipse:
    """Return where an object's picture is, and how large, sides included."""
    if oval.is_flat_disc:
        return view.ellipse(oval)
    silhouette = Prism(oval, view).silhouette
    moments = cv2.moments((silhouette - silhouette[0]).astype(np.float32))
    centre = silhouette[0] + np.array([moments['m10'], moments['m01']]) / moments['m00']
    half = np.maximum(silhouette.max(axis=0) - centre, centre - silhouette.min(axis=0))
    return SeenEllipse(centre, half, math.sqrt(moments['m00'] / math.pi))


def polygon_coverage(
    corners: np.ndarray, rows: slice, columns: slice, margin: float = 0.0
) -> np.ndarray:
    """
    Return the share of each pixel of a window that a convex polygon covers.

    The share falls linearly with the distance to the nearest edge.

    :param corners: Shape (n, 2), u and v, in px.
    :param margin: By how much it is widened on all sides, in px.
    :returns: Shape (rows, columns), float32, 0..1.
    """
    v = np.arange(rows.start, rows.stop, dtype=np.float32)[:, None]
    u = np.arange(columns.start, columns.stop, dtype=np.float32)[None, :]
    edges = np.roll(corners, -1, axis=0) - corners
    outwards = np.column_stack([edges[:, 1], -edges[:, 0]])
    # Twice the area is positive where the corners go round from u towards v.
    outwards *= np.sign((corners[:, 0] * outwards[:, 0] + corners[:, 1] * outwards[:, 1]).sum())
    lengths = np.hypot(*edges.T)
    is_edge = lengths > 1e-9
    normals = outwards[is_edge] / lengths[is_edge, None]
    offsets = (normals * corners[is_edge]).sum(axis=1) + margin
    beyond = np.full((v.size, u.size), -np.inf, np.float32)
    for (along_u, along_v), offset in zip(normals.astype(np.float32), offsets):
        np.maximum(beyond, (along_v * v - np.float32(offset)) + along_u * u, out=beyond)
    return np.clip(0.5 - beyond, 0.0, 1.0)


def _footprint(oval: Oval) -> np.ndarray:
    # Counted from the direction of the length; shape (n, 2), in cm.
    if oval.shape == BOX:
        unit = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    else:
        count = _CYLINDER_FACES if oval.shape == DISC else 6
        angles = 2 * np.pi * np.arange(count) / count
        unit = np.column_stack([np.cos(angles), np.sin(angles)])
    if oval.shape == DISC:
        # As large as the ellipse.
        unit *= math.sqrt(angles[1] / math.sin(angles[1]))
    cos, sin = math.cos(oval.yaw), math.sin(oval.yaw)
    return oval.point + unit * [oval.half_length, oval.half_width] @ [[cos, sin], [-sin, cos]]


def _placed_lamps(view: BoardView) -> List[Lamp]:
    x, y = view.size_cm / 2
    return [Lamp(np.add(lamp.place, [x, y, 0.0]), lamp.strength) for lamp in _LAMPS]


def _light(at: np.ndarray, normal: np.ndarray, lamps: Sequence[Lamp]) -> float:
    return _AMBIENT + sum(_of_lamp(at, normal, lamp) for lamp in lamps)


def _of_lamp(at: np.ndarray, normal: np.ndarray, lamp: Lamp) -> float:
    way = lamp.place - at
    return lamp.strength * max(float(normal @ way) / math.sqrt(way @ way), 0.0)


def _lit(view: BoardView, prisms: Sequence[Prism], lamp: Lamp) -> np.ndarray:
    """Return the share of a lamp's light that reaches each place of the table: (h, w, 1)."""
    shaded = np.zeros((view.height, view.width), np.float32)
    for prism in prisms:
        shadow = prism.shadow(lamp)
        rows, columns = view.box(shadow)
        window = shaded[rows, columns]
        if window.size:
            np.maximum(window, polygon_coverage(shadow, rows, columns), out=window)
    return 1 - cv2.GaussianBlur(shaded, (0, 0), _PENUMBRA_CM / view.cm_per_px)[:, :, None]


def _cast_shadows(
    picture: np.ndarray, prisms: Sequence[Prism], view: BoardView, lamps: Sequence[Lamp]
) -> None:
    if prisms:
        middle, up = np.array([*view.size_cm / 2, 0.0]), np.array([0.0, 0.0, 1.0])
        light = _AMBIENT + sum(_of_lamp(middle, up, lamp) * _lit(view, prisms, lamp)
                               for lamp in lamps)
        picture *= (light / _light(middle, up, lamps)).astype(np.float32)
