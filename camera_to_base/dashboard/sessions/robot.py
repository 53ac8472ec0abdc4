# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The base frame from objects that the camera sees and the robot touches."""

from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence

from camera_to_base.calibration import (
    BASE, Calibration, part_values, read_typed_position, TouchedPair)
from camera_to_base.checks import finite_number
from camera_to_base.dashboard.sessions.kept import History
from camera_to_base.dashboard.sessions.pairs import (
    fit_data, FollowedObject, marker_place, measured_with, MeasuredWith, Pair, PairBook, Point,
    suggested, suggestion_data, surface_values)
from camera_to_base.dashboard.sessions.touch import OpenPair, ToolPlace
from camera_to_base.dashboard.sessions.values import CellChanges, CellValues
from camera_to_base.errors import CameraToBaseError, InvalidValueError

# With these the base frame is determined, and a bad pair can be told.
WANTED = 5

_LARGEST_CM = 1e5


def hint_at_rest(reason: Optional[str]) -> str:
    """
    Say what to do before pairs are measured.

    :param reason: Why that is not possible; None if it is.
    """
    return reason or 'Start, and put an object down.'


def hint_for_open(pair: OpenPair) -> str:
    """Say what to do with the object of a pair."""
    if pair.place is None:
        return 'The object is measured: leave it alone.'
    return 'Touch its middle with the robot, and type x and y as its display shows them.'


def hint_for_pairs(count: int, next_number: int, is_accepted: bool) -> str:
    """
    Say what to do between two pairs.

    :param count: Number of pairs that are measured.
    """
    if is_accepted:
        return 'Save the calibration.'
    if count < WANTED:
        return (f'{count} of {WANTED} pairs are there: put an object down for pair '
                f'{next_number}, and click it.')
    return 'Accept the fit, or measure further pairs.'


