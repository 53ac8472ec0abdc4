# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Solid objects: what they stand on, and how long, wide and high they are."""

from dataclasses import dataclass, field
import math
from typing import Any, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from camera_to_base.coordinate_transform import CameraPlace, LEAST_ELONGATION
from camera_to_base.detection.detection import Detection, polygon_centroid, principal_axes
from camera_to_base.detection.top_rim import told_height
from camera_to_base.errors import InvalidValueError, Level, Reason
from camera_to_base.surface import Footprint, Outline, RayedSilhouette, Surface
import cv2
import numpy as np

# An outline is followed in steps of about this many px, with so many points at least and at most.
_STEP_PX, _FEWEST, _MOST = 1.5, 48, 160
_SIMPLER_PX = 0.5
# The right height fits a silhouette to 0.96 and more in rendered scenes; with less than this the
# object is not upright, or has another height.
LEAST_FIT = 0.9
# With less than this, where it stands is not known to a few mm.
_NO_FIT = 0.85
# The silhouette of a convex object has no notch but what the picture's pixels make, in px. A
# deeper one was bitten out by light, or lies between two objects that hide one another. In
# rendered cells (785 solid objects, three views) a place is off by half of what a notch is deeper,
# or less; two objects seen as one are notched by 0.15 of their silhouette's width and more.
_PIXEL_NOTCH, _OF_NOTCH, _NOTCH_OF_TWO = 3.5, 0.5, 0.14
# A flat disc has no chord on 0.06 of its width that is 0.7 of its radius long; what is swept by a
# height has long ones up to its sides.
_LONG_CHORD, _SWEPT = 0.7, 0.965


class Size(NamedTuple):
    """
    The box around an object that stands upright.

    :param length_cm: Along `angle`.
    :param width_cm: Across it; at most the length but for the outline's noise.
    :param height_cm: Above the surface; 0 for a flat object.
    :param angle: From x towards y, in rad.
    """

    length_cm: float
    width_cm: float
    height_cm: float
    angle: float


@dataclass(frozen=True)
class Solid:
    """
    An object with a height, as it stands on the surface.

    :param footprint: What it stands on; by its silhouette alone where the sweep does not fit.
    :param height_cm: Its height, in cm.
    :param misfit_cm: Standard deviation of its place because it is no upright convex object of
        that height; 0 where it is.
    :param surface: Maps the frame's pixels to the work surface.
    """

    footprint: Outline
    height_cm: float
    misfit_cm: float
    surface: Surface = field(repr=False, compare=False)

    @property
    def pixels(self) -> np.ndarray:
        """The footprint on the picture, shape (n, 2), in px; NaN where it is not seen."""
        return self.surface.pixels(self.footprint.corners)

    @property
    def yaw(self) -> Optional[float]:
        """The direction of its length, in rad, in (-pi/2, pi/2]; None if it has none."""
        return yaw_of(self.footprint)


def yaw_of(outline: Outline) -> Optional[float]:
    """Return the direction of an outline's length; None where it is about as wide as long."""
    axes = principal_axes(outline.spread)
    return axes.angle if axes.elongation >= LEAST_ELONGATION else None


def size_of(outline: Outline, height_cm: float) -> Size:
    """Measure an outline: along its length, or as the smallest rectangle where it has none."""
    angle = yaw_of(outline)
    if angle is None:
        angle = outline.narrowest_angle()
    length, width = outline.size_along(angle).tolist()
    return Size(length, width, height_cm, angle)


