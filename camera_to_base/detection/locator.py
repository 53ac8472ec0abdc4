# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Locates objects on a frame: from the picture to points and directions in the camera frame."""

from dataclasses import replace
import math
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

from camera_to_base.detection.behind import apart
from camera_to_base.detection.detection import Box, Detection
from camera_to_base.detection.left_out import (
    left_out_places, LeftOut, locate_pixel, Point, reason_by_size, REASONS)
from camera_to_base.detection.on_surface import (
    object_on_surface, object_yaw, objects_on_surface, OnSurface, pixel_on_surface)
from camera_to_base.detection.settings import DetectorSettings
from camera_to_base.detection.solid import (
    flat_outline, Sides, sides_of, silhouette, Size, size_of, Solid, solid_of)
from camera_to_base.detection.top_rim import sees_rim
from camera_to_base.errors import HorizonError, Level, Reason
from camera_to_base.surface import Surface
from camera_to_base.uncertainty import Shape, Spread
import cv2
import numpy as np

# Limits the time for a frame that contains only noise.
_MOST_OBJECTS = 100
# The tutorial's closing deforms an object that is not this much wider than its kernel.
_LEAST_WIDTH = 2.0
_PLACE_UNKNOWN = Reason(
    'place_unknown', Level.WARN, 'it has a height, and where the camera is now cannot be '
    'computed: calibrate again', is_passing=True)

# Where a solid's rim is seen, what was taken for a side is one. Of 27 objects in doubt in rendered
# cells whose rim is seen, by 0.4 to 15 px, 26 are off by this or less, in px, and one by 1.9 px;
# of 3 whose rim is not seen, all are off by 7 to 26 px.
_DOUBT_WITH_RIM = 0.5
# In a larger box the noise of the rim moves the centre by next to nothing.
_LARGEST_BOX_PX = 40000
_MARGIN_PX = 2
# What is at the same place and as large as on the last frame, in steps of so many px, looks as
# solid as it did.
_SAME_PX = 1.5
# Where a flat object would be is so many deviations away from where a solid one would: of 481 that
# looked solid in rendered cells, 91 of 100 are within 90 % of the errors then.
_DEVIATIONS = 1.9


class LocatedObject(NamedTuple):
    """
    An object with its position on the picture and on the surface.

    :param yaw: The direction of its length about the camera frame's z, from x towards y, in rad,
        in (-pi/2, pi/2]; None if it has none (a coin, a square) or if it is uncertain.
    :param solid: What it stands on; None for a flat object, which lies on its outline.
    :param sides: What is seen of its sides, if it counts as flat and looks solid.
    """

    detection: Detection
    point: Point
    yaw: Optional[float] = None
    solid: Optional[Solid] = None
    sides: Optional[Sides] = None

    def size(self, surface: Surface) -> Size:
        """
        Measure the object.

        :param surface: Maps the frame's pixels to the work surface.
        :raises HorizonError: If a part of a flat object lies on the horizon or beyond it.
        """
        if self.solid is None:
            return size_of(flat_outline(surface, self.detection), 0.0)
        return size_of(self.solid.footprint, self.solid.height_cm)


class Found(NamedTuple):
    """
    The objects that were detected on a frame.

    :param objects: Those that are on the work surface and count, the largest first, at most 100.
    :param left_out: The others, the largest first.
    """

    objects: List[LocatedObject]
    left_out: Tuple[LeftOut, ...]


