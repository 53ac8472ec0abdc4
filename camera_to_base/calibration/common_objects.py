# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Finds which objects two cameras both see, by the distances between them."""

from itertools import combinations, permutations
from typing import Iterator, List, NamedTuple, Sequence, Tuple

from camera_to_base.calibration.base import LARGEST_SPREAD_CM, MOST_WITHOUT
from camera_to_base.errors import CalibrationError
import numpy as np

# Where a flat object is for two calibrated cameras differs by less.
_SAME_CM = 0.4
# Objects that lie nearer to each other give no direction, and may be mixed up.
_APART_CM = 3.0
# So many must fit for the first time: three may do so by chance.
FEWEST_SHARED = 4
# The largest are looked at; more take minutes to try.
_MOST = 20

_Point = Tuple[float, float]
_Pair = Tuple[int, int]


class SharedPlace(NamedTuple):
    """
    Where an object is for both cameras.

    :param camera_point: x and y, in cm, in the camera frame of the one.
    :param base_point: x and y, in cm, in the base frame, by the other one.
    """

    camera_point: _Point
    base_point: _Point


class _Move(NamedTuple):
    """
    Takes points of the plane, as complex numbers, to others: turned and shifted.

    :param is_mirrored: Whether the planes are seen from different sides.
    """

    turn: complex
    shift: complex
    is_mirrored: bool

    def of(self, points: np.ndarray) -> np.ndarray:
        """Move points."""
        return self.turn * (points.conj() if self.is_mirrored else points) + self.shift


def resting_places(frames: Sequence[Sequence[_Point]]) -> List[_Point]:
    """
    Take the means of the positions of objects at rest.

    :param frames: For each frame the positions of all objects on it, x and y, in cm.
    :returns: The largest first.
    :raises CalibrationError: If an object moves, or there is none.
    """
    seen = [_complex(points) for points in frames]
    fullest = max(seen, key=len)[:_MOST]
    places = []
    for point in fullest:
        there = [points[np.argmin(abs(points - point))] for points in seen if len(points)]
        near = np.array([one for one in there if abs(one - point) < _APART_CM / 2])
        spread = float(np.sqrt(np.mean(abs(near - near.mean()) ** 2)))
        if spread > LARGEST_SPREAD_CM:
            raise CalibrationError(
                f'an object at ({point.real:.1f}, {point.imag:.1f}) cm has moved: its positions '
                f'spread by {10 * spread:.1f} mm, allowed are {10 * LARGEST_SPREAD_CM:g} mm: '
                'leave all alone while they are measured')
        if len(near) >= len(frames) - MOST_WITHOUT:
            places.append(_point(near.mean()))
    if not places:
        raise CalibrationError('no object lies still in the picture: put flat objects into it, '
                               'and take your hand and the robot out of it')
    return places


def shared_places(
    camera_points: Sequence[_Point], base_points: Sequence[_Point], is_mirrored: bool,
    known: Sequence[SharedPlace] = (),
) -> List[SharedPlace]:
    """
    Find the objects that both cameras see.

    :param camera_points: What the one sees, in cm, in its camera frame.
    :param base_points: What the other one sees, in cm, in the base frame.
    :param is_mirrored: Whether z of the two frames points to different sides of the table.
    :param known: Places of before, which still hold; those that are there still are left out.
    :raises CalibrationError: If too few fit, or they fit in several ways.
    """
    here, there = _complex(camera_points), _complex(base_points)
    if known:
        before = _complex([place.camera_point for place in known])
        there_before = _complex([place.base_point for place in known])
        pairs = [pair for pair in _matching(
            _fitted(before, there_before, is_mirrored), here, there)
                 if abs(before - here[pair[0]]).min() > _APART_CM]
    else:
        pairs = _best_match(here, there, is_mirrored)
    return [SharedPlace(camera_points[i], base_points[j]) for i, j in pairs]


def _best_match(here: np.ndarray, there: np.ndarray, is_mirrored: bool) -> List[_Pair]:
    found = {frozenset(_matching(move, here, there))
             for move in _possible_moves(here, there, is_mirrored)}
    most = max(map(len, found), default=0)
    best = [pairs for pairs in found if len(pairs) == most]
    if most < FEWEST_SHARED:
        raise CalibrationError(
            f'{most} objects of the {len(here)} that this camera sees, and of the {len(there)} '
            f'that the other one sees, have the same distances; needed are {FEWEST_SHARED}: lay '
            'more flat objects where both see them')
    if len(best) > 1:
        raise CalibrationError(
            'the objects lie so evenly that they fit in several ways: move one of them, or take '
            'it away')
    return sorted(best[0])


def _possible_moves(
    here: np.ndarray, there: np.ndarray, is_mirrored: bool
) -> Iterator[_Move]:
    """Give the moves that take two objects to two others as far apart."""
    for i, j in combinations(range(len(here)), 2):
        apart = abs(here[i] - here[j])
        if apart < _APART_CM:
            continue
        for k, m in permutations(range(len(there)), 2):
            if abs(abs(there[k] - there[m]) - apart) < _SAME_CM:
                yield _fitted(here[[i, j]], there[[k, m]], is_mirrored)


def _fitted(here: np.ndarray, there: np.ndarray, is_mirrored: bool) -> _Move:
    """Fit a move by least squares."""
    from_here = here.conj() if is_mirrored else here
    middle, to_middle = from_here.mean(), there.mean()
    turn = np.vdot(from_here - middle, there - to_middle)
    turn /= max(abs(turn), 1e-12)
    return _Move(turn, to_middle - turn * middle, is_mirrored)


def _matching(move: _Move, here: np.ndarray, there: np.ndarray) -> List[_Pair]:
    """List which objects come to lie on each other."""
    if not (len(here) and len(there)):
        return []
    apart = abs(move.of(here)[:, None] - there)
    return [(i, j) for i, j in enumerate(apart.argmin(axis=1).tolist())
            if apart[i, j] < _SAME_CM and apart[:, j].argmin() == i]


def _complex(points: Sequence[_Point]) -> np.ndarray:
    flat = np.array(points, float).reshape(-1, 2)
    return flat[:, 0] + 1j * flat[:, 1]


def _point(number: complex) -> _Point:
    return float(number.real), float(number.imag)
