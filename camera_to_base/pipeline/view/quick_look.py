# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The cheap look at every frame: whether the structure of the surface is in its place."""

from math import hypot
from typing import NamedTuple, Optional, Tuple

from camera_to_base.detection import white_noise
from camera_to_base.pipeline.view.motion_fit import (
    Motion, MotionFit, SIMILARITY, Structure, TILTED)
from camera_to_base.pipeline.view.patches import (
    find_places, Patches, PatchFit, PatchShifts, step_for)
import cv2
import numpy as np

# One patch in each of 4 x 4 parts of the picture: an arm or a few objects cover some of them.
_PARTS = 4
# What they say counts where so much of the structure agrees on a motion of at most so many px, and
# on a tilt of no more.
_LEAST_SHARE, _LARGEST_PX = 0.7, 0.5

# A patch shows structure from this many variances of the noise on, and from these levels².
_FAINTEST_VARIANCES, _FAINTEST_ENERGY = 0.25, 0.15
# Rounding to grey levels.
_ROUNDING = 1 / 12
# Where less of the structure than this share stays in place from one frame to the next, the
# surface itself moves (a belt), or it is noise of the camera's compression.
_LEAST_AT_REST = 0.5
# The surface's are told from noise by this: half of the patches tell a shift to 1.4 px or better,
# in 1/px², along both axes together.
_TELLING = 1.0
# A tilt counts where it moves a corner by this many px and by so many of its deviations, and where
# so many patches agree on it.
_LEAST_TILT_PX, _TILT_DEVIATIONS, _TILT_PATCHES = 0.8, 5.0, 12
# The noise of a frame is measured on a square of this many px.
_NOISE_LENGTH = 240
# What is usually left changes by this factor at most from one frame to the next, and by the other
# one where all of the frame was compared; and it is at most so many times the noise.
_FASTEST, _FASTEST_IN_FULL, _MOST_USUAL = 1.02, 1.5, 16.0
# From one frame to the next, a view at rest moves by less, in px. Where the patches agree on no
# motion, they differ by less than this beyond the noise, in levels²: a camera's compression.
_AT_REST_PX, _COMPRESSION = 0.8, 2.0


class ViewLook(NamedTuple):
    """
    What the cheap look tells of a frame.

    :param share: How much of the structure agrees on a motion: of that which tells the least
        certain direction, 0..1.
    :param shift_px: How far the picture's centre or a corner has moved, the farthest of them.
    :param matrix: Shape (2, 3), maps the background's pixels to the frame's; (3, 3) with a tilt.
    :param patch_share: How many of the patches agree, 0..1.
    :param surplus: How many times the known noise is left unexplained, see `PatchShifts`.

    A glance gives neither matrix nor patch share: it tells that the camera stands still.
    """

    share: float
    shift_px: float
    surplus: float
    matrix: Optional[np.ndarray] = None
    patch_share: Optional[float] = None


class Glance:
    """
    Looks at the best patch in each of 16 parts of the picture.

    :param places: Shape (n, 2), the centres of all patches, in px.
    :param size: Width and height of the picture, in px.
    :param fit: That of all patches.
    """

    def __init__(self, places: np.ndarray, size: Tuple[int, int], fit: PatchFit) -> None:
        chosen = _chosen(places, size, fit.shift_axes)
        self._fit = fit.part(chosen)
        self._motion_fit = MotionFit(places[chosen], size, self._fit.shift_axes, TILTED)
        self._structure = Structure(self._similarity(np.ones(len(chosen))))

    def look(self, frame: np.ndarray, usual: float = 1.0) -> Optional[ViewLook]:
        """
        Look at a frame.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :param usual: How many times the known noise is usual.
        :returns: None where it is not clear that the camera stands still.
        """
        seen = self._fit.near_rest(frame, usual) if self._structure.tells_all else None
        if seen is None:
            return None
        motion = self._motion_fit.near_rest(seen.shifts, seen.is_seen, seen.precision)
        right, down, growth, turn, *tilt = motion.numbers.tolist()
        # No place moves farther than that, the corners may.
        shift_px = hypot(right, down) + hypot(growth, turn)
        if max(shift_px, hypot(*tilt)) > _LARGEST_PX:
            return None
        share = 1.0
        if seen.worth is not None or not motion.agrees.all():
            worth = 1.0 if seen.worth is None else seen.worth
            share = self._structure.share(self._similarity(motion.agrees * worth))
        return ViewLook(share, shift_px, seen.surplus) if share >= _LEAST_SHARE else None

    def _similarity(self, weights: np.ndarray) -> np.ndarray:
        # A tilt is not among what a surface must tell.
        return self._motion_fit.total(weights)[:SIMILARITY, :SIMILARITY]