class RobotSession:
    """
    Guides from one pair to the next, and fits the base frame.

    :param values: The cell's parameters.
    :param on_change: Called when the state has changed.
    """

    def __init__(self, values: CellValues, on_change: Callable[[], None]) -> None:
        self._values, self._on_change = values, on_change
        self._is_on = False
        self._background: Any = None
        self._pairs = PairBook()
        self._again: Optional[int] = None
        self._open: Optional[OpenPair] = None
        self._newest: List[Point] = []
        self._error: Optional[str] = None
        self._accepted: Optional[Dict[str, Any]] = None
        self._base_z = 'up'
        self.accepted_calibration: Optional[Calibration] = None
        self.tool = ToolPlace()
        self._history = History()

    @property
    def kept(self) -> Dict[str, Any]:
        """What a new start of the dashboard needs, as JSON."""
        return {'pairs': self._pairs.kept, 'is_on': self._is_on, 'base_z': self._base_z}

    def restore(self, kept: Mapping[str, Any]) -> None:
        """
        Go on where the dashboard has ended.

        :raises CameraToBaseError: If that is not possible.
        """
        self._pairs.restore(kept['pairs'])
        self._is_on = bool(kept['is_on'])
        self._base_z = 'down' if kept['base_z'] == 'down' else 'up'

    @property
    def actions(self) -> Dict[str, Callable[[Mapping[str, Any]], Any]]:
        """What a page can ask for, by name."""
        return {'start': self.start, 'see': self.see, 'marker': self.marker, 'touch': self.touch,
                'from_topic': self.from_topic, 'again': self.again, 'remove': self.remove,
                'base_z': self.set_base_z, 'accept': lambda body: self.acceptance(),
                'undo': self.undo, 'cancel': self.cancel}

    @property
    def wants_objects(self) -> bool:
        """Whether it measures pairs."""
        return self._is_on

    @property
    def state(self) -> Dict[str, Any]:
        """The state as JSON."""
        return {
            'step': 'measuring' if self._is_on else 'off', 'hint': self._hint(),
            'needs': self._values.needs_surface, 'suggestion': self._suggestion_data(),
            'open': self._open and self._open.data(self._values.pixel_of),
            'markers': sorted(self._values.markers),
            'pairs': self._pairs.data(self._now(), self._values.pixel_of),
            'fit': self._pairs.fit and fit_data(self._pairs.fit), 'base_z': self._base_z,
            'tool': self.tool.data, 'error': self._error, 'accepted': self._accepted,
            'undo': self._history.sentence}

    def start(self, body: Mapping[str, Any]) -> None:
        """
        Measure pairs from now on; those of before are kept.

        :raises InvalidValueError: If that is not possible now.
        """
        reason = self._values.needs_surface
        if reason:
            raise InvalidValueError(reason)
        self._is_on, self._error = True, None
        self._on_change()

    def cancel(self, body: Mapping[str, Any]) -> None:
        """End, and drop the pairs."""
        self._remember('stop')
        self._is_on, self._accepted = False, None
        self._pairs.clear()
        self._close()
        self._on_change()

    def see(self, body: Mapping[str, Any]) -> None:
        """
        Follow the object at a click.

        :param body: {'u', 'v'}, in px.
        :raises CameraToBaseError: If that is not possible, or the pixel shows no surface.
        """
        self.start({})
        pixel = _point(body, 'u', 'v')
        self._close()
        point, = self._values.settings.surface.locate([pixel]).tolist()
        self._open = OpenPair(self._number, tuple(point), self._now())
        self._on_change()

    def marker(self, body: Mapping[str, Any]) -> None:
        """
        Take a marker in place of an object: it is known where it lies.

        :param body: {'number'}, the marker's.
        :raises InvalidValueError: If the camera node does not know it.
        """
        self.start({})
        place = marker_place(self._values, body.get('number'))
        self._close()
        self._open = OpenPair.of_marker(
            self._number, body['number'], place, self._now())
        self._on_change()

    def see_objects(self, points: Sequence[Point]) -> None:
        """Take all objects of the next frame, in cm, in the camera frame."""
        self._newest = list(points)
        try:
            is_news = self._open is not None and self._open.see(points)
        except CameraToBaseError as error:
            self._open, self._error, is_news = None, str(error), True
        if is_news:
            self._on_change()

    def object_number(self, body: Mapping[str, Any]) -> int:
        """
        Return which object is meant, counted from 1, as they are published.

        :param body: {'x', 'y'} in cm, in the camera frame; the open pair's object without.
        :raises InvalidValueError: If there is none.
        """
        followed = FollowedObject(_point(body)) if 'x' in body else self._open
        nearest = followed and followed.nearest(self._newest)
        if nearest is None:
            raise InvalidValueError('click an object in the picture first')
        return 1 + self._newest.index(nearest)

    def touch(self, body: Mapping[str, Any]) -> None:
        """
        Complete the pair.

        :param body: {'text': as typed}, or {'x', 'y'} in cm, in the base frame.
        :raises InvalidValueError: If there is no object yet, or the text is no position.
        """
        self._refuse_unmeasured()
        if 'text' in body:
            base_point = read_typed_position(str(body['text']))
        else:
            base_point = _point(body)
        self._add(base_point)

    def from_topic(self, body: Mapping[str, Any]) -> None:
        """
        Complete the pair with the place of the robot's tool.

        :param body: {'topic': its name}; the one of before if it is left out.
        :raises CameraToBaseError: If it does not stand still, or is not known yet.
        """
        if self.tool.listen(body.get('topic')):
            self._on_change()
        self._refuse_unmeasured()
        self._add(self.tool.place())

    def again(self, body: Mapping[str, Any]) -> None:
        """
        Measure a pair again with the next object.

        :param body: {'number'}.
        :raises InvalidValueError: If there is none.
        """
        self._again = self._pairs.numbered(body.get('number')).number
        self._close()
        self._on_change()

    def remove(self, body: Mapping[str, Any]) -> None:
        """
        Remove a pair.

        :param body: {'number'}.
        :raises InvalidValueError: If there is none.
        """
        pair = self._pairs.numbered(body.get('number'))
        self._remember(f'pair {pair.number} removed')
        self._pairs.remove(pair)
        self._again = None
        self.check_again()

    def undo(self, body: Mapping[str, Any]) -> None:
        """
        Bring back what was removed last.

        :raises CameraToBaseError: If nothing was.
        """
        pairs, self._is_on = self._history.pop()
        self._pairs.put_back(pairs)
        self._again = None
        self._close()
        self.check_again()

    def set_base_z(self, body: Mapping[str, Any]) -> None:
        """
        Say where the base frame's z points at the table.

        :param body: {'base_z': 'up' or 'down'}.
        :raises InvalidValueError: If it is neither.
        """
        if body.get('base_z') not in ('up', 'down'):
            raise InvalidValueError(f'base_z must be up or down, got {body.get("base_z")!r:.40}')
        self._base_z = body['base_z']
        self.check_again()

    def see_background(self, mark: Any) -> None:
        """Take what changes with each background."""
        if self._background is None:
            # It is not new: it has only not been told before.
            self._pairs.tell_background(mark)
            if self._open is not None:
                self._open.tell_background(mark)
        if mark != self._background:
            self._background = mark
            self.check_again()

    def check_again(self) -> None:
        """Fit again where pairs, or what makes them valid, have changed."""
        if self._pairs.fit_again(self._now(), surface_values(self._values), self._base_z):
            self._accepted = None
        self._on_change()

    def acceptance(self) -> CellChanges:
        """
        Return what is to be set for the running nodes to use the fit.

        :raises InvalidValueError: If there is none that can be used.
        """
        calibration = self._pairs.fit and self._pairs.fit.calibration
        if calibration is None:
            raise InvalidValueError(self._pairs.fit and self._pairs.fit.error
                                    or 'measure three pairs or more first')
        if self._values.transform is None:
            raise InvalidValueError('robot_base_publisher does not run: start it')
        return self._values.with_part(part_values(calibration), BASE)

    def set_accepted(self, changes: CellChanges) -> None:
        """Remember that the nodes use the fit."""
        self.accepted_calibration = self._pairs.fit and self._pairs.fit.calibration
        self._accepted = {'sentence': 'The running transform node uses the new base frame. Save '
                                      'it, so that it is there after the next start.'}
        self._on_change()

    def _now(self) -> MeasuredWith:
        return measured_with(self._values, self._background)

    @property
    def _number(self) -> int:
        return self._again or self._pairs.next_number

    def _add(self, base_point: Point) -> None:
        number, place = self._open.number, self._open.place
        suggestion = suggested(self._values, number)
        if self._open.marker is not None:
            suggestion = suggestion._replace(name=f'marker {self._open.marker}')
        if self._again is not None:
            self._remember(f'pair {number} measured again')
        touched = TouchedPair(suggestion, (place.x, place.y), base_point)
        self._pairs.put(Pair(number, touched, self._open.measured_with))
        self._again = None
        self._close()
        self.check_again()

    def _remember(self, sentence: str) -> None:
        if self._pairs:
            self._history.push(sentence, (self._pairs.all, self._is_on))

    def _close(self) -> None:
        self._open = self._error = None

    def _refuse_unmeasured(self) -> None:
        if self._open is None or self._open.place is None:
            raise InvalidValueError('click the object in the picture first, and wait until it is '
                                    'measured')

    def _suggestion_data(self) -> Optional[Dict[str, Any]]:
        if not self._is_on or self._open is not None or self._values.needs_surface:
            return None
        return suggestion_data(suggested(self._values, self._number))

    def _hint(self) -> str:
        if not self._is_on:
            return hint_at_rest(self._values.needs_surface)
        if self._open is not None:
            return hint_for_open(self._open)
        return hint_for_pairs(len(self._pairs), self._number, bool(self._accepted))


def _point(body: Mapping[str, Any], *names: str) -> Point:
    return tuple(finite_number(name, body.get(name), -_LARGEST_CM, _LARGEST_CM)
                 for name in names or ('x', 'y'))
