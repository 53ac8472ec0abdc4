# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
The rim at which an object's top and its near side meet: it tells heights, and what is a side.

The outline alone tells neither: what is low and long has the outline of what is high and short,
and a side may be shade. The rim is the near outline of what the object stands on, seen farther
from the camera's foot by as much as the object is high, and the picture has a step along all of
it, as top and side are lit differently.
"""

from typing import Callable, Dict, Optional, Sequence

from camera_to_base.coordinate_transform import CameraPlace
from camera_to_base.surface import RayedSilhouette, Surface
import cv2
import numpy as np

# The silhouette of a height that fits has the first share of its width; what has less than the
# second does not fit. Light that notches a silhouette makes the share smaller: the second is asked
# only of what no rim tells. Heights are told inexactly: both are asked of one that is smaller by
# this share of the gap to the next lower one.
_LEAST_FIT, _BAD_FIT, _INEXACT = 0.9, 0.955, 0.25
# A step of so many grey levels is a rim, one of less than the second none, and the rim of one
# height is so many times that of the others. In rendered cells (600 discs, boxes and cylinders
# below a tilted camera), 96 of 100 rims are 15 to 80 levels high, and what is none 0 to 6.
_RIM, _NO_RIM, _TIMES = 8.0, 4.0, 3.0
# A step of so many grey levels is the lower end of a side, or of fewer, as a rim, where other
# heights have none: that of flat discs' surroundings is up to 13 on wood.
_FOOT = 16.0
# A rim is seen apart from the outline where it is farther from it than this, in px, along so large
# a share of its length.
_APART_PX, _LEAST_SHARE = 6.0, 0.5
# A side that is seen narrower than this, in px, may be missing as a whole: of 180 boxes below a
# straight camera, 6 sides were taken for shade.
_WIDE_SIDE_PX = 12.0
# The step is taken over twice this, in px, and looked for at heights up to this share beside.
_HALF_STEP_PX, _BESIDE = 1.5, (-0.05, -0.025, 0.0, 0.025, 0.05)
# Top and side need not differ everywhere, such as at a box's other side: of so many parts of the
# rim, so many may have a smaller step.
_PARTS, _MAY_BE_LESS = 8, 2
_BLUR_PX, _MARGIN_PX = 0.7, 6


def told_height(
    rayed: RayedSilhouette, outline: np.ndarray, frame: np.ndarray, surface: Surface,
    camera: CameraPlace, heights_cm: Sequence[float],
) -> Optional[float]:
    """
    Tell which of several heights an object has.

    :param rayed: Its silhouette on the surface.
    :param outline: Its silhouette on the picture, shape (n, 2), in px.
    :param frame: The picture, shape (h, w, 3), uint8, BGR.
    :param surface: Maps the frame's pixels to the work surface.
    :param heights_cm: Ascending.
    :returns: In cm; None where it has none of them, or where that cannot be told.
    """
    gaps = np.diff([0.0, *heights_cm])
    fits = {height: rayed.footprint((height - _INEXACT * gap) / camera.height_cm).fit
            for height, gap in zip(heights_cm, gaps.tolist())}
    rims = _steps(rayed.near_rim, outline, frame, surface, camera, heights_cm)
    best = max(rims, key=rims.__getitem__, default=None)
    if best is not None and rims[best] >= _RIM:
        others = [step for height, step in rims.items() if height != best]
        is_clear = rims[best] >= _TIMES * max(others, default=0.0)
        return best if is_clear and fits[best] >= _LEAST_FIT else None
    lowest, *higher = heights_cm
    are_excluded = all(
        _side_px(outline, surface, camera, height) >= _WIDE_SIDE_PX and (
            fits[height] <= _BAD_FIT or rims.get(height, _RIM) < _NO_RIM and (
                rayed.footprint(height / camera.height_cm).fit <= _BAD_FIT))
        for height in higher)
    # No rim is seen of what is lower than the rim's distance from the outline.
    if not are_excluded or fits[lowest] <= _BAD_FIT:
        return None
    # The side may have been taken for shade: then it ends where that of a height would.
    feet = sorted(_steps(rayed.near_foot, outline, frame, surface, camera, higher).values())
    is_foot = bool(feet) and feet[-1] >= _FOOT or len(feet) > 1 and (
        feet[-1] >= max(_NO_RIM, _TIMES * feet[-2]))
    return None if is_foot else lowest


def _side_px(
    outline: np.ndarray, surface: Surface, camera: CameraPlace, height_cm: float
) -> float:
    """Return how wide the side of an object of a height is seen at an outline's middle, in px."""
    middle = outline.mean(axis=0)
    below = surface.pixels(camera.below(surface.locate([middle]), height_cm))[0]
    return float(np.hypot(*(below - middle)))


