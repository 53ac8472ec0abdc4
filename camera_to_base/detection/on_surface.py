# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A detection on the surface: its point, the scale there, and its direction."""

from itertools import accumulate
from typing import Callable, List, NamedTuple, Optional, Sequence

from camera_to_base.coordinate_transform import LEAST_ELONGATION
from camera_to_base.detection.detection import (
    Detection, Pixel, polygon_centroid, principal_axes)
from camera_to_base.errors import HorizonError
from camera_to_base.surface import Surface
import cv2
import numpy as np

# The place itself, and half a pixel left, right, above and below of it.
_CROSS = np.array([[0.0, 0.0], [-0.5, 0.0], [0.5, 0.0], [0.0, -0.5], [0.0, 0.5]])

Locate = Callable[[np.ndarray], np.ndarray]


class OnSurface(NamedTuple):
    """
    A place on the surface.

    :param point: Shape (2,), x and y, in cm.
    :param cm_per_px: Shape (2, 2); its columns are x and y, in cm, of a step of 1 px along u and
        along v.
    """

    point: np.ndarray
    cm_per_px: np.ndarray


def pixel_on_surface(locate: Locate, pixel: Pixel) -> OnSurface:
    """
    Map a pixel to the surface.

    :param locate: Maps pixels of shape (n, 2) to the surface, shape (n, 2), as Surface.locate.
    :raises HorizonError: If the pixel lies on the horizon or beyond it.
    """
    points = locate(_CROSS + pixel)
    return OnSurface(points[0], _scale(points))


def object_on_surface(locate: Locate, detection: Detection) -> OnSurface:
    """
    Map an object to the surface.

    With a tilted camera, the centroid of a disc's picture is not the picture of the disc's centre:
    the near half looks larger. The difference is computed from the outline, whose centroid is
    taken in both planes.

    :param locate: Maps pixels of shape (n, 2) to the surface, shape (n, 2), as Surface.locate.
    :raises HorizonError: If a part of the object lies on the horizon or beyond it.
    """
    return _from_points(locate(_to_locate(detection)))


def objects_on_surface(locate: Locate, detections: Sequence[Detection]) -> List[OnSurface]:
    """
    Map several objects to the surface, see :func:`object_on_surface`.

    :raises HorizonError: If a part of one of them lies on the horizon or beyond it.
    """
    if len(detections) < 2:
        return [object_on_surface(locate, detection) for detection in detections]
    pixels = [_to_locate(detection) for detection in detections]
    ends = list(accumulate(map(len, pixels)))
    return list(map(_from_points, np.split(locate(np.concatenate(pixels)), ends[:-1])))


def _to_locate(detection: Detection) -> np.ndarray:
    return np.concatenate(
        [_CROSS + detection.centre, _centroid(detection.outline), detection.outline])


def _from_points(points: np.ndarray) -> OnSurface:
    centre, centroid, outline = points[0], points[len(_CROSS)], points[len(_CROSS) + 1:]
    return OnSurface(centre + polygon_centroid(outline) - centroid, _scale(points))


def _centroid(outline: np.ndarray) -> np.ndarray:
    # Shape (1, 2). OpenCV is faster than `polygon_centroid`, and as exact for whole numbers.
    moments = cv2.moments(outline)
    area = moments['m00']
    if not area:
        return outline.mean(axis=0, keepdims=True)
    return np.array([[moments['m10'] / area, moments['m01'] / area]])


def _scale(points: np.ndarray) -> np.ndarray:
    # Right minus left, and below minus above.
    return (points[2:len(_CROSS):2] - points[1:len(_CROSS):2]).T


def object_yaw(
    surface: Surface, detection: Detection, cm_per_px: np.ndarray, least_width: float = 0.0
) -> Optional[float]:
    """
    Return the direction of an object's length.

    An object is small compared with its distance, so its second moments are mapped from the
    picture to the surface with a constant scale.

    :param cm_per_px: The surface's scale at the object, see :class:`OnSurface`.
    :param least_width: The shape of a narrower object is not reliable, in px.
    :returns: About the camera frame's z, from x towards y, in rad, in (-pi/2, pi/2]; None if the
        object is about as wide as long, is too narrow, or has a part that is missing or beyond
        the horizon.
    """
    axes = principal_axes(cm_per_px @ detection.spread @ cm_per_px.T)
    if axes.elongation < LEAST_ELONGATION or detection.cut_off:
        return None
    if principal_axes(detection.spread).width < least_width or not _seen(surface, detection):
        return None
    return axes.angle


def _seen(surface: Surface, detection: Detection) -> bool:
    try:
        surface.locate(detection.outline)
    except HorizonError:
        return False
    return True
