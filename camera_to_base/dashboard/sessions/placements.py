# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The pictures of a board that were taken, flat and tilted, and the report of their fit."""

from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.calibration import (
    Calibration, held_tilt, HeldTilt, make_placement, missing_side, NINTHS, Placement,
    PrintedBoard, refuse_unlike, renumbered, report_lines, rough_surface, shares_of,
    tilt_suggestion, tilt_trouble, uncovered)
from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.parameters import checked_values, default_values
from camera_to_base.settings import camera_settings, CAMERA_SPECS
from camera_to_base.surface import Surface
import cv2
import numpy as np

# As in the command: a hand that holds a board still moves its corners by 1 to 2 px.
_STILL_PX, _STILL_WIDTH, _STILL_LOOKS = 2.0, 640, 3
# The board must be moved by so much before the next picture, in shares of the picture's width.
_MOVED = 0.008
WANTED = 4

# Of the panels of a report picture, in their order.
PANEL_NAMES: List[str] = ['fit', 'above', 'errors', 'raised']

_MM_PER_CM = 10.0


def placement_data(number: int, placement: Placement) -> Dict[str, Any]:
    """Describe a placement."""
    return {'number': number, 'corners': len(placement.numbers),
            'outline': np.round(placement.outline, 1).tolist(), 'doubts': placement.doubts}


def covered_data(placements: Sequence[Placement]) -> Dict[str, Any]:
    """Describe how much of the picture the placements cover."""
    shares = shares_of(placements) if placements else np.zeros((3, 3))
    return {'share': round(float(shares.mean()), 2), 'missing': uncovered(shares)}


def suggestion(placements: Sequence[Placement]) -> Optional[Dict[str, Any]]:
    """Suggest where the board is best laid next; None before the first placement."""
    if not placements:
        return None
    missing = uncovered(shares_of(placements))
    if not missing:
        return {'sentence': 'The whole picture is covered.', 'pixel': None}
    row, column = divmod(NINTHS.index(missing[0]), 3)
    height, width = placements[0].image.shape[:2]
    return {'sentence': f'Lay the board elsewhere, best {" or ".join(missing[:2])}, without '
                        'moving the camera; turn it a little.',
            'pixel': [(column + 0.5) * width / 3, (row + 0.5) * height / 3]}


class PlacementList:
    """Keeps the placements in the order in which they were taken."""

    def __init__(self) -> None:
        self._placements: List[Placement] = []

    def __len__(self) -> int:
        return len(self._placements)

    @property
    def all(self) -> List[Placement]:  # noqa: A003
        """All placements."""
        return list(self._placements)

    @property
    def images(self) -> List[np.ndarray]:
        """The picture of each, of shape (h, w, 3), uint8, BGR."""
        return [one.image for one in self._placements]

    def put_back(self, placements: Sequence[Placement]) -> None:
        """Take placements in place of the present ones."""
        self._placements = list(placements)

    @property
    def outlines(self) -> List[np.ndarray]:
        """The outline of each, of shape (n, 2), in px."""
        return [one.outline for one in self._placements]

    def maker(self, board: PrintedBoard, frames: List[np.ndarray]) -> Callable[[], Placement]:
        """
        Return a function that makes the next placement, which takes a while.

        The function raises a CameraToBaseError if the board is not found, or the placement does
        not fit those before. It may run in another thread.

        :param frames: Each of shape (h, w, 3), uint8, BGR.
        """
        before = list(self._placements)
        number = len(before)

        def make() -> Placement:
            image = np.median(frames, axis=0).astype(np.uint8)
            found = make_placement(
                board, image, f'placement {number + 1}', number, says_name=number > 0)
            refuse_unlike([*before, found])
            return found
        return make

    def add(self, placement: Placement) -> None:
        """Add a placement."""
        self._placements.append(placement)

    def remove(self, board: PrintedBoard, number: Any) -> None:
        """
        Remove a placement, counted from 1.

        :raises InvalidValueError: If there is none with the number.
        """
        if number not in range(1, 1 + len(self._placements)):
            raise InvalidValueError(f'there is no placement {number!r:.20}')
        del self._placements[number - 1]
        self._placements = [renumbered(board, one, index)
                            for index, one in enumerate(self._placements)]

    def clear(self) -> None:
        """Remove all placements."""
        self._placements = []

    def named(self, name: str) -> List[Placement]:
        """Return the placements with a name for the report."""
        return [one._replace(name=name) for one in self._placements]

    @property
    def data(self) -> List[Dict[str, Any]]:
        """The placements as JSON."""
        return [placement_data(number, one) for number, one in enumerate(self._placements, 1)]

    @property
    def covered(self) -> Dict[str, Any]:
        """How much of the picture they cover, as JSON."""
        return covered_data(self._placements)

    @property
    def suggestion(self) -> Optional[Dict[str, Any]]:
        """Where the board is best laid next, as JSON; None before the first placement."""
        return suggestion(self._placements)