class ObjectLocator:
    """
    Locates every object on a frame.

    :param background: The surface without an object, shape (h, w, 3), uint8, BGR.
    :param surface: Maps pixels to the work surface.
    :param settings: The detector's settings.
    :raises FrameSizeError: If the surface was calibrated for another picture size.
    :raises InvalidValueError: If the background cannot be used.
    """

    def __init__(
        self,
        background: np.ndarray,
        surface: Surface,
        settings: DetectorSettings = DetectorSettings(),
    ) -> None:
        self._detector = settings.detector(background)
        self._surface = surface.for_image_size((background.shape[1], background.shape[0]))
        self._settings = settings
        self._least_width = (
            0.0 if settings.method == 'precise' else _LEAST_WIDTH * settings.closing_size)
        # What the last frame's objects looked like, by their place and size.
        self._sides: Dict[Tuple[int, ...], Optional[Sides]] = {}
        self._sides_now: Dict[Tuple[int, ...], Optional[Sides]] = {}

    @property
    def noise(self) -> Optional[float]:
        """The noise of a frame, in grey levels; None where it is not known."""
        return self._detector.noise

    def locate(self, frame: np.ndarray) -> List[LocatedObject]:
        """
        Locate the objects that lie on the work surface, see :meth:`find`.

        :returns: The largest first, at most 100; none is [].
        :raises FrameSizeError: If the frame's size is not the background's.
        """
        return self.find(frame).objects

    def find(self, frame: np.ndarray) -> Found:
        """
        Locate the objects on a frame, and list the detections that are left out.

        A detection beyond the horizon, such as a person in the room, is not on the surface and is
        left out. So is a detection whose size does not count.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :raises FrameSizeError: If the frame's size is not the background's.
        """
        detections, hidden = self._without_hiding(self._detector.detect(frame), frame)
        detections, rest = detections[:_MOST_OBJECTS], detections[_MOST_OBJECTS:]
        self._sides, self._sides_now = self._sides_now, {}
        found = [self._located(detection, place, frame)
                 for detection, place in zip(detections, self._places(detections))]
        no_object = [LeftOut(place, REASONS['taken_away'], self._point(place))
                     for place in self._detector.taken_away]
        no_object += [LeftOut(one, REASONS['hidden'], self._point(one)) for one in hidden]
        no_object += left_out_places(self._detector.dropped, self._surface.locate)
        return Found([one for one in found if isinstance(one, LocatedObject)],
                     (*(one for one in found if isinstance(one, LeftOut)),
                      *map(self._unless_ignored, no_object), *_too_many(rest, found)))

    def _without_hiding(
        self, detections: List[Detection], frame: np.ndarray
    ) -> Tuple[List[Detection], List[Detection]]:
        """Tell objects apart of which one hides a part of the other, and what is hidden by it."""
        camera = self._surface.camera_place if self._settings.heights_cm else None
        if camera is None:
            return detections, []

        def distances(pixels: np.ndarray) -> np.ndarray:
            return np.hypot(*(self._surface.locate(pixels) - camera.foot_cm).T)

        found: List[Detection] = []
        hidden: List[Detection] = []
        for detection in detections:
            try:
                objects, behind = apart(detection, frame, distances)
            except HorizonError:
                objects, behind = [detection], []
            found += objects
            hidden += behind
        return sorted(found, key=lambda one: -one.area), hidden

    def _located(
        self, detection: Detection, place: Union[OnSurface, HorizonError], frame: np.ndarray
    ) -> Union[LocatedObject, LeftOut]:
        if isinstance(place, HorizonError):
            return LeftOut(detection, _beyond_horizon(place))
        area_cm2 = detection.area * abs(_determinant(place.cm_per_px))
        if self._settings.heights_cm:
            return self._standing(detection, Point(*place.point.tolist()), area_cm2, frame)
        point = Point(*self._below(place.point).tolist())
        reason = self._reason_to_leave_out(detection, point, area_cm2)
        if reason is not None:
            return LeftOut(detection, reason, point)
        yaw = object_yaw(self._surface, detection, place.cm_per_px, self._least_width)
        return LocatedObject(detection, point, yaw, sides=self._sides_of(detection))

    def _sides_of(self, detection: Detection) -> Optional[Sides]:
        camera = self._surface.camera_place
        if camera is None or detection.cut_off:
            return None
        place = tuple(round(one / _SAME_PX) for one in (
            *detection.centre, math.sqrt(detection.area)))
        if place not in self._sides_now:
            try:
                self._sides_now[place] = self._sides[place] if place in self._sides else (
                    sides_of(detection, self._surface, camera))
            except HorizonError:  # A part of it is not on the surface.
                self._sides_now[place] = None
        return self._sides_now[place]

    def _below(self, seen: np.ndarray) -> np.ndarray:
        """Give where a flat object lies, whose middle is seen."""
        middle_cm, pinhole = self._settings.flat_middle_cm, self._surface.pinhole
        if pinhole is None or not middle_cm:
            return seen
        return pinhole.camera_place.below(seen, middle_cm)

    def _standing(
        self, detection: Detection, seen: Point, area_cm2: float, frame: np.ndarray
    ) -> Union[LocatedObject, LeftOut]:
        """Locate an object that has a height: its footprint instead of its outline."""
        camera = self._surface.camera_place
        if camera is None:
            return LeftOut(detection, _PLACE_UNKNOWN, seen)
        outline = silhouette(detection)
        try:
            solid = solid_of(outline, frame, self._surface, camera, self._settings.heights_cm)
        except HorizonError as error:
            return LeftOut(detection, _beyond_horizon(error), seen)
        if isinstance(solid, Reason):
            reason = self._reason_to_leave_out(detection, seen, area_cm2)
            return LeftOut(detection, reason or solid, seen)
        point = Point(*solid.footprint.centre.tolist())
        reason = self._reason_to_leave_out(detection, point, solid.footprint.area)
        if reason is not None:
            return LeftOut(detection, reason, point)
        # What is hidden of a part stays in doubt.
        if detection.doubt > _DOUBT_WITH_RIM and not detection.is_part and sees_rim(
                outline, frame, self._surface, camera, solid.height_cm):
            detection = replace(detection, doubt=_DOUBT_WITH_RIM)
        return LocatedObject(detection, point, None if detection.cut_off else solid.yaw, solid)

    def _point(self, place: Detection) -> Optional[Point]:
        try:
            return locate_pixel(self._surface, place.centre)
        except HorizonError:
            return None

    def _reason_to_leave_out(
        self, detection: Detection, point: Point, area_cm2: float
    ) -> Optional[Reason]:
        settings = self._settings
        if detection.cut_off and settings.method == 'precise' and not settings.publish_cut_off:
            return _left_out('cut_off', "it touches the picture's edge: move it into view, or set "
                             'detector.publish_cut_off')
        if settings.area is not None and not settings.area.contains(detection.centre):
            return _left_out('outside_hull', 'it lies outside the area that the calibration was '
                             'measured in, see surface.reject_outside_hull')
        return self._reason_by_area(point) or reason_by_size(
            area_cm2, detection.area, settings.min_area_cm2, settings.max_area_cm2)

    def _reason_by_area(self, point: Point) -> Optional[Reason]:
        areas = self._settings.areas
        if areas.work is not None and not areas.work.contains(point):
            return _left_out('outside_work_area', 'it lies outside of work_area')
        if any(area.contains(point) for area in areas.ignored):
            return _left_out('in_ignored_area', 'it lies in one of ignored_areas, or on a marker')
        return None

    def _unless_ignored(self, left_out: LeftOut) -> LeftOut:
        reason = None if left_out.point is None else self._reason_by_area(left_out.point)
        return left_out if reason is None else left_out._replace(reason=reason)

    def _places(
        self, detections: Sequence[Detection]
    ) -> Sequence[Union[OnSurface, HorizonError]]:
        if self._settings.method == 'precise':
            try:
                # To ask the surface once is faster.
                return objects_on_surface(self._surface.locate, detections)
            except HorizonError:
                pass
        return [self._place(detection) for detection in detections]

    def _place(self, detection: Detection) -> Union[OnSurface, HorizonError]:
        try:
            if self._settings.method == 'precise':
                return object_on_surface(self._surface.locate, detection)
            return pixel_on_surface(self._surface.locate, detection.centre)
        except HorizonError as error:
            return error


