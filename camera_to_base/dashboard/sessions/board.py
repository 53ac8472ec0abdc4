# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The surface from a board that a person lays on the table, one placement after the other."""

import time
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

from camera_to_base.calibration import (
    calibrate_placements, Calibration, part_values, Placement, SURFACE)
from camera_to_base.dashboard.sessions.board_watch import BoardOptions, BoardWatch, PictureTaker
from camera_to_base.dashboard.sessions.kept import History
from camera_to_base.dashboard.sessions.placements import (
    found_again, placement_errors, PlacementList, report_data, tilted_errors, TiltedList,
    TiltedPicture, WANTED)
from camera_to_base.dashboard.sessions.values import CellChanges, CellValues, sentence_of, Worker
from camera_to_base.errors import InvalidValueError
from camera_to_base.sources import AUTO, kind_of, lasting_name
from camera_to_base.surface import LensModel
import numpy as np

_GOOD_PLACEMENTS = 4
_BUSY = 'the last step still goes on: wait for it'


class BoardSession:
    """
    Guides from one placement of the board to the next, and fits the surface.

    :param values: The cell's parameters.
    :param worker: Searches and fits.
    :param on_change: Called when the state has changed.
    :param on_picture: Called with each newest picture as JPEG, the found corners drawn into it.
    """

    def __init__(
        self, values: CellValues, worker: Worker, on_change: Callable[[], None],
        on_picture: Callable[[bytes], None] = lambda jpeg: None,
    ) -> None:
        self._values, self._worker, self._on_change = values, worker, on_change
        self._options = BoardOptions()
        self._watch = BoardWatch(worker, on_change, on_picture, self._see_look)
        self._is_on = False
        self._taker = PictureTaker(worker)
        self._busy: Optional[str] = None
        self._error: Optional[str] = None
        self._placements, self._tilted = PlacementList(), TiltedList()
        self._is_tilting = False
        self.calibration: Optional[Calibration] = None
        self._judged: Tuple[Any, Tuple[List[float], List[float]]] = None, ([], [])
        self._accepted: Optional[Dict[str, Any]] = None
        self._accepted_at = 0.0
        # The accepted surface whose background was taken, too.
        self._in_use: Any = None
        self.accepted_calibration: Optional[Calibration] = None
        self._history = History()
        self._reading: List[np.ndarray] = []
        self._tilted_before = 0
        self._lens: Optional[LensModel] = None

    @property
    def kept(self) -> Tuple[Dict[str, Any], List[np.ndarray]]:
        """What a new start of the dashboard needs, as JSON, and the placements' pictures."""
        return ({'options': self._options.data, 'is_on': self._is_on,
                 'tilted': self._tilted_before or len(self._tilted)},
                self._reading or [*self._placements.images, *self._tilted.images])

    def restore(self, kept: Mapping[str, Any], images: List[np.ndarray]) -> None:
        """
        Go on where the dashboard has ended.

        :raises CameraToBaseError: If that is not possible.
        """
        options = self._options.changed(kept['options'])
        self._options, self._is_on = options, bool(kept['is_on'])
        self._watch.start(options.board if self._is_on else None)
        if images:
            self._reading, self._tilted_before = images, int(kept.get('tilted', 0))
            self._begin('Reading the placements from before …')
            self._worker.run(
                lambda: found_again(options.board, images, self._tilted_before),
                self._take_again)

    @property
    def wants_frames(self) -> bool:
        """Whether it looks for a board."""
        return self._is_on

    @property
    def sees_board(self) -> bool:
        """Whether it looks for a board, and sees it now."""
        return self._is_on and self._watch.sees_board

    @property
    def new_surface(self) -> Any:
        """Another object for each surface that was accepted; None before."""
        return self._accepted

    @property
    def options(self) -> BoardOptions:
        """What is printed."""
        return self._options

    @property
    def state(self) -> Dict[str, Any]:
        """The state as JSON."""
        return {
            'step': 'off' if not self._is_on else 'fitted' if self.calibration else 'looking',
            'hint': self._hint(), 'options': self._options.data,
            'look': self._watch.data if self._values.camera else None,
            'placements': _with_errors(self._placements.data, 'error_mm', self._errors[0]),
            'covered': self._placements.covered,
            'suggestion': self._suggestion,
            'busy': self._busy, 'error': self._error,
            'report': self.calibration and report_data(self.calibration, len(self._placements)),
            'would_drop': self._values.dropped_by(SURFACE),
            'accepted': self._accepted and {**self._accepted, 'has_background': self._is_in_use},
            'undo': self._history.sentence, 'tilting': self._is_tilting,
            'tilted': _with_errors(self._tilted.data, 'error_px', self._errors[1]),
            'wanted': _GOOD_PLACEMENTS, 'wanted_tilted': WANTED,
            'tilt_side': self._tilted.side if self._is_tilting else None}

    def start(self, body: Mapping[str, Any]) -> None:
        """
        Look for a board from now on.

        :param body: Its options; another board drops the placements.
        :raises InvalidValueError: If one cannot be used.
        """
        options = self._options.changed(body)
        if options.board != self._options.board:
            self._remember('another board')
            self._forget()
        self._options, self._is_on, self._error = options, True, None
        self._watch.start(options.board)
        self._on_change()

    def cancel(self) -> None:
        """End, and drop the placements."""
        self._remember('stop')
        self._is_on, self._error = False, None
        self._watch.start(None)
        self._forget()
        self._on_change()

    def see_frame(self, image: np.ndarray) -> None:
        """
        Take the newest frame.

        :param image: Shape (h, w, 3), uint8, BGR.
        """
        if not self._is_on:
            return
        if self._taker.is_taking:
            self._taker.see(image)
        else:
            self._watch.see(image, self._placements.outlines)

    def see_lens(self, lens: Optional[LensModel]) -> None:
        """Take the lens that the driver knows; None where it knows none."""
        self._lens = lens
        self._on_change()

    def see_published(self, stamp_s: Optional[float]) -> None:
        """Take the time of a published frame: one after the new surface has its background."""
        if self._accepted and not self._is_in_use and (stamp_s or 0.0) > self._accepted_at:
            self._in_use = self._accepted
            self._on_change()

    def take(self) -> None:
        """
        Take the board's placement.

        :raises InvalidValueError: If that is not possible now.
        """
        _refuse_unless(self._is_on, 'start the search for a board first')
        _refuse_unless(not self._busy, _BUSY)
        self._begin('Taking the picture …')
        self._taker.start(self._make_placement)
        self._on_change()

    def tilt(self, body: Mapping[str, Any]) -> None:
        """
        Take pictures of the board held at a tilt from now on, or of the board on the table.

        :param body: {'on': whether it is held}.
        :raises InvalidValueError: If there is no placement on the table yet.
        """
        _refuse_unless(self._is_on and self._placements, 'take a placement on the table first')
        self._is_tilting, self._error = bool(body.get('on')), None
        self._on_change()

    def remove(self, body: Mapping[str, Any]) -> None:
        """
        Remove a placement.

        :param body: {'number': 1 and up, 'tilted': whether it is of those held at a tilt}.
        :raises InvalidValueError: If there is none.
        """
        _refuse_unless(not self._busy, _BUSY)
        before, number = self._former, body.get('number')
        if body.get('tilted'):
            numbered = dict(enumerate(self._tilted.all, 1))
            _refuse_unless(number in list(numbered), f'there is no tilted picture {number!r:.20}')
            self._tilted.put_back([one for key, one in numbered.items() if key != number])
            self._history.push(f'tilted picture {number} removed', before)
        else:
            self._placements.remove(self._options.board, number)
            self._history.push(f'placement {number} removed', before)
        self.calibration = self._accepted = None
        self._on_change()

    def undo(self) -> None:
        """
        Bring back what was removed last.

        :raises CameraToBaseError: If nothing was.
        """
        _refuse_unless(not self._busy, _BUSY)
        self._options, placements, tilted, self._is_on, self.calibration, self._accepted = (
            self._history.pop())
        self._placements.put_back(placements)
        self._tilted.put_back(tilted)
        self._error = None
        self._watch.start(self._options.board if self._is_on else None)
        self._on_change()

    def fit(self) -> None:
        """
        Fit the surface to the placements.

        :raises InvalidValueError: If that is not possible now.
        """
        _refuse_unless(self._placements, 'take a placement of the board first')
        _refuse_unless(not self._busy, _BUSY)
        self._begin('Fitting …')
        board = self._options.board
        placements = self._placements.named(f'camera {self._device() or "picture"}')
        tilted, self._is_tilting = self._tilted.placements, False
        lens = self._known_lens
        self._worker.run(
            lambda: calibrate_placements(board, placements, lens, tilted), self._take_fit)
        self._on_change()

    def acceptance(self) -> CellChanges:
        """
        Return what is to be set for the running nodes to use the fit.

        :raises InvalidValueError: If there is none.
        """
        _refuse_unless(self.calibration, 'fit the surface first')
        _refuse_unless(self._values.camera, 'camera_publisher does not run: start it')
        return self._values.with_part(
            {'calibration.device': self._device(), **part_values(self.calibration)}, SURFACE)

    def set_accepted(self, changes: CellChanges) -> None:
        """Remember that the nodes use the fit."""
        self.accepted_calibration, self._accepted_at = self.calibration, time.time()
        sentence = 'The running camera node uses the new surface.'
        if changes.dropped:
            sentence += (f' No longer valid: {", ".join(changes.dropped)}; it was made for the '
                         'former surface.')
        self._accepted = {'sentence': sentence, 'dropped': changes.dropped}
        self._on_change()

    @property
    def _is_in_use(self) -> bool:
        return self._accepted is not None and self._accepted is self._in_use

    @property
    def _errors(self) -> Tuple[List[float], List[float]]:
        """Of each placement in mm, and of each tilted picture in px; none before the fit."""
        if self.calibration is not self._judged[0]:
            self._judged = self.calibration, ([], []) if self.calibration is None else (
                placement_errors(self.calibration, self._placements.all),
                tilted_errors(self.calibration))
        return self._judged[1]

    @property
    def _known_lens(self) -> Optional[LensModel]:
        """The driver's, if it is of pictures as they come."""
        images = self._placements.images
        is_fitting = self._lens is not None and images and (
            images[0].shape[1::-1] == tuple(self._lens.image_size))
        return self._lens if is_fitting else None

    def _device(self) -> str:
        source = (self._values.camera or {}).get('source', AUTO.form)
        return '' if kind_of(source) == AUTO else lasting_name(source)

    def _hint(self) -> str:
        count = len(self._placements)
        if self._is_on and self._values.camera is None:
            return 'camera_publisher does not run: start it. What is measured is kept.'
        if not self._is_on:
            return 'Lay the printed board flat on the table, and start.'
        if self._is_tilting:
            return (f'{len(self._tilted)} of {WANTED} tilted pictures are taken. '
                    + self._tilted.suggestion)
        if self._is_in_use:
            return 'The surface is calibrated, its background is taken: see the next step above.'
        if self._accepted:
            return 'Take the board away, and take the background of the empty surface.'
        if self.calibration:
            return 'Look at the report. Accept it, or take further placements and fit again.'
        if count < _GOOD_PLACEMENTS and count:
            return (f'{count} of {_GOOD_PLACEMENTS} placements are taken. Lay the board elsewhere '
                    'without moving the camera, or fit now.')
        if count and self._known_lens is not None:
            return "The driver's camera_info tells the lens: fit the surface."
        if count and not self._tilted:
            return ('Hold the board at a tilt, for the lens and the height of the camera, or fit '
                    'the surface.')
        return 'Fit the surface.' if count else 'Take the first placement: it defines x and y.'

    def _make_placement(self, frames: Any) -> None:
        if isinstance(frames, Exception):
            self._take_placement(frames)
            return
        board = self._options.board
        maker = self._tilted.maker(board, frames, self._placements.all) if self._is_tilting \
            else self._placements.maker(board, frames)
        self._worker.run(maker, self._take_placement)

    def _take_placement(self, found: Any) -> None:
        self._end(found)
        if isinstance(found, (Placement, TiltedPicture)) and self._is_on:
            (self._placements if isinstance(found, Placement) else self._tilted).add(found)
            self._is_tilting &= len(self._tilted) < WANTED
            self.calibration = self._accepted = None
        self._on_change()

    def _take_fit(self, found: Any) -> None:
        self._end(found)
        if isinstance(found, Calibration) and self._placements:
            self.calibration, self._accepted = found, None
        self._on_change()

    @property
    def _suggestion(self) -> Optional[Dict[str, Any]]:
        # The hint says one thing; where it says `Fit the surface`, nothing else is suggested.
        is_enough = len(self._placements) >= _GOOD_PLACEMENTS
        if not self._is_on or self._is_tilting or self.calibration or is_enough:
            return None
        return self._placements.suggestion

    @property
    def _former(self) -> Any:
        return (self._options, self._placements.all, self._tilted.all, self._is_on,
                self.calibration, self._accepted)

    def _remember(self, sentence: str) -> None:
        if self._placements:
            self._history.push(sentence, self._former)

    def _take_again(self, found: Any) -> None:
        self._end(found)
        self._reading, self._tilted_before = [], 0
        if not isinstance(found, Exception):
            flat, tilted = found
            self._placements.put_back(flat)
            self._tilted.put_back(tilted)
        self._on_change()

    def _see_look(self, corners: np.ndarray, width: int) -> None:
        if self._is_tilting and not self._busy and self._tilted.see(corners, width):
            self.take()

    def _begin(self, sentence: str) -> None:
        self._busy, self._error = sentence, None

    def _end(self, found: Any) -> None:
        self._busy = None
        self._error = sentence_of(found) if isinstance(found, Exception) else None

    def _forget(self) -> None:
        self._placements.clear()
        self._tilted.put_back([])
        self._is_tilting = False
        self.calibration = self._accepted = self._busy = None
        self._taker.cancel()


def _with_errors(data: List[Dict[str, Any]], name: str, errors: List[float]) -> List[Dict]:
    return [{**one, name: error} for one, error in zip(
        data, [*errors, *[None] * (len(data) - len(errors))])]


def _refuse_unless(condition: Any, sentence: str) -> None:
    if not condition:
        raise InvalidValueError(sentence)