class TiltedPicture(NamedTuple):
    """A picture of the board, and how it was held."""

    placement: Placement
    held: HeldTilt


class TiltedList:
    """Keeps the pictures of the tilted board, and tells when the next one can be taken."""

    def __init__(self) -> None:
        self.all: List[TiltedPicture] = []
        self._last: Optional[np.ndarray] = None
        self._refused: Optional[np.ndarray] = None
        self._still_count = 0

    def __len__(self) -> int:
        return len(self.all)

    @property
    def placements(self) -> List[Placement]:
        """The pictures, as placements."""
        return [one.placement for one in self.all]

    @property
    def images(self) -> List[np.ndarray]:
        """The picture of each, of shape (h, w, 3), uint8, BGR."""
        return [one.placement.image for one in self.all]

    @property
    def side(self) -> Optional[str]:
        """The side of the picture to raise the board at; None when there are enough."""
        return missing_side(self._held) if len(self) < WANTED else None

    @property
    def suggestion(self) -> str:
        """How to hold the board next; '' when there are enough."""
        said = tilt_suggestion(self._held, WANTED)
        return said and f'{said[:1].upper()}{said[1:]}. Keep it still: the picture is taken by ' \
                        'itself.'

    @property
    def data(self) -> List[Dict[str, Any]]:
        """The pictures as JSON."""
        return [{**placement_data(number, one.placement), 'side': one.held.side,
                 'degrees': round(one.held.degrees)} for number, one in enumerate(self.all, 1)]

    def see(self, corners: np.ndarray, width: int) -> bool:
        """
        Take the corners of the newest picture.

        :param corners: Shape (n, 2), in px; none if no board was found.
        :param width: Of the picture.
        :returns: Whether the board is still, and elsewhere than in the picture before.
        """
        last, self._last = self._last, corners if len(corners) else None
        taken = [one.placement.matched.pixels for one in self.all[-1:]]
        before = [*taken, *([] if self._refused is None else [self._refused])]
        is_still = (
            last is not None and self._last is not None
            and _moved_px(corners, last) <= _STILL_PX * width / _STILL_WIDTH
            and all(_moved_px(corners, one) > _MOVED * width for one in before))
        self._still_count = self._still_count + 1 if is_still else 0
        return self._still_count >= _STILL_LOOKS

    def maker(
        self, board: PrintedBoard, frames: Sequence[np.ndarray], flat: Sequence[Placement]
    ) -> Callable[[], TiltedPicture]:
        """
        Return a function that makes the next picture; it may run in another thread.

        The function raises a CameraToBaseError if the picture cannot be used.

        :param frames: Each of shape (h, w, 3), uint8, BGR.
        :param flat: The placements on the table.
        """
        before, self._refused, self._still_count = self.placements, self._last, 0

        def make() -> TiltedPicture:
            image = np.median(frames, axis=0).astype(np.uint8)
            found = tilted_picture(board, image, len(before), flat)
            refuse_unlike([*flat, *before, found.placement])
            trouble = tilt_trouble(found.held)
            if trouble:
                raise CalibrationError(trouble)
            return found
        return make

    def add(self, picture: TiltedPicture) -> None:
        """Add a picture."""
        self.all, self._refused = [*self.all, picture], None

    def put_back(self, pictures: Sequence[TiltedPicture]) -> None:
        """Take pictures in place of the present ones."""
        self.all, self._refused, self._still_count = list(pictures), None, 0

    @property
    def _held(self) -> List[HeldTilt]:
        return [one.held for one in self.all]


