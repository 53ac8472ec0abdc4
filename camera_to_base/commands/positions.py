# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Runs the camera's pipeline on a recording, counts the results, and formats them as a table."""

from collections import Counter
import math
from typing import Callable, Dict, Iterator, List, NamedTuple, Optional

from camera_to_base.coordinate_transform import Pose
from camera_to_base.detection import LocatedObject, Size
from camera_to_base.errors import CameraToBaseError, HorizonError, Level, OutOfReachError, Reason
from camera_to_base.pipeline import DamageCheck, FrameUncertainty, Sighting
from camera_to_base.settings import CameraSettings
from camera_to_base.sources import SourceKind, TimedFrame, VIDEO_FILE
from camera_to_base.surface import Surface
from camera_to_base.uncertainty import (
    Ellipse, error_ellipse, PositionCovariance, UncertainTransform)
import numpy as np

# Kinds of reasons that do not depend on the detector's settings.
_UNUSABLE = {'damaged', 'frame_size', 'frame_unusable', 'beyond_horizon'}


class Column(NamedTuple):
    """
    One column of the table.

    :param width: In characters, in the text table; 0 for a column of the CSV only.
    :param decimals: In the text table.
    """

    name: str
    width: int
    decimals: int


COLUMNS = (
    Column('frame', 6, 0), Column('time_s', 14, 3), Column('object', 6, 0),
    Column('u_px', 7, 1), Column('v_px', 7, 1),
    Column('x_cam_cm', 8, 2), Column('y_cam_cm', 8, 2),
    Column('x_base_cm', 9, 2), Column('y_base_cm', 9, 2), Column('z_base_cm', 0, 2),
    Column('yaw_base_deg', 12, 1),
    Column('long95_mm', 9, 1), Column('short95_mm', 0, 1), Column('angle95_base_deg', 0, 1),
    Column('yaw_sd_deg', 0, 1), Column('length_cm', 0, 2), Column('width_cm', 0, 2),
    Column('height_cm', 0, 2))
_CSV_DECIMALS = 4
_SHARE, _MM_PER_CM = 0.95, 10


class Position(NamedTuple):
    """
    The position of one object.

    :param timed: The frame.
    :param number: 1 is the largest of its frame.
    :param found: The object on the picture and in the camera frame.
    :param base: The pose in the base frame, in cm and rad; None beyond reach_cm.
    :param ellipse: Contains 95 % of the errors in the base frame, in cm; None beyond reach_cm.
    :param yaw_deviation: Standard deviation of the yaw, in rad.
    :param size: Length, width and height; None where a part is beyond the horizon.
    """

    timed: TimedFrame
    number: int
    found: LocatedObject
    base: Optional[Pose]
    ellipse: Optional[Ellipse]
    yaw_deviation: float
    size: Optional[Size] = None

    @property
    def values(self) -> List[Optional[float]]:
        """One number for each column; None for an empty cell."""
        found, base, nothing = self.found, self.base, (None, None, None)
        # A round object has no yaw.
        has_yaw = base is not None and found.yaw is not None
        return [self.timed.number, self.timed.stamp_ns / 1e9, self.number,
                *found.detection.centre, *found.point, *(nothing if base is None else base[:3]),
                math.degrees(base.yaw) if has_yaw else None, *self._ellipse_values,
                math.degrees(self.yaw_deviation) if has_yaw else None,
                *(nothing if self.size is None else self.size[:3])]

    @property
    def _ellipse_values(self) -> List[Optional[float]]:
        if self.ellipse is None:
            return [None] * 3
        long, short, angle = self.ellipse
        return [_MM_PER_CM * long, _MM_PER_CM * short, math.degrees(angle)]


def positions(
    timed: TimedFrame, objects: List[LocatedObject], transform: UncertainTransform,
    covariance_of: Callable[[LocatedObject], PositionCovariance], surface: Surface,
) -> Iterator[Position]:
    """
    Convert the objects of a frame to the base frame.

    :param objects: The largest first.
    :param covariance_of: Gives the covariance of an object's position in the camera frame.
    :param surface: Maps the frame's pixels to the work surface.
    :raises CameraToBaseError: If a point cannot be converted.
    """
    for number, found in enumerate(objects, start=1):
        pose = Pose(*found.point, 0.0, found.yaw or 0.0)
        covariance = transform.base_covariance(pose[:3], covariance_of(found).matrix)
        ellipse: Optional[Ellipse] = error_ellipse(covariance, _SHARE)
        try:
            base = transform.settings.base_pose(pose)
        except OutOfReachError:
            base = ellipse = None
        try:
            size: Optional[Size] = found.size(surface)
        except HorizonError:
            size = None
        yield Position(timed, number, found, base, ellipse, math.sqrt(covariance[5, 5]), size)


