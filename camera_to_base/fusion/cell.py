# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""What several cameras see, from frame to frame: objects with heights, and what contradicts."""

from dataclasses import dataclass, replace
from typing import Dict, List, NamedTuple, Optional, Sequence, Set, Tuple

from camera_to_base.errors import Level, Reason
from camera_to_base.fusion.frames import CameraFrame, FrameHistory, HISTORY_S
from camera_to_base.fusion.matching import Group, is_plausible, match, Matches, Member
from camera_to_base.fusion.solver import KnownHeight, SeenOutline, Solution, solve
import numpy as np

# What rests is solved anew after this time.
_SOLVED_AGAIN_S = 1.0
# What rests and fits nothing is tried again after this time.
_TRIED_AGAIN_S = 0.4
# What no camera has seen for so long is forgotten: it may be another object that comes.
_FORGOTTEN_S = 1.0


class FusedObject(NamedTuple):
    """
    An object.

    :param solution: Its height and footprint.
    :param cameras: The numbers of the cameras that see it now.
    """

    solution: Solution
    cameras: Tuple[int, ...]


class NotFused(NamedTuple):
    """
    What is not published.

    :param point: Where its silhouette is, shape (2,), in cm.
    :param reason: Why.
    """

    point: np.ndarray
    reason: Reason


class FusedSighting(NamedTuple):
    """
    What the cameras see together.

    :param objects: The largest first.
    :param left_out: What is not published.
    :param reason: What is wrong, though objects may be published; None where all agree.
    """

    objects: List[FusedObject]
    left_out: List[NotFused]
    reason: Optional[Reason]


class FusionLimits(NamedTuple):
    """
    Limits of the fusion, see the node's parameters.

    :param highest_cm: No object is higher.
    :param stamp_tolerance_s: Frames whose stamps differ by less are of one moment.
    :param one_camera: The height of what one camera alone sees; None to leave it out.
    """

    highest_cm: float = 10.0
    stamp_tolerance_s: float = 0.02
    one_camera: Optional[KnownHeight] = None


@dataclass(frozen=True)
class _Remembered:
    """
    An object that was seen.

    :param solution: Of the time when it was solved.
    :param reaches: By camera, how its silhouette reached then.
    """

    solution: Solution
    reaches: Dict[int, np.ndarray]
    solved_at: float
    seen_at: float


class _Refused(NamedTuple):
    """A silhouette that others touch, but that fits none of them: of a camera, at a time."""

    camera: int
    reached: np.ndarray
    at: float