def object_heights(values: Mapping[str, Any], surface: Surface) -> Tuple[float, ...]:
    """
    Return the heights that objects may have, from the parameters, in cm.

    :param values: `object_height_cm` and `object_heights_cm`.
    :param surface: Made of the same parameters.
    :returns: In ascending order; () for flat objects.
    :raises InvalidValueError: If the camera's place is not known, or it is not above the objects.
    """
    heights = tuple(sorted(set(values['object_heights_cm'] or [values['object_height_cm']])))
    if heights == (0.0,):
        return ()
    name = 'object_heights_cm' if values['object_heights_cm'] else 'object_height_cm'
    place = surface.camera_place
    if place is None:
        missing = 'surface.camera_foot_cm' if values['surface.camera_height_cm'] else (
            'surface.camera_height_cm')
        raise InvalidValueError(
            f'{name} needs to know where the camera is: calibrate board with tilted placements '
            f'measures it, or measure and set {missing}')
    if not heights[-1] < place.height_cm:
        raise InvalidValueError(
            f"{name} must be below the camera's height, {place.height_cm:g} cm, got "
            f'{heights[-1]:g}')
    return heights


def silhouette(detection: Detection) -> np.ndarray:
    """
    Return an object's outline to parts of a pixel.

    A detection's outline leads through the centres of the outermost pixels. It is moved outwards
    until it encloses the area that the detector measured, and to the centre that it found.

    :returns: Shape (n, 2), in px, 48 <= n <= 160.
    """
    points = detection.outline.reshape(-1, 2).astype(float)
    ends = np.vstack([points, points[:1]])
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ends, axis=0).T))])
    count = int(np.clip(lengths[-1] / _STEP_PX, _FEWEST, _MOST))
    steps = np.linspace(0.0, lengths[-1], count, endpoint=False)
    points = np.column_stack([np.interp(steps, lengths, column) for column in ends.T])
    for _ in range(2):  # The steps between the pixels of a slanted side are none of the object's.
        points = (np.roll(points, 1, axis=0) + 2 * points + np.roll(points, -1, axis=0)) / 4
    along = np.roll(points, -2, axis=0) - np.roll(points, 2, axis=0)
    outwards = np.column_stack([along[:, 1], -along[:, 0]])
    outwards /= np.maximum(np.hypot(*outwards.T), 1e-9)[:, None]
    area = cv2.contourArea((points - points[0]).astype(np.float32), oriented=True)
    if area < 0:
        outwards, area = -outwards, -area
    # area + length d + pi d² is that of an outline moved outwards by d.
    missing, length = detection.area - area, max(lengths[-1], 1e-9)
    by = 2 * missing / (length + math.sqrt(max(length ** 2 + 4 * math.pi * missing, 0.0)))
    points = points + np.clip(by, -1.0, 2.0) * outwards
    return points + detection.centre - polygon_centroid(points)


def silhouette_on_surface(detection: Detection, surface: Surface) -> np.ndarray:
    """
    Return an object's outline on the surface, side faces included.

    :param surface: Maps the frame's pixels to the work surface.
    :returns: Shape (n, 2), in cm; corners that are less than half a pixel beside the line
        between others are left out.
    :raises HorizonError: If a part of it lies on the horizon or beyond it.
    """
    corners = cv2.approxPolyDP(silhouette(detection).astype(np.float32), _SIMPLER_PX, True)
    return surface.locate(corners[:, 0].astype(float))


def solid_of(
    outline: np.ndarray, frame: np.ndarray, surface: Surface, camera: CameraPlace,
    heights_cm: Sequence[float],
) -> Union[Solid, Reason]:
    """
    Find what an object stands on.

    :param outline: Its silhouette on the picture, shape (n, 2), in px.
    :param frame: The picture, shape (h, w, 3), uint8, BGR.
    :param surface: Maps the frame's pixels to the work surface.
    :param heights_cm: The heights that it may have, ascending.
    :returns: The reason where it has none of the heights, or where that cannot be told.
    :raises HorizonError: If a part of it lies on the horizon or beyond it.
    """
    corners = surface.locate(outline)
    rayed = RayedSilhouette(corners, camera.foot_cm)
    told = heights_cm[0] if len(heights_cm) == 1 else told_height(
        rayed, outline, frame, surface, camera, heights_cm)
    height_cm = heights_cm[0] if told is None else told
    footprint = rayed.footprint(height_cm / camera.height_cm)
    if footprint.fit < _NO_FIT or not footprint.outline.area > 0:
        return Reason('other_height', Level.WARN, (
            f'its outline is that of no upright object {height_cm:g} cm high (fit '
            f'{footprint.fit:.2f}): set object_height_cm to its height'), is_passing=True)
    if told is None:
        return Reason('height_unclear', Level.WARN, (
            'neither its outline nor the rim of its top tells which of object_heights_cm it '
            'has: tilt the camera more, or list fewer heights'), is_passing=True)
    notch_cm = _notch_misfit(outline, corners)
    if footprint.fit >= LEAST_FIT:
        return Solid(footprint.outline, height_cm, notch_cm, surface)
    stands, misfit_cm = _at_half_the_height(corners, camera, height_cm, footprint)
    return Solid(stands, height_cm, max(misfit_cm, notch_cm), surface)