def _too_many(
    rest: Sequence[Detection], found: Sequence[Union[LocatedObject, LeftOut]]
) -> List[LeftOut]:
    # They are not larger than the last one that was looked at.
    if not rest:
        return []
    last = found[-1]
    is_speck = isinstance(last, LeftOut) and last.reason.kind == 'speck'
    reason = last.reason if is_speck else REASONS['too_much']
    return [LeftOut(one, reason) for one in rest]


def _determinant(matrix: np.ndarray) -> float:
    (a, b), (c, d) = matrix.tolist()
    return a * d - b * c


def _beyond_horizon(error: HorizonError) -> Reason:
    return Reason(
        'beyond_horizon', Level.WARN, f'no position is published: {error}', is_passing=True)


def _left_out(kind: str, sentence: str) -> Reason:
    # Objects that the parameters exclude give no warning.
    return Reason(kind, Level.OK, sentence, is_passing=True)


def object_shape(
    found: LocatedObject, frame: np.ndarray, background: Optional[np.ndarray]
) -> Shape:
    """
    Return what the uncertainty of an object needs.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape; None where there is none.
    """
    detection = found.detection
    moments = detection.moments or cv2.moments(detection.outline)
    area = moments['m00'] or 1.0
    contrast, edge_width = math.nan, 1.0
    box = detection.box
    if background is not None and background.shape == frame.shape and (
            box.width * box.height <= _LARGEST_BOX_PX):
        contrast, edge_width = _contrast_and_edge(frame, background, detection)
    return Shape(
        detection.centre, max(detection.area, 1.0),
        Spread(moments['mu20'] / area, moments['mu11'] / area, moments['mu02'] / area),
        contrast, edge_width, detection.cut_off,
        # A side that is seen makes an outline longer, in the camera's direction.
        found.yaw is not None and found.sides is None, *_height_and_misfit(found),
        detection.doubt)


def _height_and_misfit(found: LocatedObject) -> Tuple[float, float]:
    if found.solid is not None:
        return found.solid.height_cm, found.solid.misfit_cm
    return 0.0, 0.0 if found.sides is None else found.sides.off_cm / _DEVIATIONS


def _contrast_and_edge(frame: np.ndarray, background: np.ndarray, detection: Detection):
    """Return the mean difference to the background, and over how many px it comes about."""
    part = _grown(detection.box)
    seen, table = frame[part], background[part]
    change = cv2.absdiff(seen, table)
    contrast = sum(cv2.sumElems(change)) / 3 / max(detection.area, 1.0)
    # Differences of the next but one pixels.
    steepest = max(cv2.norm(cv2.Sobel(change, cv2.CV_16S, 1, 0, ksize=1), cv2.NORM_INF),
                   cv2.norm(cv2.Sobel(change, cv2.CV_16S, 0, 1, ksize=1), cv2.NORM_INF)) / 2
    return contrast, max(1.0, contrast / max(steepest, 1.0))


def _grown(box: Box) -> tuple:
    return (slice(max(box.y - _MARGIN_PX, 0), box.y + box.height + _MARGIN_PX),
            slice(max(box.x - _MARGIN_PX, 0), box.x + box.width + _MARGIN_PX))