def table_header() -> str:
    """Return the first line of the text table."""
    return '  '.join(column.name.rjust(column.width) for column in COLUMNS if column.width)


def table_line(position: Position) -> str:
    """Return an object's line of the text table."""
    return '  '.join(
        ('-' if value is None else f'{value:.{column.decimals}f}').rjust(column.width)
        for column, value in zip(COLUMNS, position.values) if column.width)


def csv_cells(position: Position) -> List[str]:
    """Return an object's row of the CSV file; missing values are empty cells."""
    cells = ['' if value is None else f'{value:.{_CSV_DECIMALS if column.decimals else 0}f}'
             for column, value in zip(COLUMNS, position.values)]
    # From integers: a float cannot hold a time since 1970 to the ns. The stamp must stay exact.
    cells[1] = '{}.{:09d}'.format(*divmod(position.timed.stamp_ns, 10**9))
    return cells


class SightingCounter:
    """
    The camera node's pipeline, with counts of its results.

    :param settings: The camera node's settings.
    :param kind: The kind of source.
    :param source: The source's name; '' if it is not known.
    :param damage: Finds damaged frames; None for a recording.
    """

    def __init__(
        self, settings: CameraSettings, kind: SourceKind = VIDEO_FILE, source: str = '',
        damage: Optional[DamageCheck] = None,
    ) -> None:
        self._pipeline = settings.pipeline(source, kind, damage=damage)
        self._uncertainty = settings.uncertainty
        self.frames = self._with_one = self._with_more = 0
        self._counts: Counter = Counter()
        self._first: Dict[str, Reason] = {}
        self._doubts: Dict[str, Reason] = {}

    def see(self, timed: TimedFrame) -> Sighting:
        """
        Find the objects on a frame.

        :returns: The objects, and the reason if they would not be published, for example if the
            frame cannot be decoded.
        """
        self.frames += 1
        sighting = self._sighting(timed)
        reason = sighting.warning
        if reason is not None:
            self._counts[reason.kind] += 1
            self._first.setdefault(reason.kind, reason)
        elif len(sighting.objects) == 1:
            self._with_one += 1
        elif sighting.objects:
            self._with_more += 1
        return sighting

    def uncertainty(self, frame: np.ndarray) -> FrameUncertainty:
        """Return the uncertainty of the positions on the last frame."""
        return self._pipeline.frame_uncertainty(frame, self._uncertainty)

    @property
    def surface(self) -> Surface:
        """The surface by which the last frame's objects were located."""
        return self._pipeline.standpoint.surface.surface

    def check_any_used(self) -> None:
        """
        Check that at least one frame could be used.

        :raises CameraToBaseError: If no frame could be used; the message says why.
        """
        unusable = [kind for kind in self._counts if kind in _UNUSABLE]
        refused = sum(self._counts[kind] for kind in unusable)
        background = sum(count for kind, count in self._counts.items()
                         if kind.startswith('background_'))
        if self.frames and refused >= max(self.frames - background - 1, 1):
            raise CameraToBaseError(
                f'no frame could be used: {self._first[unusable[0]].sentence}')

    def summary(self) -> List[str]:
        """Return the counts as lines of text."""
        lines = [f'{self.frames} frames: {self._with_one + self._with_more} with an object '
                 f'({self._with_one} with one, {self._with_more} with more)']
        lines += [
            f'frames held back: {count} ({kind}, the first: {self._first[kind].sentence})'
            for kind, count in self._counts.most_common()]
        return lines + [f'warning: {doubt.sentence}' for doubt in self._doubts.values()]

    def _sighting(self, timed: TimedFrame) -> Sighting:
        try:
            frame = timed.frame
        except CameraToBaseError as error:
            return Sighting([], Reason('damaged', Level.ERROR, str(error)))
        sighting = self._pipeline.process(frame, timed.taken_at)
        doubt = self._pipeline.doubt
        if doubt is not None and sighting.reason is None:
            self._doubts.setdefault(doubt.kind, doubt)
        return sighting
