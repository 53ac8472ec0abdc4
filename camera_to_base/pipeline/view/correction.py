# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Corrects a nudge: whether it is believed, what it does to positions, and how it is kept."""

from typing import Any, Dict, NamedTuple, Optional

from camera_to_base.checks import ImageSize
from camera_to_base.detection import read_polygons
from camera_to_base.errors import HorizonError, InvalidValueError, Level, Reason
from camera_to_base.pipeline.place import SurfaceInForce
from camera_to_base.pipeline.sighting import Limits
from camera_to_base.pipeline.view.nudge import Nudge, NudgeMeter
from camera_to_base.surface import (
    as_homography, Hull, NudgedSurface, Surface, surface_values)
from camera_to_base.uncertainty import (
    PositionUncertainty, radius_for, scales_at, SURFACE_COVARIANCE, triangle_of, warp_design,
    WARP_NUMBERS)
import cv2
import numpy as np

# The error is that of an ellipse with so many of all errors, at the worst of these places.
_SHARE, _PLACES = 0.99, (7, 5)
_MM_PER_CM = 10.0

# Two frames give the same nudge where no corner of the picture differs by more, in px of a picture
# that is this long, or in standard deviations of the correction.
_SAME_PX, _USUAL_LENGTH, _SAME_DEVIATIONS = 0.3, 960, 1.5
# A smaller nudge than this is none, in px.
_LEAST_NUDGE_PX = 0.5
# A shift that is not held back is measured where it stays above this, in px, for so many frames.
_DRIFT_PX, _DRIFT_FRAMES = 0.8, 4
# What stands still differs from the background by this share of what it would if it had moved.
_STANDS_STILL = 0.7
# After a nudge, too: it is farther than this from where the rest is, in px, if a part of at least
# this many px, with this response of the correlation, tells.
_MOST_APART_PX, _LEAST_PART_PX, _LEAST_RESPONSE = 2.0, 16, 0.15
# An edge at the rim of what both pictures show is none; the blur reaches this far.
_RIM_PX, _AROUND_EDGES = 2.0, np.ones((9, 9), np.uint8)
# Of frames that are not held back so many are measured in a row; from then on two of each so many.
_AT_ONCE, _PERIOD = 8, 8


class Correction(NamedTuple):
    """
    What a nudge does to positions.

    :param nudge: As it was measured.
    :param shift_px: How far the picture's centre or a corner has moved, the farthest of them.
    :param shift_mm: How far positions would be off without the correction, at worst.
    :param error_mm: Which error of the correction one of a hundred positions exceeds, where it is
        the largest.
    :param deviation_px: Standard deviation of the correction, where it is the largest.
    """

    nudge: Nudge
    shift_px: float
    shift_mm: float
    error_mm: float
    deviation_px: float

    @property
    def reason(self) -> Reason:
        """Tell that positions are corrected."""
        return Reason('view_corrected', Level.WARN, (
            f'the camera was nudged by {self.shift_px:.1f} px ({self.shift_mm:.1f} mm): positions '
            f'are corrected, to about {max(self.error_mm, 0.1):.1f} mm: move the camera back, or '
            'keep the correction with `calibrate keep FILE` or on the dashboard (otherwise, after '
            'a restart, only a background_file tells that it was nudged). If the table was pushed '
            f'instead, positions are off by {self.shift_mm:.1f} mm: push it back; '
            'view.fixed_areas would tell'))


def correction_of(nudge: Nudge, surface: Surface, size: ImageSize) -> Correction:
    """
    Tell what a nudge does to positions.

    :param surface: Maps the background's pixels to the work surface.
    :param size: Width and height of the pictures, in px.
    """
    surface = surface.for_image_size(size)
    places = _places(size)
    frame_places = nudge.frame_from_background.pixels(places)
    shift_px = float(np.hypot(*(frame_places - places).T).max())
    covariances = _covariances(nudge, frame_places, size)
    moved_cm, errors_cm = [0.0], [0.0]
    for place, there, covariance in zip(places, frame_places, covariances):
        try:
            moved = surface.locate(there[None]) - surface.locate(place[None])
            scale = scales_at(surface, place[None])[0]
        except HorizonError:
            continue
        moved_cm.append(float(np.hypot(*moved[0])))
        errors_cm.append(radius_for(_SHARE) * _deviation(scale @ covariance @ scale.T))
    return Correction(
        nudge, shift_px, _MM_PER_CM * max(moved_cm),
        _MM_PER_CM * max(errors_cm), max(map(_deviation, covariances)))


def corrected_surface(
    correction: Correction, base: SurfaceInForce, size: ImageSize
) -> SurfaceInForce:
    """
    Give the surface that holds for the nudged camera.

    :param base: That which holds for the background.
    :param size: Width and height of the pictures, in px.
    """
    nudge = correction.nudge
    background_from_frame = nudge.frame_from_background.inverse
    covariance = np.zeros((WARP_NUMBERS, WARP_NUMBERS))
    count = len(nudge.covariance)
    covariance[:count, :count] = nudge.covariance
    if base.covariance is not None:
        covariance += base.covariance
    before = base.frame_from_calibrated
    return SurfaceInForce(
        NudgedSurface(base.surface, background_from_frame, size), covariance, correction.reason,
        base.replaces, nudge.frame_from_background if before is None
        else nudge.frame_from_background.after(before))


