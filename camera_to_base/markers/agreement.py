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
"""Which of the seen markers lie where they were, and the surface by those."""

from typing import NamedTuple, Optional, Sequence, Tuple

from camera_to_base.errors import CameraToBaseError
from camera_to_base.markers.specs import LEAST_MARKERS
from camera_to_base.markers.surface_fit import Corners, fit_markers, MarkerFit, scale_of
from camera_to_base.surface import ImageSize, RadialDistortion
import numpy as np

# A marker whose middle is seen this near to where the surface has it has not moved, and neither
# has the camera, in px of a picture 1280 px wide.
_IN_PLACE_PX = 1.0
# Residuals of markers that fit to each other stay below 0.29 px in simulation, lenses of other
# models included; a marker that was moved by 3 mm gives 0.3 px and more.
_FIT_PX = 0.3
# Without a marker that was moved by 1 mm, the others fit better by this factor in the median.
_BETTER_WITHOUT = 3.0
_LEAST_MOVE_CM = 0.1


class Verdict(NamedTuple):
    """
    What the markers of a picture say.

    :param in_place: The markers that are seen where the surface in use has them.
    :param moved: Those that were moved on the table.
    :param fit: The surface by the markers, where the camera stands elsewhere; None where the
        surface in use holds, or where it cannot be told.
    :param trouble: Why it cannot be told, a sentence; '' where it can.
    """

    in_place: Tuple[int, ...] = ()
    moved: Tuple[int, ...] = ()
    fit: Optional[MarkerFit] = None
    trouble: str = ''


def judge_markers(
    known: Corners, shown: Corners, seen: Corners, image_size: ImageSize,
    lens: RadialDistortion, *, tolerance_px: float = 0.0,
) -> Verdict:
    """
    Compare the markers of a picture with the surface in use.

    :param known: By number, shape (4, 2), in cm, at least three.
    :param shown: The same, in px, where the surface in use has them; NaN where it does not.
    :param seen: By number, shape (4, 2), in px.
    :param tolerance_px: By how much more than usual markers in place may be seen elsewhere.
    """
    seen = {number: corners for number, corners in seen.items() if number in known}
    if not seen:
        return Verdict(trouble='no marker is seen')
    near, limit_px = [], _IN_PLACE_PX * scale_of(image_size) + tolerance_px
    for number, corners in seen.items():
        shift = corners.mean(axis=0) - shown[number].mean(axis=0)
        if np.linalg.norm(shift) <= limit_px:  # not so for NaN
            near.append(number)
    away = tuple(sorted(set(seen) - set(near)))
    if not away or len(near) >= LEAST_MARKERS:
        return Verdict(tuple(sorted(near)), away)
    if len(seen) < LEAST_MARKERS or len(seen) == LEAST_MARKERS == len(near) + 1:
        verb = 'is' if len(away) == 1 else 'are'
        return Verdict(tuple(sorted(near)), trouble=(
            f'{names_of(away)} {verb} not where the calibration has it, and only {len(seen)} of '
            f'{len(known)} markers are seen'))
    return _fitted(known, seen, image_size, lens)


def _fitted(
    known: Corners, seen: Corners, image_size: ImageSize, lens: RadialDistortion
) -> Verdict:
    limit_px = _FIT_PX * scale_of(image_size)
    try:
        everything = fit_markers(known, seen, image_size, lens)
        others = _best_without_one(known, seen, image_size, lens)
        if others is not None and others.rms_px * _BETTER_WITHOUT < everything.rms_px:
            number, = set(seen) - set(others.numbers)
            has_moved = _shift_cm(known, seen, number, others) >= _LEAST_MOVE_CM
            if has_moved and others.rms_px <= limit_px:
                return Verdict(moved=(number,), fit=others)
    except CameraToBaseError as error:
        return Verdict(trouble=str(error))
    if everything.rms_px <= limit_px:
        return Verdict(fit=everything)
    return Verdict(trouble=(
        f'{names_of(everything.numbers)} do not lie to each other as they did, by '
        f'{everything.rms_px:.1f} px: one was moved, or the paper is not flat'))


def _best_without_one(
    known: Corners, seen: Corners, image_size: ImageSize, lens: RadialDistortion
) -> Optional[MarkerFit]:
    """Return the best fit to all markers but one; None where too few are left."""
    if len(seen) <= LEAST_MARKERS:
        return None
    fits = [fit_markers(known, {number: corners for number, corners in seen.items()
                                if number != left_out}, image_size, lens) for left_out in seen]
    return min(fits, key=lambda fit: fit.rms_px)


def _shift_cm(known: Corners, seen: Corners, number: int, fit: MarkerFit) -> float:
    there = fit.surface.locate(seen[number]).mean(axis=0)
    return float(np.linalg.norm(there - known[number].mean(axis=0)))


def names_of(numbers: Sequence[int]) -> str:
    """Give the names of markers for a sentence."""
    names = ', '.join(map(str, numbers))
    return f'marker {names}' if len(numbers) == 1 else f'markers {names}'