def _notch_misfit(outline: np.ndarray, corners: np.ndarray) -> float:
    """Return the standard deviation of a place because its silhouette is notched, in cm."""
    # Near the origin, so that float32 is exact enough.
    points = (outline - outline[0]).astype(np.float32)
    hull = cv2.convexHull(points)
    deepest = max(cv2.pointPolygonTest(hull, point, True) for point in points.tolist())
    seen = Outline.of(corners)
    width = max(math.sqrt(cv2.contourArea(hull)), 1.0)
    cm_per_px = math.sqrt(seen.area) / width
    misfit_cm = _OF_NOTCH * max(deepest - _PIXEL_NOTCH, 0.0) * cm_per_px
    if deepest < max(_NOTCH_OF_TWO * width, _PIXEL_NOTCH):
        return misfit_cm
    # The middle of either object may be meant.
    return max(size_of(seen, 0.0).length_cm / 4, misfit_cm)


def _at_half_the_height(
    corners: np.ndarray, camera: CameraPlace, height_cm: float, footprint: Footprint
) -> Tuple[Outline, float]:
    seen, foot = Outline.of(corners), np.array(camera.foot_cm)
    outline = Outline.of(camera.below(corners, height_cm / 2))
    # The two guesses are apart by as much as either may be off, and the sweep by the height.
    apart = float(np.hypot(*(outline.centre - footprint.outline.centre)))
    sweep = height_cm / camera.height_cm * float(np.hypot(*(seen.centre - foot)))
    return outline, max(apart, sweep / 2, 0.1 * math.sqrt(seen.area))


class Sides(NamedTuple):
    """
    What an outline tells of an object whose side the camera sees.

    :param height_cm: How high it may be at most. Of 81 boxes and cylinders in a rendered cell,
        half have this height to a tenth, three quarters to a fifth, and most others are lower.
    :param off_cm: How far its middle is then from its outline's.
    """

    height_cm: float
    off_cm: float


def sides_of(
    detection: Detection, surface: Surface, camera: CameraPlace
) -> Optional[Sides]:
    """
    Return what an outline tells of an object's sides; None where it looks flat.

    A solid object's outline leads away from the camera for as long as its side is seen. A flat
    one's does so by chance only, such as a rectangle's that points to the camera's foot. A side
    that is narrow compared with the object is not noticed.

    :param surface: Maps the frame's pixels to the work surface.
    :raises HorizonError: If a part of it lies on the horizon or beyond it.
    """
    corners = surface.locate(silhouette(detection))
    outline = Outline.of(corners)
    away = float(np.hypot(*(outline.centre - camera.foot_cm)))
    chord = _LONG_CHORD * math.sqrt(outline.area / math.pi)
    if not 0.0 < 2 * chord < away:
        return None  # The camera looks down on it.
    rayed = RayedSilhouette(corners, camera.foot_cm)
    tallest = rayed.tallest(_SWEPT)
    if tallest < chord / away:
        return None
    stands = rayed.footprint(tallest).outline
    return Sides(tallest * camera.height_cm, math.dist(outline.centre, stands.centre))


def flat_outline(surface: Surface, detection: Detection) -> Outline:
    """
    Return a flat object's outline on the surface.

    :raises HorizonError: If a part of it lies on the horizon or beyond it.
    """
    return Outline.of(surface.locate(silhouette(detection)))
