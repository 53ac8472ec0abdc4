# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Where the camera stands: the surface and the background that hold there."""

from dataclasses import dataclass, replace
import time
from typing import Callable, Generic, List, NamedTuple, Optional, Tuple, TypeVar

from camera_to_base.checks import ImageSize
from camera_to_base.errors import FrameSizeError
from camera_to_base.pipeline.place import SeenBackground, SurfaceInForce
from camera_to_base.pipeline.view.correction import corrected_surface, Correction
from camera_to_base.surface import is_same_surface, NudgedSurface, Surface
import numpy as np

T = TypeVar('T')


class Background(NamedTuple):
    """
    A background as it was taken.

    :param picture: Shape (h, w, 3), uint8, BGR.
    :param taken_at: When it was taken, by time.monotonic().
    :param witness: Another frame from then, of the same shape; None where there is none.
    :param is_restored: Whether it is from a file.
    :param unknown: What it does not show, shape (h, w), uint8, 255 there; None for nothing.
    """

    picture: np.ndarray
    taken_at: float
    witness: Optional[np.ndarray] = None
    is_restored: bool = False
    unknown: Optional[np.ndarray] = None

    @property
    def age_s(self) -> float:
        """Its age, in s."""
        return time.monotonic() - self.taken_at


@dataclass(frozen=True, eq=False)
class Standpoint:
    """
    Where the camera stands. It does not change: a camera that stands elsewhere has another one.

    A background belongs to one place of the camera. Two standpoints with the same object as
    `background` differ in the surface at most, and two with the same `uncorrected.background` in
    a nudge.

    :param calibrated: The surface as calibrated.
    :param surface: What the pixels of the camera's frames mean.
    :param taken: The background as it was taken; this and the next two are None before the first.
    :param background: The same as the camera sees it from here.
    :param background_as_calibrated: The same as the camera sees it from where it was calibrated.
    :param may_correct: Whether a nudge may be corrected: the background's pixels are those that
        the surface maps.
    :param correction: How the camera was nudged since the background was taken; None for not at
        all.
    :param before_nudge: Where it stood when the background was taken; None for here.
    :param follows: The background at the standpoint before, where that is no farther than a nudge
        from here; None elsewhere.
    """

    calibrated: Surface
    surface: SurfaceInForce
    taken: Optional[Background] = None
    background: Optional[SeenBackground] = None
    background_as_calibrated: Optional[SeenBackground] = None
    may_correct: bool = False
    correction: Optional[Correction] = None
    before_nudge: Optional['Standpoint'] = None
    follows: Optional[SeenBackground] = None

    @classmethod
    def as_calibrated(cls, surface: Surface) -> 'Standpoint':
        """Give that of a camera which stands where it was calibrated, without a background."""
        return cls(surface, SurfaceInForce(surface))

    @property
    def uncorrected(self) -> 'Standpoint':
        """Where the camera stood when the background was taken."""
        return self if self.before_nudge is None else self.before_nudge

    def with_background(self, taken: Background, may_correct: bool = True) -> 'Standpoint':
        """Give the same place with a background that the camera has taken from there."""
        seen = _seen(taken)
        return replace(
            self, taken=taken, background=seen,
            background_as_calibrated=seen.as_calibrated(
                self.surface.frame_from_calibrated, self.background_as_calibrated),
            may_correct=may_correct, correction=None, before_nudge=None, follows=None)

    def with_surface(self, surface: Optional[SurfaceInForce]) -> 'Standpoint':
        """
        Give another place, where another surface holds.

        Frames are held back until there is a background of it, and the movement from the old
        place is not corrected.

        :param surface: None for the calibrated one.
        """
        return replace(
            self, surface=SurfaceInForce(self.calibrated) if surface is None else surface,
            background=None if self.taken is None else _seen(self.taken),
            may_correct=False, correction=None, before_nudge=None, follows=None)

    def nudged(self, correction: Optional[Correction], frame: np.ndarray) -> 'Standpoint':
        """
        Give the place to which the camera was nudged.

        :param correction: None for that where the background was taken.
        :param frame: Shape (h, w, 3), uint8, BGR, of the camera there.
        """
        before = self.uncorrected
        if correction is None:
            return replace(before, follows=self.background)
        return replace(
            before, surface=corrected_surface(correction, before.surface, self._size),
            background=before.background.seen_after(correction.nudge.frame_from_background, frame),
            correction=correction, before_nudge=before, follows=self.background)

    def recalibrated(self, surface: Surface, is_held_back: bool) -> 'Standpoint':
        """
        Give the place by a new calibration.

        It ends a correction: where the camera stood for it is not known. One that says what the
        correction says makes it needless.

        :param is_held_back: Whether the view cannot be believed.
        """
        if surface == self.calibrated:
            return self
        try:
            if self.surface.reason is not None and self._is_in_force(surface):
                return self._kept(surface)
            in_force = self._surface_by(surface, is_held_back)
        except FrameSizeError:
            # There is no such place: the detection tells why.
            in_force = None
        there = replace(self, calibrated=surface)
        if in_force is None:
            return there.with_surface(None)
        before = replace(self.uncorrected, calibrated=surface, surface=in_force)
        if self.correction is None:
            return before
        return replace(there, surface=corrected_surface(self.correction, in_force, self._size),
                       before_nudge=before)

    def without_correction(self) -> 'Standpoint':
        """Give the place as it is known without a correction."""
        before = self.uncorrected.surface
        # A surface by markers is measured, not corrected.
        if before.replaces:
            return self if self.correction is None else self.with_surface(before)
        return self if self.surface.frame_from_calibrated is None else self.with_surface(None)

    def _surface_by(self, surface: Surface, is_held_back: bool) -> Optional[SurfaceInForce]:
        # Where the background was taken; None if that place is not known.
        is_same = self._is_calibration(surface)
        before = self.uncorrected.surface
        moved = before.frame_from_calibrated
        if self.surface.reason is None and (is_same or not is_held_back):
            return SurfaceInForce(surface)
        if is_same and not before.replaces:
            return before._replace(surface=surface if moved is None else NudgedSurface(
                surface, moved.inverse, self._size))
        return None

    def _is_calibration(self, surface: Surface) -> bool:
        # Another height of the camera moves no pixel on the surface.
        return surface is self.calibrated or (
            self.taken is not None and is_same_surface(surface, self.calibrated, self._size))

    def _is_in_force(self, surface: Surface) -> bool:
        return self.taken is not None and is_same_surface(
            surface, self.surface.surface, self._size)

    def _kept(self, surface: Surface) -> 'Standpoint':
        # The background as the camera sees it is one that was taken from here.
        there = replace(self, calibrated=surface, surface=SurfaceInForce(surface))
        taken = self.taken._replace(**self.background._asdict())
        return replace(there.with_background(taken), follows=self.background)

    @property
    def _size(self) -> ImageSize:
        height, width = self.taken.picture.shape[:2]
        return width, height


class PerBackground(Generic[T]):
    """
    What a stage knows for each background of a standpoint: as it was taken, and after a nudge.

    :param make: Makes it for a background.
    """

    def __init__(self, make: Callable[[SeenBackground], T]) -> None:
        self._make = make
        self._made: List[Tuple[SeenBackground, T]] = []

    def of(self, background: SeenBackground) -> T:
        """Give what belongs to a background."""
        for known, made in self._made:
            if known is background:
                return made
        made = self._make(background)
        self._made.append((background, made))
        return made

    def made(self) -> List[T]:
        """Give all that was made and kept."""
        return [made for _, made in self._made]

    def keep(self, standpoint: Standpoint) -> None:
        """Forget what does not belong to a standpoint."""
        both = standpoint.background, standpoint.uncorrected.background
        self._made = [(known, made) for known, made in self._made
                      if any(known is other for other in both)]


def _seen(taken: Background) -> SeenBackground:
    return SeenBackground(taken.picture, taken.witness, taken.unknown)
