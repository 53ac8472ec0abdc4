# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Random days: drives the pipeline, without ROS, through what happens on them, and knows the truth.

A day is a number and a list of events. It is wrong where a published point is more than 3 mm from
every object, and silent where an object at rest is not published for 3 s of which all is well.
`shrunk` drops the events that a failure does not need.
"""

from collections import deque
from dataclasses import replace
import time
from typing import NamedTuple, Optional, Tuple

from camera_to_base.detection import DetectorSettings, read_areas
from camera_to_base.pipeline import CameraPipeline, DamageCheck, Limits
from camera_to_base.sources import DEVICE
from camera_to_base.surface.models import ParallelSurface
import cv2
from day_events import EVENTS
from day_world import BRACKET, FRAMES_PER_S, HEIGHT, MM_PER_PX, seen_from_table, WIDTH, World
import numpy as np

WRONG_MM, SILENT_S, LENGTH_S = 3.0, 3.0, 18.0
# Objects that are closer to the edge of the picture, or of work_area, need not be published.
_NEAR_EDGE_PX, _NEAR_EDGE_CM = 8, 0.5
# The corners of work_area, left, top, right, bottom, in cm: the whole picture.
_EVERYWHERE = np.array([0.0, 0.0, 18.0, 13.5])


class Event(NamedTuple):
    """What happens, when it begins, in s, and the number that all else of it is drawn from."""

    kind: str
    at: float
    seed: int


class Day(NamedTuple):
    """A day; the number chooses the table, its noise, and the object that lies there first."""

    seed: int
    events: Tuple[Event, ...]


class Failure(NamedTuple):
    """What went wrong, 'wrong' or 'silent', when, in s, and which."""

    kind: str
    at: float
    what: str


class Watch:
    """The pipeline and its check for damage, with a clock of their own."""

    def __init__(self, has_bracket=False):
        # In the future, so that no frame is too old however busy the machine is.
        self._begin = time.monotonic() + 3600
        self._damage = DamageCheck()
        width, height = BRACKET
        self._settings, self._limits = DetectorSettings(faintest=13.0), Limits(
            fixed_areas=f'0 0, {width} 0, {width} {height}, 0 {height}' if has_bracket else '')
        self.work_area = _EVERYWHERE
        self._surface = ParallelSurface(WIDTH * MM_PER_PX / 10, WIDTH)
        self._pipeline = CameraPipeline(self._surface, self._settings, self._limits, kind=DEVICE)
        self.reason = None

    @property
    def has_background(self):
        """Whether there is one."""
        return self._pipeline.background is not None

    @property
    def correction(self):
        """How the camera was nudged since the background was taken; None for not at all."""
        return self._pipeline.standpoint.correction

    def see(self, frame, at):
        """Give the points that are published of a frame, shape (n, 2), in mm."""
        self.reason = self._damage.reason(frame)
        if self.reason is not None:
            return np.empty((0, 2))
        sighting = self._pipeline.process(frame, self._begin + at)
        self.reason = sighting.reason or sighting.warning
        objects = [] if sighting.reason else sighting.objects
        return np.array([one.point for one in objects]).reshape(-1, 2) * 10

    def obey(self, order, numbers):
        """Set a parameter, or take the background anew."""
        if order == 'capture':
            self._pipeline.capture_background(1 if numbers[0] < 0.5 else 5)
        elif order == 'limits':
            self._limits = self._limits._replace(confirm_jump_px=4 + 8 * numbers[0])
        elif order == 'faintest':
            self._settings = replace(self._settings, faintest=9 + 9 * numbers[0])
        elif order == 'rebuilt':
            self._settings = replace(self._settings, min_area_cm2=0.01 + 0.1 * numbers[0])
        else:
            self._limit_to(_EVERYWHERE if order == 'no work area' else _EVERYWHERE
                           + 4 * numbers * (1, 1, -1, -1))
        self._pipeline.configure(self._surface, self._settings, self._limits)

    def _limit_to(self, area):
        left, top, right, bottom = self.work_area = area
        corners = (left, top, right, top, right, bottom, left, bottom)
        self._settings = replace(self._settings, areas=read_areas(corners, ''))


def random_day(seed):
    """Make a day of 6 to 13 events; the first puts an object on the table."""
    random = np.random.default_rng([seed, 0])
    kinds = list(EVENTS)
    # On most days much is put and moved; a background is not taken all the time.
    weights = {'retake': 0.5, 'put': 4.0, 'hand': 2.0, 'leave': 2.0}
    share = np.array([weights.get(kind, 1.0) for kind in kinds])
    count = random.integers(5, 13)
    times = np.sort(random.uniform(1.0, LENGTH_S - SILENT_S - 2, count)).round(2)
    chosen = ['put', *random.choice(kinds, count, p=share / share.sum())]
    return Day(seed, tuple(
        Event(str(kind), float(at), int(random.integers(1000000)))
        for kind, at in zip(chosen, [0.5, *times])))


def play(day):
    """Play a day; give its first failure, None for none, and how many points were published."""
    has_bracket = any(event.kind == 'push' for event in day.events)
    world, watch = World(day.seed), Watch(has_bracket)
    if has_bracket:
        # Without one, a pushed table is taken for a nudged camera.
        world.add_bracket()
    truth = _Truth(world, watch)
    waiting, running, orders, count = list(day.events), [], deque(), 0
    for number in range(int(LENGTH_S * FRAMES_PER_S)):
        at = number / FRAMES_PER_S
        world.begin_frame()
        while waiting and waiting[0].at <= at and watch.has_background:
            event = waiting.pop(0)
            running.append(EVENTS[event.kind](world, np.random.default_rng(event.seed)))
        running = [event for event in running if next(event, StopIteration) is not StopIteration]
        orders.extend(world.orders)
        # A background is taken when nothing else goes on.
        while orders and (orders[0][0] != 'capture' or not running):
            truth.note_order(orders[0][0], at)
            watch.obey(*orders.popleft())
        frame = truth.damaged(world.shoot())
        points = np.empty((0, 2)) if frame is None else watch.see(frame, at)
        count += len(points)
        failure = truth.judge(points, at)
        if failure is not None:
            return failure, count
    return None, count


def shrunk(day, kind):
    """Drop the events without which a day fails in the same way, one after the other."""
    for event in reversed(day.events):
        smaller = day._replace(events=tuple(one for one in day.events if one != event))
        failure, _ = play(smaller)
        if failure is not None and failure.kind == kind:
            day = smaller
    return day


class _Truth:
    # What is where, and since when all is well. Positions are those of the first background's
    # view. A camera that was bumped and not corrected gives those of the next one.

    def __init__(self, world, watch):
        self._world, self._watch = world, watch
        # The camera's pose when the background was taken, the one that its pixels are located by,
        # and the map from the table to the first background's view.
        self._pose = self._known_pose = world.pose
        self._push = world.push
        self._seen_from_table, self._correction = seen_from_table(world.pose), None
        self._frames, self._had_background, self._left = [], False, []
        self._since, self._places = {}, {}
        self._calm_since, self._light = 0.0, world.light

    def note_order(self, order, at):
        if order == 'capture':
            self._had_background = False
        self._calm_since = at

    def damaged(self, frame):
        """Give a frame as it comes from the camera; None where it does not come."""
        frames, self._frames = self._frames, [*self._frames[-3:], frame]
        if self._world.is_lost:
            return None
        for kind, row, colour in self._world.damages:
            if kind == 'repeated' and frames:
                frame = self._frames[-1] = frames[-1]
            elif kind == 'frozen rows' and frames:
                frame[row:] = frames[0][row:]
            elif kind == 'black':
                frame = np.zeros_like(frame)
            elif kind in ('one colour', 'grey'):
                frame[row:] = colour if kind == 'one colour' else 128
        sizes = [size for kind, *size in self._world.damages if kind == 'size']
        return cv2.resize(frame, sizes[0]) if sizes else frame

    def judge(self, points, at):
        self._note_background()
        world = self._world
        if self._watch.correction is not self._correction:
            self._correction = self._watch.correction
            self._known_pose = (
                self._pose if self._correction is None else world.pose + world.shift)
        is_as_before = (world.is_calm and np.array_equal(world.pose, self._pose)
                        and np.array_equal(world.push, self._push)
                        and world.light == self._light)
        if not is_as_before or not self._watch.has_background:
            self._calm_since, self._light = at, world.light
        places = [(self._seen_from_table @ [*(thing.at + world.push), 1.0])[:2] * MM_PER_PX
                  for thing in world.things]
        for point in points:
            off = min((float(np.hypot(*(point - place))) for place in places), default=np.inf)
            if off > WRONG_MM:
                return Failure('wrong', at, f'({point[0]:.1f}, {point[1]:.1f}) mm is {off:.1f} mm '
                               f'from every object')
        return self._silence(points, places, at)

    def _note_background(self):
        if self._watch.has_background and not self._had_background:
            now = seen_from_table(self._world.pose)
            # Equal where the camera has not moved since its pixels were known.
            self._seen_from_table = (
                self._seen_from_table @ np.linalg.inv(seen_from_table(self._known_pose)) @ now)
            self._pose = self._known_pose = self._world.pose
            self._push = self._world.push
            self._left = [thing.at.copy() for thing in self._world.things]
            for thing in self._world.things:
                thing.in_background = True
        self._had_background = self._watch.has_background

    def _silence(self, points, places, at) -> Optional[Failure]:
        for thing, place in zip(self._world.things, places):
            is_seen = len(points) and np.hypot(*(points - place).T).min() < WRONG_MM
            is_at_rest = np.array_equal(self._places.get(id(thing)), thing.at)
            self._places[id(thing)] = thing.at.copy()
            if is_seen or not is_at_rest or not self._is_expected(thing, place):
                self._since[id(thing)] = at
            since = max(self._since.get(id(thing), at), self._calm_since)
            if at - since > SILENT_S:
                reason = self._watch.reason
                return Failure('silent', at, f'nothing at {np.round(place, 1)} mm for 3 s: '
                               f'{reason and reason.kind}')
        return None

    def _is_expected(self, thing, place):
        at = (seen_from_table(self._pose) @ [*(thing.at + self._push), 1.0])[:2]
        edges = np.array([0, 0, WIDTH, HEIGHT])
        in_view = (np.concatenate([at, -at]) - edges * (1, 1, -1, -1)).min() > (
            thing.reach + _NEAR_EDGE_PX)
        cm, area = place / 10, self._watch.work_area
        in_area = (np.concatenate([cm, -cm]) - area * (1, 1, -1, -1)).min() > _NEAR_EDGE_CM
        # Where an object of the background has left, another one can be taken for it.
        is_clear = not any(np.hypot(*(thing.at - left)) < thing.reach + 30 for left in self._left)
        return (in_view and in_area and is_clear and not thing.in_background
                and not thing.is_on_sheet)