def _places(size: ImageSize) -> np.ndarray:
    columns, rows = (np.linspace(0, length - 1, count) for length, count in zip(size, _PLACES))
    return np.stack(np.meshgrid(columns, rows), axis=2).reshape(-1, 2)


def _covariances(nudge: Nudge, frame_places: np.ndarray, size: ImageSize) -> np.ndarray:
    # Of the places, shape (n, 2, 2), in px².
    design = warp_design(
        frame_places, size, nudge.frame_from_background.lens)[:, :, :len(nudge.covariance)]
    return design @ nudge.covariance @ design.transpose(0, 2, 1)


def _deviation(covariance: np.ndarray) -> float:
    return float(np.sqrt(max(np.linalg.eigvalsh(covariance)[-1], 0.0)))


class Corrector:
    """
    Measures nudges of the camera since the background was taken.

    `correction` is the one that is believed; None for none. `doubt` is why there was none in the
    last frame that was measured. `is_refused` is whether a limit forbade to correct what it gave.

    :param background: Shape (h, w, 3), uint8, BGR.
    :param surface: Maps the background's pixels to the work surface.
    """

    def __init__(self, background: np.ndarray, surface: Surface) -> None:
        self.correction: Optional[Correction] = None
        self.doubt: Optional[str] = None
        self.is_refused = False
        self._background, self._surface = background, surface
        self._size: ImageSize = (background.shape[1], background.shape[0])
        self._meter: Optional[NudgeMeter] = None
        self._last: Optional[Correction] = None
        self._drift_count = self._failures = 0

    def has_changed(self, frame: np.ndarray, limits: Limits, *, is_held_back: bool,
                    shift_px: float) -> bool:
        """
        Measure a frame's nudge: of each frame that is held back, of others where that is due.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :param is_held_back: Whether its view cannot be believed.
        :param shift_px: Its shift since the last correction, as far as that is known.
        :returns: Whether there is another correction now.
        """
        if not self._is_due(is_held_back, shift_px):
            return False
        before, self._last = self._last, self._measured(frame, limits)
        if self._last is None or before is None or not self._is_same(before, self._last):
            return False
        return self._use(self._last)

    def may_correct(self, shift_px: Optional[float], limits: Limits) -> bool:
        """
        Tell whether the next frame may give a correction.

        :param shift_px: How far the view has moved since the background; None for not known.
        """
        return self._last is not None or (
            shift_px is not None and shift_px <= limits.correct_up_to_px)

    def use_surface(self, surface: Surface) -> None:
        """Use another surface from the next measurement on: objects of another height."""
        self._surface = surface

    def forget(self) -> None:
        """Take the camera to stand where it stood for the background."""
        self.correction = self._last = self.doubt = None
        self.is_refused = False
        self._failures = self._drift_count = 0

    def explained(self, reason: Optional[Reason]) -> Optional[Reason]:
        """Add to the reason of a moved view why it is not corrected."""
        if reason is None or reason.kind != 'view_moved' or self.doubt is None:
            return reason
        return reason._replace(sentence=f'{reason.sentence}; it is not corrected: {self.doubt}')

    def _is_due(self, is_held_back: bool, shift_px: float) -> bool:
        is_off = is_held_back or shift_px > _DRIFT_PX
        self._drift_count = self._drift_count + 1 if is_off else 0
        if not is_off:
            self._failures, self._last, self.doubt = 0, None, None
            return False
        if is_held_back:
            return True
        if self._drift_count < _DRIFT_FRAMES:
            return False
        self._failures += 1
        is_turn = self._failures <= _AT_ONCE or self._failures % _PERIOD < 2
        if not is_turn:
            self._last = None
        return is_turn

    def _measured(self, frame: np.ndarray, limits: Limits) -> Optional[Correction]:
        if self._meter is None:
            self._meter = NudgeMeter(self._background, self._surface.distortion)
        nudge = self._meter.measure(frame)
        self.is_refused = False
        if isinstance(nudge, str):
            self.doubt = nudge
            return None
        correction = correction_of(nudge, self._surface, self._size)
        self.doubt = _doubt(correction, limits) or self._pushed(frame, nudge, limits.fixed_areas)
        self.is_refused = self.doubt is not None
        return correction if self.doubt is None else None

    def _pushed(self, frame: np.ndarray, nudge: Nudge, fixed_areas: str) -> Optional[str]:
        """Say that the table was pushed, where what stands still with the robot has not moved."""
        areas = read_polygons('view.fixed_areas', fixed_areas)
        if not areas:
            return None
        fixed = np.zeros(frame.shape[:2], np.uint8)
        cv2.fillPoly(fixed, [np.round(area.corners).astype(np.int32) for area in areas], 1)
        places = nudge.frame_from_background.inverse.grid(self._size)
        inside = [side - 1.0 - _RIM_PX for side in self._size]
        known = cv2.erode(cv2.inRange(places, (_RIM_PX, _RIM_PX), tuple(inside)), _AROUND_EDGES)
        fixed &= known
        if not fixed.any():
            return None
        moved = whole = cv2.remap(self._background, places, None, cv2.INTER_LINEAR)
        # By their edges, which do not depend on the light.
        seen, still, moved = (_edges(picture)[fixed > 0] for picture in (
            frame, self._background, moved))
        off_still, off_moved = np.abs(seen - still).mean(), np.abs(seen - moved).mean()
        if (off_still < _STANDS_STILL * off_moved
                or _apart(frame, whole, fixed) > _MOST_APART_PX):
            return ('what stands in view.fixed_areas has not moved with the rest, so the table was'
                    ' pushed: push it back, or calibrate the base again')
        return None

    def _is_same(self, one: Correction, other: Correction) -> bool:
        limit = max(_SAME_PX * max(1.0, max(self._size) / _USUAL_LENGTH),
                    _SAME_DEVIATIONS * other.deviation_px)
        is_same = self._apart_px(one.nudge, other.nudge) <= limit
        self.doubt = None if is_same else 'two frames do not give the same movement'
        return is_same

    def _use(self, correction: Correction) -> bool:
        if correction.shift_px < _LEAST_NUDGE_PX:
            is_new = self.correction is not None
            self.correction = None
            return is_new
        if self.correction is not None and self._is_same(self.correction, correction):
            return False
        self.correction, self._failures, self._drift_count = correction, 0, 0
        return True

    def _apart_px(self, one: Nudge, other: Nudge) -> float:
        width, height = self._size
        places = np.array([[0, 0], [width, 0], [0, height], [width, height],
                           [width / 2, height / 2]], float)
        apart = one.frame_from_background.pixels(places) - other.frame_from_background.pixels(
            places)
        return float(np.hypot(*apart.T).max())


