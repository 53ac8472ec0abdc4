# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under

"""The proof of a calibration: published positions beside true ones that nothing was fitted to."""

import json
import math
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.calibration import BASE, FRAMES, measured_place, read_typed_position
from camera_to_base.checks import finite_number
from camera_to_base.dashboard.sessions.kept import History
from camera_to_base.dashboard.sessions.pairs import FollowedObject, Point, point_data
from camera_to_base.dashboard.sessions.touch import ToolPlace
from camera_to_base.dashboard.sessions.values import CellValues
from camera_to_base.errors import CalibrationError, CameraToBaseError, InvalidValueError

# A 95 % ellipse misses one place in twenty.
_MM_PER_CM = 10.0
_LARGEST_CM = 1e5
_MOST_PROOFS = 100
# What a position in the base frame depends on.
_CALIBRATION = ('surface.', 'object_height', 'rotation_deg', 'displacement_cm')
_OUTDATED = 'it was measured with another calibration: it does not count any more'

Ellipse = Dict[str, Any]


class Proof(NamedTuple):
    """
    A published position beside the true one.

    :param number: 1 and up; it stays when others are removed.
    :param camera: Where the object lies in the camera frame, in cm.
    :param seen: The published position in the base frame, in cm: the mean of its frames.
    :param true: The true one, in cm.
    :param ellipse: The published 95 % ellipse as JSON; None where none was published.
    :param calibration: What the position depends on.
    """

    number: int
    camera: Point
    seen: Point
    true: Point
    ellipse: Optional[Ellipse]
    calibration: Mapping[str, Any]

    @property
    def error_mm(self) -> Tuple[float, float]:
        """How far the published position is from the true one: x and y, in mm."""
        return (_MM_PER_CM * (self.seen[0] - self.true[0]),
                _MM_PER_CM * (self.seen[1] - self.true[1]))

    @property
    def is_within(self) -> Optional[bool]:
        """Whether the true position lies in the ellipse; None if there is none."""
        return None if self.ellipse is None else share_of_ellipse(
            self.error_mm, self.ellipse) <= 1.0

    def data(self, now: Mapping[str, Any]) -> Dict[str, Any]:
        """Describe it as JSON; `now` is what positions depend on now."""
        x, y = self.error_mm
        return {'number': self.number, 'camera': point_data(self.camera),
                'seen': point_data(self.seen), 'true': point_data(self.true),
                'error_mm': {'x': round(x, 2), 'y': round(y, 2)},
                'distance_mm': round(math.hypot(x, y), 2), 'within': self.is_within,
                'ellipse': self.ellipse,
                'invalid_because': None if self.calibration == now else _OUTDATED}


def share_of_ellipse(error_mm: Tuple[float, float], ellipse: Ellipse) -> float:
    """Return how far out an error is: 0 in the middle of the ellipse, 1 on its line."""
    angle = math.radians(ellipse['angle_deg'])
    along = error_mm[0] * math.cos(angle) + error_mm[1] * math.sin(angle)
    across = error_mm[1] * math.cos(angle) - error_mm[0] * math.sin(angle)
    return math.hypot(along / max(ellipse['major_mm'], 1e-9),
                      across / max(ellipse['minor_mm'], 1e-9))


class OpenProof:
    """
    Follows an object until its published position is known.

    :param number: The proof's.
    :param point: Where the object is looked for, in cm, in the camera frame.
    """

    def __init__(self, number: int, point: Point) -> None:
        self.number = number
        self._object = FollowedObject(point)
        self._base: List[List[Point]] = []
        self.ellipse: Optional[Ellipse] = None
        self.seen: Optional[Point] = None

    @property
    def point(self) -> Point:
        """Where it was seen last, in cm, in the camera frame."""
        return self._object.point

    def see(self, objects: List[Dict[str, Any]]) -> None:
        """
        Take the published objects of the next frame.

        :raises CalibrationError: If it was the last frame, and there is no position.
        """
        by_place = {(one['camera']['x'], one['camera']['y']): one for one in objects}
        nearest = self._object.nearest(list(by_place))
        self._object.see(list(by_place))
        found = by_place.get(nearest)
        base = found and found['base']
        self._base.append([(base['x'], base['y'])] if base else [])
        if base and found['ellipse']:
            self.ellipse = found['ellipse']
        if self._object.is_complete:
            self._end()

    def data(self, values: CellValues) -> Dict[str, Any]:
        """Describe it as JSON."""
        count = self._object.frame_count
        sentence = f'{count} of {FRAMES} frames' if self.seen is None else (
            'published at ({:.2f}, {:.2f}) cm in the base frame'.format(*self.seen))
        return {'number': self.number, 'frames': count, 'of': FRAMES, 'sentence': sentence,
                'seen': self.seen and point_data(self.seen), 'pixel': values.pixel_of(self.point)}

    def _end(self) -> None:
        if not any(self._base):
            raise CalibrationError('no position of this object is published in the base frame: '
                                   'is it farther away than reach_cm?')
        place = measured_place(self._base)
        self.seen = place.x, place.y