def tilted_picture(
    board: PrintedBoard, image: np.ndarray, number: int, flat: Sequence[Placement]
) -> TiltedPicture:
    """
    Find the board in a picture, and how it is held.

    :param image: Shape (h, w, 3), uint8, BGR.
    :param number: How many tilted pictures there are before.
    :param flat: The placements on the table.
    :raises CalibrationError: If the picture shows no such board.
    """
    # A number above 0: its points are in the board's own coordinates.
    placement = make_placement(
        board, image, f'tilted picture {number + 1}', len(flat) + number, says_name=False)
    surface = rough_surface([one.matched for one in flat], image.shape[1::-1])
    held = HeldTilt(30.0, 'left') if surface is None else held_tilt(placement.matched, surface)
    return TiltedPicture(placement, held)


def _moved_px(corners: np.ndarray, others: np.ndarray) -> float:
    """Return how far corners are from the nearest ones of another look, on average."""
    offsets = corners[:, None] - others[None]
    return float(np.linalg.norm(offsets, axis=2).min(axis=1).mean())


def found_again(
    board: PrintedBoard, images: Sequence[np.ndarray], tilted_count: int
) -> Tuple[List[Placement], List[TiltedPicture]]:
    """
    Make the placements of pictures that were kept, and the tilted pictures, which are the last.

    :param images: Each of shape (h, w, 3), uint8, BGR.
    :raises CalibrationError: If one shows no such board.
    """
    count = len(images) - tilted_count
    flat = [make_placement(board, image, f'placement {number + 1}', number)
            for number, image in enumerate(images[:count])]
    return flat, [tilted_picture(board, image, number, flat)
                  for number, image in enumerate(images[count:])]


def report_data(calibration: Calibration, placement_count: int) -> Dict[str, Any]:
    """Describe a fit; its pictures are named as the server serves them."""
    report = calibration.report
    return {
        'held_out_mm': report['leave_one_out_rms_mm'], 'rms_mm': report['rms_mm'],
        'largest_mm': report['max_mm'], 'points': report['points'],
        'placements': placement_count, 'covered': report['coverage'],
        'lines': [line for line in report_lines(report) if not line.startswith('warning: ')],
        'warnings': list(report['warnings']), 'error_map_mm': report['error_map_mm'],
        'pictures': [{'title': panel.title, 'url': f'/api/report/{name}.png?{report["date"]}'}
                     for name, panel in zip(PANEL_NAMES, calibration.panels)],
        'text_url': f'/api/report/board.txt?{report["date"]}'}


def report_part(calibration: Optional[Calibration], name: str) -> bytes:
    """
    Return a part of the report: a picture of PANEL_NAMES, 'fit.png', or 'board.txt'.

    :raises InvalidValueError: If there is none.
    """
    stem, _, ending = name.partition('.')
    if calibration is not None and name == 'board.txt':
        return '\n'.join([*report_lines(calibration.report), '']).encode()
    if calibration is None or stem not in PANEL_NAMES or ending != 'png':
        raise InvalidValueError(f'there is no report {name:.40}')
    picture = calibration.panels[PANEL_NAMES.index(stem)].picture
    return cv2.imencode('.png', picture)[1].tobytes()


def placement_errors(calibration: Calibration, flat: Sequence[Placement]) -> List[float]:
    """
    Return how well the corners of each placement on the table fit its printed board.

    The calibrated surface tells where the corners lie; the board is laid over them as well as
    it can be, and what is left is the error.

    :param flat: The placements that were fitted.
    :returns: Of each, the rms in mm.
    """
    settings = camera_settings(checked_values(
        CAMERA_SPECS, {**default_values(CAMERA_SPECS), **calibration.values}))
    return [round(_MM_PER_CM * shape_error_cm(settings.surface, one), 3) for one in flat]


def tilted_errors(calibration: Calibration) -> List[float]:
    """Return how well each tilted picture fits, in px rms; none without tilted pictures."""
    return [one['rms_px'] for one in calibration.report.get('pictures', ()) if one['is_tilted']]


def shape_error_cm(surface: Surface, placement: Placement) -> float:
    """Return the rms distance of a placement's corners from the board that fits them best."""
    seen = surface.locate(placement.matched.pixels)
    printed = np.asarray(placement.matched.points, float)
    seen, printed = seen - seen.mean(axis=0), printed - printed.mean(axis=0)
    left, _, right = np.linalg.svd(printed.T @ seen)
    return float(np.sqrt(np.mean(np.sum((printed @ left @ right - seen) ** 2, axis=1))))