def _apart(frame: np.ndarray, other: np.ndarray, fixed: np.ndarray) -> float:
    """Tell how far a part of two pictures is apart, in px; 0 where that cannot be told."""
    x, y, width, height = cv2.boundingRect(fixed)
    part = np.s_[y:y + height, x:x + width]
    if min(width, height) < _LEAST_PART_PX:
        return 0.0
    edges = [_edges(picture[part]) * fixed[part][..., None] for picture in (frame, other)]
    edges = [np.hypot(*np.moveaxis(one, 2, 0)) for one in edges]
    (across, down), response = cv2.phaseCorrelate(
        *edges, cv2.createHanningWindow((width, height), cv2.CV_32F))
    return float(np.hypot(across, down)) if response > _LEAST_RESPONSE else 0.0


def _edges(picture: np.ndarray) -> np.ndarray:
    grey = cv2.GaussianBlur(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), (5, 5), 0)
    grey = np.log(np.maximum(grey, 8).astype(np.float32))
    return np.stack([cv2.Sobel(grey, cv2.CV_32F, 1, 0), cv2.Sobel(grey, cv2.CV_32F, 0, 1)], axis=2)


def _doubt(correction: Correction, limits: Limits) -> Optional[str]:
    if correction.shift_px > limits.correct_up_to_px:
        return f'view.correct_up_to_px is {limits.correct_up_to_px:g}'
    if correction.error_mm > limits.correct_error_mm:
        return (f'positions would be off by up to {correction.error_mm:.1f} mm, and '
                f'view.correct_error_mm is {limits.correct_error_mm:g}')
    return None


def kept_values(
    in_force: SurfaceInForce, calibrated: Surface, uncertainty: PositionUncertainty,
    hull: Optional[Hull], size: ImageSize,
) -> Dict[str, Any]:
    """
    Give the parameters that make the surface in force the calibrated one.

    :param calibrated: The surface of the present parameters.
    :param uncertainty: That of the calibration.
    :param hull: The area of the calibration; None for not known.
    :param size: Width and height of the pictures, in px.
    :returns: By full name.
    :raises InvalidValueError: If there is no parameter for such a surface.
    """
    found = in_force.surface.pinhole or as_homography(in_force.surface, size)
    if found is None:
        raise InvalidValueError(
            "a correction of the tutorial's polynomial cannot be kept: calibrate anew, with the "
            'model homography')
    values = surface_values(found, _moved(hull, in_force))
    values[SURFACE_COVARIANCE] = triangle_of(in_force.uncertainty(uncertainty).warp_covariance)
    place = calibrated.camera_place
    if place is not None and values['surface.model'] != 'pinhole':
        # A parallel camera need not say it.
        values['surface.camera_foot_cm'] = list(place.foot_cm)
    return values


def _moved(hull: Optional[Hull], in_force: SurfaceInForce) -> Optional[Hull]:
    if hull is None or in_force.frame_from_calibrated is None:
        return None
    moved = in_force.frame_from_calibrated.pixels(hull.corners)
    return Hull(moved) if np.isfinite(moved).all() else None