class ProveSession:
    """
    Compares what is published with where objects truly are.

    :param values: The cell's parameters.
    :param tool: Where the robot's tool is.
    :param on_change: Called when the state has changed.
    """

    def __init__(
        self, values: CellValues, tool: ToolPlace, on_change: Callable[[], None]
    ) -> None:
        self._values, self._tool, self._on_change = values, tool, on_change
        self._proofs: List[Proof] = []
        self._open: Optional[OpenProof] = None
        self._error: Optional[str] = None
        self._history = History()
        self._last_stamp: Optional[float] = None

    @property
    def kept(self) -> List[Any]:
        """The proofs as JSON, see :meth:`restore`."""
        return [list(proof) for proof in self._proofs]

    def restore(self, kept: Sequence[Any]) -> None:
        """
        Take the proofs of before the dashboard's restart.

        :raises InvalidValueError: If they are none.
        """
        try:
            self._proofs = [_proof(*one) for one in kept][-_MOST_PROOFS:]
        except (KeyError, TypeError, ValueError) as error:
            raise InvalidValueError('the proofs from before cannot be read') from error

    @property
    def wants_objects(self) -> bool:
        """Whether an object is followed, or touched."""
        return self._open is not None

    @property
    def needs(self) -> Optional[str]:
        """Say why nothing can be proved; None if it can."""
        if self._values.needs_surface:
            return self._values.needs_surface
        if self._values.transform is None:
            return 'robot_base_publisher does not run: start it.'
        if BASE not in (self._values.parts or ()):
            return 'The base frame is not calibrated: measure it with the robot first.'
        return None

    @property
    def state(self) -> Dict[str, Any]:
        """The state as JSON."""
        now = self._calibration
        proofs = [proof.data(now) for proof in self._proofs]
        return {'needs': self.needs, 'hint': self._hint(), 'error': self._error,
                'open': self._open and self._open.data(self._values), 'proofs': [
                    {**one, 'pixel': self._values.pixel_of(proof.camera)}
                    for one, proof in zip(proofs, self._proofs)],
                **verdict([one for one in proofs if one['invalid_because'] is None]),
                'tool': self._tool.data, 'undo': self._history.sentence}

    @property
    def actions(self) -> Dict[str, Callable[[Mapping[str, Any]], None]]:
        """What a page can ask for, by name."""
        return {'see': self.see, 'touch': self.touch, 'from_topic': self.from_topic,
                'remove': self.remove, 'undo': self.undo, 'cancel': self.cancel}

    def see(self, body: Mapping[str, Any]) -> None:
        """
        Follow the object at a click.

        :param body: {'u', 'v'}, in px.
        :raises CameraToBaseError: If that is not possible, or the pixel shows no surface.
        """
        if self.needs:
            raise InvalidValueError(self.needs)
        pixel = _numbers(body, 'u', 'v')
        point, = self._values.settings.surface.locate([pixel]).tolist()
        self._open, self._error = OpenProof(self._next_number, tuple(point)), None
        self._on_change()

    def see_published(self, stamp_s: Optional[float], objects: List[Dict[str, Any]]) -> None:
        """Take the published objects of the newest frame, as the page shows them."""
        if self._open is None or self._open.seen is not None or stamp_s in (
                None, self._last_stamp):
            return
        self._last_stamp = stamp_s
        try:
            self._open.see(objects)
        except CameraToBaseError as error:
            self._open, self._error = None, str(error)
        self._on_change()

    def touch(self, body: Mapping[str, Any]) -> None:
        """
        Compare with the true place.

        :param body: {'text': as typed}, or {'x', 'y'} in cm, in the base frame.
        :raises InvalidValueError: If there is no object yet, or the text is no position.
        """
        self._refuse_unmeasured()
        self._add(read_typed_position(str(body['text'])) if 'text' in body
                  else _numbers(body, 'x', 'y'))

    def from_topic(self, body: Mapping[str, Any]) -> None:
        """
        Compare with the place of the robot's tool.

        :param body: {'topic': its name}; the one of before if it is left out.
        :raises CameraToBaseError: If it does not stand still, or is not known yet.
        """
        if self._tool.listen(body.get('topic')):
            self._on_change()
        self._refuse_unmeasured()
        self._add(self._tool.place())

    def remove(self, body: Mapping[str, Any]) -> None:
        """
        Remove a proof.

        :param body: {'number'}.
        :raises InvalidValueError: If there is none.
        """
        number = body.get('number')
        if number not in [proof.number for proof in self._proofs]:
            raise InvalidValueError(f'there is no place {number!r:.20}')
        self._history.push(f'place {number} removed', self._proofs)
        self._proofs = [proof for proof in self._proofs if proof.number != number]
        self._on_change()

    def undo(self, body: Mapping[str, Any]) -> None:
        """
        Bring back what was removed last.

        :raises CameraToBaseError: If nothing was.
        """
        self._proofs = self._history.pop()
        self._on_change()

    def cancel(self, body: Mapping[str, Any]) -> None:
        """Follow no object any more; what was proved stays."""
        self._open = self._error = None
        self._on_change()

    @property
    def _next_number(self) -> int:
        return 1 + max((proof.number for proof in self._proofs), default=0)

    @property
    def _calibration(self) -> Dict[str, Any]:
        now = {name: value for name, value in self._values.given.items()
               if name.startswith(_CALIBRATION)}
        # As it is read back from the disk, which knows lists only.
        return json.loads(json.dumps(now, default=list))

    def _add(self, true: Point) -> None:
        proof = Proof(self._open.number, self._open.point, self._open.seen, true,
                      self._open.ellipse, self._calibration)
        self._proofs = [*self._proofs, proof][-_MOST_PROOFS:]
        self._open = self._error = None
        self._on_change()

    def _refuse_unmeasured(self) -> None:
        if self._open is None or self._open.seen is None:
            raise InvalidValueError('click an object in the picture first, and wait until it is '
                                    'measured')

    def _hint(self) -> str:
        if self.needs:
            return self.needs
        if self._open is None:
            return 'Put an object down where none was touched before, and click it.'
        if self._open.seen is None:
            return 'The object is measured: leave it alone.'
        return 'Touch its middle with the robot, or measure where it is, and type x and y.'