class FusedCell:
    """
    Fuses what cameras see, and remembers what rests.

    :param names: Of the cameras, for the reasons.
    """

    def __init__(self, names: Sequence[str], limits: FusionLimits = FusionLimits()) -> None:
        self.limits = limits
        self._names = tuple(names)
        self._known: List[_Remembered] = []
        self._refused: List[_Refused] = []
        self._history = [FrameHistory() for _ in names]

    def forget(self) -> None:
        """Forget all objects: a camera is at another place."""
        self._known, self._refused = [], []
        self._history = [FrameHistory() for _ in self._names]

    def fuse(
        self, frames: Sequence[Optional[CameraFrame]], now_s: float, untrusted: bool = False
    ) -> FusedSighting:
        """
        Fuse the last frame of each camera.

        :param frames: By camera; None for a camera that gives none.
        :param now_s: On any clock that is not set while the node runs.
        :param untrusted: Whether the stamps of different cameras cannot be compared.
        """
        for history, frame in zip(self._history, frames):
            if frame is not None:
                history.keep(frame)
        book = _Book(frames)
        objects = self._resting(book, now_s)
        self._still_refused(book, now_s)
        found = book.matched(self.limits.highest_cm)
        self._refused += [_Refused(camera, book.reach_of((camera, number)), now_s)
                          for camera, number in found.disagreeing]
        bumped = book.bumped
        for group in found.groups:
            if bumped & {camera for camera, _ in group.members}:
                book.leave_out(group.members[0], self._contradiction(book))
            else:
                objects += self._of_group(group, book, now_s, untrusted)
        self._alone(found, book, objects)
        self._known = [one for one in self._known if now_s - one.seen_at < _FORGOTTEN_S]
        objects.sort(key=lambda one: -one.solution.moments.area)
        return FusedSighting(objects, book.left_out, self._reason(frames, objects, book))

    def _resting(self, book: '_Book', now_s: float) -> List[FusedObject]:
        """Find what lies where it lay: its height is known, whoever sees it now."""
        found = [(one, self._members_at_rest(one, book)) for one in self._known]
        objects, self._known = [], []
        for one, members in found:
            if not members:
                # Hidden from all, it is kept for a while; what has moved is solved anew.
                if not any(book.touches(*seen) for seen in one.reaches.items()):
                    self._known.append(one)
                continue
            elsewhere = {camera: reached for camera, reached in one.reaches.items()
                         if camera not in members}
            changed = {camera for camera, reached in elsewhere.items()
                       if book.touches(camera, reached)}
            book.disagreeing |= changed
            book.agreeing |= set(members)
            book.only_one |= bool(elsewhere) and not changed
            one = replace(one, seen_at=now_s) if elsewhere else self._again(
                one, members, book, now_s)
            self._known.append(one)
            objects.append(FusedObject(one.solution, tuple(members)))
        return objects

    def _still_refused(self, book: '_Book', now_s: float) -> None:
        """Leave out what rests and has just been found to fit nothing."""
        self._refused = [one for one in self._refused if now_s - one.at < _TRIED_AGAIN_S]
        for one in self._refused:
            frame = book.frames[one.camera]
            number = None if frame is None else frame.at_rest(one.reached)
            member = one.camera, number
            if number is not None and member not in book.used | book.refused:
                book.refused.add(member)
                book.leave_out(member, self._contradiction(book))

    @staticmethod
    def _members_at_rest(one: '_Remembered', book: '_Book') -> Dict[int, int]:
        members = {}
        for camera, reached in one.reaches.items():
            frame = book.frames[camera]
            number = None if frame is None else frame.at_rest(reached)
            if number is not None and (camera, number) not in book.used:
                members[camera] = number
        book.used.update(members.items())
        return members

    def _again(
        self, one: '_Remembered', members: Dict[int, int], book: '_Book', now_s: float
    ) -> '_Remembered':
        """Solve what all its cameras see at rest once a second where light changes an outline."""
        if now_s - one.solved_at > _SOLVED_AGAIN_S and not all(
                book.frames[camera].is_as_before(number, one.reaches[camera])
                for camera, number in members.items()):
            solution = solve([book.outline(member) for member in members.items()])
            if is_plausible(solution, self.limits.highest_cm):
                reaches = {camera: book.reach_of((camera, number))
                           for camera, number in members.items()}
                return _Remembered(solution, reaches, now_s, now_s)
        return replace(one, seen_at=now_s)

    def _of_group(
        self, group: Group, book: '_Book', now_s: float, untrusted: bool
    ) -> List[FusedObject]:
        """Give an object that was not there, unless it moves between its pictures."""
        stamps = [book.frames[camera].stamp_s for camera, _ in group.members]
        apart = max(stamps) - min(stamps)
        since = min(stamps) - (HISTORY_S / 2 if untrusted else 0.0)
        if (untrusted or apart > self.limits.stamp_tolerance_s) and not all(
                self._history[camera].rested(book.reach_of((camera, number)), since)
                for camera, number in group.members):
            cause = 'the clocks of the cameras differ' if untrusted else (
                f'its pictures were taken {apart * 1000:.0f} ms apart, see stamp_tolerance')
            book.leave_out(group.members[0], Reason(
                'too_old', Level.WARN, f'it moves, and {cause}', is_passing=True))
            return []
        self._known.append(_Remembered(group.solution, {
            camera: book.reach_of((camera, number)) for camera, number in group.members},
            now_s, now_s))
        return [FusedObject(group.solution, tuple(camera for camera, _ in group.members))]

    def _alone(self, found: Matches, book: '_Book', objects: List[FusedObject]) -> None:
        for member in found.ambiguous:
            book.leave_out(member, Reason('no_partner', Level.WARN, (
                'it fits two silhouettes of the other camera: move the objects apart'),
                is_passing=True))
        for member in found.disagreeing:
            book.leave_out(member, self._contradiction(book))
        for member in found.alone:
            camera = member[0]
            if book.touches_used(member):
                # Another camera says that an object at rest is there.
                book.leave_out(member, self._contradiction(book))
            elif self.limits.one_camera is None:
                book.only_one = True
                book.leave_out(member, Reason('one_camera', Level.WARN, (
                    f'only {self._names[camera]} sees it, and its height is not known: show it '
                    'to both cameras, or set one_camera_height_cm'), is_passing=True))
            else:
                book.only_one = True
                objects.append(FusedObject(
                    solve([book.outline(member)], self.limits.one_camera), (camera,)))

    def _contradiction(self, book: '_Book') -> Reason:
        named = ' and '.join(self._names[camera] for camera in sorted(
            book.disagreeing or {camera for camera, frame in enumerate(book.frames)
                                 if frame is not None}))
        return Reason('cameras_disagree', Level.WARN, (
            f'{named}: the silhouettes fit no upright convex object; is one camera bumped, '
            'is a part hidden, or do two objects touch?'), is_passing=True)

    def _reason(
        self, frames: Sequence[Optional[CameraFrame]], objects: List[FusedObject], book: '_Book'
    ) -> Optional[Reason]:
        if book.disagreeing:
            named = ' and '.join(self._names[camera] for camera in sorted(book.disagreeing))
            return Reason('cameras_disagree', Level.WARN, (
                f'{named} sees objects elsewhere that rest for the other camera: is it bumped, or '
                'is something in its view?'), is_passing=True)
        if book.left_out:
            return next((one.reason for one in book.left_out if one.reason.level), None)
        if book.only_one:
            return Reason('one_camera', Level.WARN, (
                'an object is seen by one camera only: its height is the one that was measured '
                'before, or one_camera_height_cm'), is_passing=True)
        return None


