# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The cheapest look: whether a few patches of the surface say that the camera stands still."""

from math import hypot
from typing import Optional, Tuple

from camera_to_base.trust.view.look import ViewLook
from camera_to_base.trust.view.motion_fit import MotionFit, SIMILARITY, TILTED
from camera_to_base.trust.view.patch_fit import PatchFit
from camera_to_base.trust.view.structure import Structure
import numpy as np

# One patch in each of 4 x 4 parts of the picture: an arm or a few objects cover some of them.
_PARTS = 4
# What they say counts where so much of the structure agrees on a motion of at most so many px, and
# on a tilt of no more.
_LEAST_SHARE, _LARGEST_PX = 0.7, 0.5


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