def verdict(proofs: List[Dict[str, Any]]) -> Dict[str, Any]:
    """
    Say what the proofs tell.

    :param proofs: Those that count, see :meth:`Proof.data`.
    :returns: `sentence`, and `good`: whether positions are as good as they say; None without any.
    """
    if not proofs:
        return {'sentence': None, 'good': None}
    away = [one['distance_mm'] for one in proofs]
    judged = [one['within'] for one in proofs if one['within'] is not None]
    sentence = (f'The position is {away[0]:.2f} mm off' if len(away) == 1 else
                f'{len(away)} places: {sum(away) / len(away):.2f} mm off in the mean, '
                f'{max(away):.2f} mm at most')
    if not judged:
        return {'sentence': f'{sentence}. No ellipse is published, so it is not known how much '
                            'is to be expected.', 'good': None}
    outside = judged.count(False)
    # By chance, one in twenty lies outside; of a few, at most one.
    good = outside <= len(judged) / 20 or outside == 1 and len(judged) >= 5
    counted = f'{len(judged) - outside} of {len(judged)} within the 95 % ellipse'
    cure = '' if good else (' Positions are worse than they say: touch once more to be sure, then '
                            'measure with the robot again.')
    return {'sentence': f'{sentence}; {counted}.{cure}', 'good': good}


def _proof(
    number: int, camera: Sequence[float], seen: Sequence[float], true: Sequence[float],
    ellipse: Optional[Ellipse], calibration: Mapping[str, Any],
) -> Proof:
    points = [_numbers({'x': x, 'y': y}, 'x', 'y') for x, y in (camera, seen, true)]
    if ellipse is not None:
        ellipse = {**ellipse, **{name: float(ellipse[name])
                                 for name in ('major_mm', 'minor_mm', 'angle_deg')}}
    return Proof(int(number), *points, ellipse, dict(calibration))


def _numbers(body: Mapping[str, Any], *names: str) -> Point:
    return tuple(finite_number(name, body.get(name), -_LARGEST_CM, _LARGEST_CM) for name in names)