def _chosen(places: np.ndarray, size: Tuple[int, int], axes: np.ndarray) -> np.ndarray:
    # Indices of the patches that tell most along the direction that they tell least of.
    across, down = np.floor(places * _PARTS / size).astype(int).T
    part, telling = down * _PARTS + across, np.square(axes).sum(axis=2).min(axis=1)
    order = np.argsort(-telling, kind='stable')
    return np.sort(order[np.unique(part[order], return_index=True)[1]])


class QuickLook:
    """
    Compares some 64 patches of the background with a frame.

    :param background: Shape (h, w, 3), uint8, BGR.
    :param witness: Another frame from when the background was taken, of the same shape: structure
        that is not at rest in it does not count.

    `surface_moves` tells whether most of it was not at rest, as that of a belt.
    """

    def __init__(self, background: np.ndarray, witness: Optional[np.ndarray] = None) -> None:
        self._background = background
        self._size = background.shape[1], background.shape[0]
        self._grey = _grey(background)
        self._noise = white_noise(self._grey)
        # A sample is the mean of 4 px.
        self._background_variance = (self._noise ** 2 + 2 * _ROUNDING) / 4
        self._variance = 2 * self._background_variance
        # No other frame tells faint structure from what compression left of the noise.
        places = self._with_structure(find_places(self._grey, step_for(self._size)),
                                      _COMPRESSION if witness is None else _FAINTEST_ENERGY)
        self.surface_moves, self._usual = False, 1.0
        self._usual_noise = white_noise(_middle(background if witness is None else witness))
        if witness is not None and len(places):
            places = self._at_rest(places, witness)
        self._structure: Optional[Structure] = None
        if len(places):
            self._use(places)

    @property
    def has_structure(self) -> bool:
        """Whether the surface tells a shift in any direction."""
        return self._structure is not None and self._structure.told.size > 0

    @property
    def tells_all(self) -> bool:
        """Whether the surface tells every shift, rotation and scale."""
        return self._structure is not None and self._structure.tells_all

    def glance(self, frame: np.ndarray) -> Optional[ViewLook]:
        """
        Look at a few patches of a frame of the background's size, in a third of the time.

        :returns: None where it is not clear from them that the camera stands still.
        """
        return self._glance.look(frame, self._usual) if self.has_structure else None

    def look(self, frame: np.ndarray) -> Optional[ViewLook]:
        """
        Look at all patches of a frame of the background's size.

        :returns: None where the surface has no structure.
        """
        return self._look_at(self._fit.measure(frame, self._usual)) if self.has_structure else None

    def _look_at(self, seen: PatchShifts) -> ViewLook:
        tilted = self._tilted(seen)
        if tilted is not None:
            return self._told_by(seen, tilted.agrees, self._tilt_fit, tilted.numbers)
        motion = self._motion_fit.solve(seen.shifts, seen.is_seen, seen.precision)
        return self._told_by(
            seen, motion.agrees, self._motion_fit, self._told_part @ motion.numbers)

    def learn(self, look: ViewLook, in_full: bool = False) -> None:
        """
        Learn from a frame that was cleared how much of a patch is usually left unexplained.

        Noise grows in the dark, and a background of several frames has less of it than a frame.

        :param look: That at the frame.
        :param in_full: Whether all of the frame was compared.
        """
        fastest = _FASTEST_IN_FULL if in_full else _FASTEST
        usual = min(max(look.surplus, self._usual / _FASTEST), self._usual * fastest)
        self._usual = min(max(usual, 1.0), _MOST_USUAL)

    def learn_noise(self, frame: np.ndarray) -> None:
        """Learn the same from the noise of a frame alone, wherever the camera stands."""
        more = (white_noise(_middle(frame)) ** 2 - self._usual_noise ** 2) / 4
        self._usual = min(max(1 + more / self._variance, self._usual), _MOST_USUAL)

    def has_moved(self, frame: np.ndarray) -> bool:
        """
        Tell whether a frame soon after the background shows that the camera or the surface moves.

        :returns: False where the surface has no structure.
        """
        if not self.has_structure:
            return False
        seen = self._fit.measure(frame, self._usual)
        look = self._look_at(seen)
        if look.shift_px > _AT_REST_PX or look.share >= _LEAST_AT_REST:
            return look.shift_px > _AT_REST_PX
        noise = self._variance * (1 + seen.gain ** 2) / 2
        return float(seen.residuals.mean()) - noise > _COMPRESSION

    def _told_by(self, seen: PatchShifts, agrees: np.ndarray, fit: MotionFit,
                 numbers: np.ndarray) -> ViewLook:
        share = self._structure.share(self._motion_fit.total(agrees * seen.worth))
        return ViewLook(share, fit.farthest_px(numbers), seen.surplus, fit.matrix(numbers),
                        agrees.mean())

    def _tilted(self, seen: PatchShifts) -> Optional[Motion]:
        # The motion with a tilt, where that is certain.
        if not self.tells_all:
            return None
        motion = self._tilt_fit.solve(seen.shifts, seen.is_seen, seen.precision)
        tilt = motion.numbers[SIMILARITY:]
        if np.hypot(*tilt) < _LEAST_TILT_PX or motion.agrees.sum() < _TILT_PATCHES:
            return None
        covariance = self._tilt_fit.covariance(
            motion.agrees, seen.precision)[SIMILARITY:, SIMILARITY:]
        is_certain = tilt @ np.linalg.solve(covariance, tilt) > _TILT_DEVIATIONS ** 2
        return motion if is_certain else None

    def _make_fit(self, places: np.ndarray) -> PatchFit:
        return PatchFit(Patches(places, step_for(self._size)), self._background, self._grey,
                        self._noise, self._variance)

    def _with_structure(self, places: np.ndarray, least: float) -> np.ndarray:
        if not len(places):
            return places
        energy = self._make_fit(places).energy - self._background_variance
        return places[energy > max(_FAINTEST_VARIANCES * self._variance, least)]

    def _at_rest(self, places: np.ndarray, witness: np.ndarray) -> np.ndarray:
        # Those of the places that are; notes whether there are none though they tell a shift.
        fit = self._make_fit(places)
        seen = fit.measure(witness)
        if seen.is_seen.any():
            self._variance = max(float(np.median(seen.residuals[seen.is_seen])),
                                 self._background_variance)
        motion = MotionFit(places, self._size, fit.shift_axes).solve(seen.shifts, seen.is_seen)
        weights = np.square(fit.shift_axes).sum(axis=(1, 2))
        if weights @ motion.agrees >= _LEAST_AT_REST * weights.sum():
            return places[motion.agrees]
        # What compression leaves of the noise is another one in each frame, too.
        is_surface = fit.energy > self._background_variance + _COMPRESSION
        self.surface_moves = float(np.median(weights * is_surface)) >= _TELLING
        return places[:0]

    def _use(self, places: np.ndarray) -> None:
        self._fit = self._make_fit(places)
        self._motion_fit = MotionFit(places, self._size, self._fit.shift_axes)
        self._tilt_fit = MotionFit(places, self._size, self._fit.shift_axes, TILTED)
        self._structure = Structure(self._motion_fit.total(np.ones(len(places))))
        self._told_part = self._structure.told @ self._structure.told.T
        self._glance = Glance(places, self._size, self._fit)


def _grey(picture: np.ndarray) -> np.ndarray:
    return cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY).astype(np.float32)


def _middle(picture: np.ndarray) -> np.ndarray:
    # Enough of it to tell its noise, in grey.
    v, u = (max(0, (length - _NOISE_LENGTH) // 2) for length in picture.shape[:2])
    return _grey(picture[v:v + _NOISE_LENGTH, u:u + _NOISE_LENGTH])