def sees_rim(
    outline: np.ndarray, frame: np.ndarray, surface: Surface, camera: CameraPlace, height_cm: float
) -> bool:
    """
    Return whether there is a rim where the top of an object of a height has one.

    Then its near outline is that of a side: shade has no rim at just that height.

    :param outline: Its silhouette on the picture, shape (n, 2), in px.
    :param frame: The picture, shape (h, w, 3), uint8, BGR.
    :param surface: Maps the frame's pixels to the work surface.
    :raises HorizonError: If a part of it lies on the horizon or beyond it.
    """
    rayed = RayedSilhouette(surface.locate(outline), camera.foot_cm)
    rims = _steps(rayed.near_rim, outline, frame, surface, camera, [height_cm])
    return rims.get(height_cm, 0.0) >= _RIM


def _steps(
    edge_of: Callable[[float], np.ndarray], outline: np.ndarray, frame: np.ndarray,
    surface: Surface, camera: CameraPlace, heights_cm: Sequence[float],
) -> Dict[float, float]:
    """
    Return the step at an edge of an object of each height, in grey levels, where one can be seen.

    :param edge_of: RayedSilhouette.near_rim, or another of its edges.
    """
    shares = np.outer(heights_cm, np.add(1.0, _BESIDE)) / camera.height_cm
    rims = [edge_of(share) for share in shares.ravel()]
    # To ask the surface once is faster.
    ends = np.cumsum([3 * rim.shape[1] for rim in rims])
    pixels = surface.pixels(np.concatenate([rim.reshape(-1, 2) for rim in rims]))
    parts = [part.reshape(3, -1, 2) for part in np.split(pixels, ends[:-1])]
    around = np.concatenate([outline, *(at for _, at, _ in parts)])
    low = np.maximum(np.floor(np.nanmin(around, axis=0)).astype(int) - _MARGIN_PX, 0)
    high = np.ceil(np.nanmax(around, axis=0)).astype(int) + _MARGIN_PX + 1
    seen = cv2.GaussianBlur(
        frame[low[1]:high[1], low[0]:high[0]], (0, 0), _BLUR_PX).astype(np.float32)
    steps = [_step(part - low, seen) for part in parts]
    by_height = zip(heights_cm, zip(*[iter(steps)] * len(_BESIDE)))
    return {height_cm: max(near) for height_cm, near in by_height if None not in near}


def _step(rim: np.ndarray, seen: np.ndarray) -> Optional[float]:
    """
    Return the step of the picture across a rim, in grey levels; None where it is not seen.

    :param rim: Shape (3, n, 2), as RayedSilhouette.near_rim, but in px.
    :param seen: The picture, float32.
    """
    near, at, far = rim
    outwards = far - near
    lengths = np.hypot(*outwards.T)
    is_apart = (np.hypot(*(at - near).T) > _APART_PX) & (
        (outwards * (far - at)).sum(axis=1) > _APART_PX * lengths)
    count = int(np.count_nonzero(is_apart))
    if count < max(_LEAST_SHARE * len(at), 2 * _PARTS):
        return None
    at, outwards = at[is_apart], outwards[is_apart] / lengths[is_apart, None]
    sides = np.stack([at + _HALF_STEP_PX * outwards, at - _HALF_STEP_PX * outwards])
    behind, before = cv2.remap(seen, sides.astype(np.float32), None, cv2.INTER_LINEAR)
    starts = np.arange(_PARTS) * count // _PARTS
    parts = np.add.reduceat(behind - before, starts) / np.diff([*starts, count])[:, None]
    return float(np.sort(np.abs(parts).max(axis=1))[_MAY_BE_LESS])