class _Book:
    """
    What has been done with the silhouettes of a moment.

    :param frames: By camera.
    """

    def __init__(self, frames: Sequence[Optional[CameraFrame]]) -> None:
        self.frames = frames
        self.used: Set[Member] = set()
        self.refused: Set[Member] = set()
        self.disagreeing: Set[int] = set()
        self.agreeing: Set[int] = set()
        self.only_one = False
        self.left_out: List[NotFused] = []

    @property
    def bumped(self) -> Set[int]:
        """The cameras for which nothing rests that rests for others."""
        return self.disagreeing - self.agreeing

    def outline(self, member: Member) -> SeenOutline:
        """Return a silhouette."""
        camera, number = member
        return self.frames[camera].seen[number]

    def reach_of(self, member: Member) -> np.ndarray:
        """Return how a silhouette reaches."""
        camera, number = member
        return self.frames[camera].reaches[number]

    def leave_out(self, member: Member, reason: Reason) -> None:
        """Note what is not published."""
        self.left_out.append(NotFused(self.outline(member).corners.mean(axis=0), reason))

    def touches(self, camera: int, reached: np.ndarray) -> bool:
        """Tell whether a camera sees something where an outline is."""
        frame = self.frames[camera]
        return frame is not None and any(
            (camera, number) not in self.used for number in frame.touching(reached))

    def touches_used(self, member: Member) -> bool:
        """Tell whether a silhouette touches one of another camera that something was done with."""
        reached = self.reach_of(member)
        return any(
            frame is not None and camera != member[0] and any(
                (camera, number) in self.used | self.refused
                for number in frame.touching(reached))
            for camera, frame in enumerate(self.frames))

    @property
    def free(self) -> List[List[int]]:
        """By camera, the numbers of the silhouettes that nothing has been done with."""
        done = self.used | self.refused
        return [[] if frame is None else [
            number for number in range(len(frame.seen)) if (camera, number) not in done]
            for camera, frame in enumerate(self.frames)]

    def matched(self, highest_cm: float) -> Matches:
        """Match the free silhouettes; the result has the frames' own numbers."""
        free = self.free
        if not any(free):
            return Matches([], [], [], [])
        found = match([[self.outline((camera, number)) for number in numbers]
                       for camera, numbers in enumerate(free)], highest_cm)

        def own(members):
            return [(camera, free[camera][number]) for camera, number in members]

        return Matches([group._replace(members=tuple(own(group.members)))
                        for group in found.groups],
                       own(found.alone), own(found.disagreeing), own(found.ambiguous))
