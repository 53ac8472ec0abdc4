# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""How a board is held: its tilt against the table, and which tilt is missing."""

from typing import List, NamedTuple, Optional, Sequence

from camera_to_base.calibration.homography_fit import fit_homography
from camera_to_base.checks import ImageSize
from camera_to_base.errors import CameraToBaseError
from camera_to_base.surface import homogeneous, HomographySurface, MatchedPoints
from camera_to_base.uncertainty import likely_place
import cv2
import numpy as np

# The sides of the picture, clockwise.
SIDES = ('right', 'bottom', 'left', 'top')
# In this order opposite sides come first: from two pictures already, much is known.
_ORDER = ('left', 'right', 'top', 'bottom')
# Tilts that tell much of the lens, in degrees; a board that is tilted by more is seen badly.
LEAST_TILT_DEG, USUAL_TILT_DEG, MOST_TILT_DEG = 6.0, 30.0, 60.0


class HeldTilt(NamedTuple):
    """
    How a board is held above the table.

    :param degrees: Its tilt against the table, to about half of it: the lens is not known yet.
    :param side: The side of the picture that the raised edge lies to, one of SIDES.
    """

    degrees: float
    side: str


def rough_surface(
    flat: Sequence[MatchedPoints], image_size: ImageSize
) -> Optional[HomographySurface]:
    """Fit a surface to flat placements, to tell tilts by; None where they do not fit."""
    first, *further = flat
    try:
        return fit_homography(first, image_size, further).surface
    except CameraToBaseError:
        return None


def held_tilt(board: MatchedPoints, surface: HomographySurface) -> HeldTilt:
    """
    Tell how a board is held.

    A point above the table is seen on the table farther from the foot point than it is, by the
    same factor for all points of the same height.

    :param board: A picture of it, with points in the board's own coordinates.
    :param surface: The table as the flat placements give it.
    """
    seen = surface.locate(board.pixels)
    middle = board.points.mean(axis=0)
    offsets = board.points - middle
    homography, _ = cv2.findHomography(offsets, seen)
    if homography is None:
        return HeldTilt(0.0, _ORDER[0])
    # The homography's depth falls with the height above the table.
    rise = -homography[2, :2] / homography[2, 2]
    place = likely_place(surface.locate, surface.image_size)
    slope = float(np.linalg.norm(rise)) * place.height_cm
    step = rise / max(float(np.linalg.norm(rise)), 1e-12) * np.ptp(offsets, axis=0).max() / 4
    start, end = homogeneous(homography, np.array([[0.0, 0.0], step]))
    pixels = surface.pixels(np.array([start[:2] / start[2], end[:2] / end[2]]))
    return HeldTilt(float(np.degrees(np.arctan(slope))), _side(pixels[1] - pixels[0]))


def _side(direction: np.ndarray) -> str:
    quarter = np.arctan2(direction[1], direction[0]) / (np.pi / 2)
    return SIDES[int(np.rint(quarter)) % 4] if np.isfinite(quarter) else SIDES[0]


def missing_side(held: Sequence[HeldTilt]) -> str:
    """Return to which side of the picture the next raised edge should lie."""
    counts = [sum(one.side == side for one in held) for side in _ORDER]
    return _ORDER[int(np.argmin(counts))]


def tilt_suggestion(held: Sequence[HeldTilt], wanted: int) -> str:
    """
    Say which way to tilt the board next; '' when there are enough pictures.

    :param held: How it was held so far.
    :param wanted: Number of pictures.
    """
    if len(held) >= wanted:
        return ''
    return (f'hold the board a hand above the table, tilted by about {USUAL_TILT_DEG:.0f} '
            f'degrees, with the edge raised that the picture shows at the {missing_side(held)}')


def tilt_trouble(tilt: HeldTilt) -> str:
    """Say what is wrong with a tilt; '' for nothing."""
    if tilt.degrees < LEAST_TILT_DEG:
        return (f'the board is tilted by about {tilt.degrees:.0f} degrees only, which tells '
                f'little of the lens: tilt it by about {USUAL_TILT_DEG:.0f} degrees')
    if tilt.degrees > MOST_TILT_DEG:
        return (f'the board is tilted by about {tilt.degrees:.0f} degrees: tilt it by about '
                f'{USUAL_TILT_DEG:.0f} degrees')
    return ''


def all_to_one_side(held: Sequence[HeldTilt]) -> List[str]:
    """Return a warning if all boards are tilted to the same side."""
    if len(held) < 2 or len({one.side for one in held}) > 1:
        return []
    return [f'all tilted boards are raised at the {held[0].side} of the picture: raise another '
            'side in each, so that errors of the lens cancel']
