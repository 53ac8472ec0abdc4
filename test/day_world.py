# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
A small table, its camera, and what happens on it: the renderer of the random days.

It knows nothing of the checks. The canvas is larger than the picture, so that a bumped camera sees
what lies beside it. Lengths are in px of the camera before it is bumped; 1 px is 0.5625 mm.
"""

import bumped_camera
from bumped_camera import smooth_noise, view_of
import cv2
import numpy as np

SIZE = WIDTH, HEIGHT = 320, 240
MARGIN = 40
SHAPE = HEIGHT + 2 * MARGIN, WIDTH + 2 * MARGIN
MM_PER_PX, FRAMES_PER_S = 0.5625, 12
AT_REST = np.zeros(4)
# How far a part of the robot's frame reaches into the picture's corner, in px.
BRACKET = 60, 50
# Objects lie at least so far apart, in px: those that touch come as one.
_APART = 10


class Thing:
    """
    An object on the table: a disc or a rectangle.

    :param at: Its centre, in px.
    :param in_background: Whether the background shows it; `is_on_sheet` whether it lies on paper.
    """

    def __init__(self, random, colour, at):
        self.at, self.colour = np.array(at, float), colour
        self.radius, self.angle = random.uniform(9, 18), random.uniform(0, 180)
        self.width = self.radius * random.uniform(0.6, 1.0)
        self.is_round = random.random() < 0.5
        self.in_background = self.is_on_sheet = False

    @property
    def reach(self):
        """How far it reaches from its centre, in px."""
        return self.radius if self.is_round else np.hypot(self.radius, self.width)

    def draw(self, canvas):
        """Draw it."""
        at, colour = self.at + MARGIN, tuple(map(float, self.colour))
        if self.is_round:
            cv2.circle(canvas, _sixteenths(at), round(self.radius * 16), colour, -1,
                       cv2.LINE_AA, 4)
        else:
            box = cv2.boxPoints((tuple(at), (2 * self.radius, 2 * self.width), self.angle))
            cv2.fillConvexPoly(canvas, np.rint(box * 16).astype(int), colour, cv2.LINE_AA, 4)


class Arm:
    """
    A fore-arm with a hand, each with a colour of its own, that reaches in from beyond an edge.

    :param begin: Where it comes from, in px.
    :param tip: The middle of its hand when it has reached in.
    """

    def __init__(self, random, table_colour, begin, tip):
        self._begin, self._tip = np.array(begin, float), np.array(tip, float)
        self._width = random.uniform(18, 46)
        self._spread = random.uniform(-1, 1, 4) if random.random() < 0.7 else ()
        self._colours = [_unlike(random, table_colour) for _ in range(2)]
        self._dark = random.uniform(0.5, 0.85) if random.random() < 0.6 else None

    def draw(self, canvas, reach):
        """Draw it, with its shadow; `reach` 0 is out of the view, 1 as far as it goes."""
        begin, tip = self._begin + MARGIN, self._begin + reach * (self._tip - self._begin) + MARGIN
        hand, arm = (np.zeros(SHAPE, np.uint8) for _ in range(2))
        cv2.line(arm, _whole(begin), _whole(tip), 255, int(self._width), cv2.LINE_AA)
        cv2.circle(hand, _whole(tip), int(self._width * 0.75), 255, -1, cv2.LINE_AA)
        angle = np.arctan2(*(tip - begin)[::-1])
        for number, more in enumerate(self._spread):
            turned = angle + (number - 1.5) * 0.35 + 0.1 * more
            end = tip + 1.4 * self._width * np.array([np.cos(turned), np.sin(turned)])
            cv2.line(hand, _whole(tip), _whole(end), 255, max(3, int(self._width / 4)),
                     cv2.LINE_AA)
        if self._dark is not None:
            beside = cv2.blur(np.roll(np.maximum(hand, arm), (7, 9), (0, 1)), (7, 7))
            shade = 1 - (1 - self._dark) / 255 * beside
            canvas[:] = canvas * shade[..., None]
        for mask, colour in zip((arm, hand), self._colours):
            inside = mask > 127
            canvas[inside] = colour


class World:
    """
    The table, what is on it, and the camera. A frame's events set what lasts for one frame.

    `pose` is the camera's: du and dv in px, turn in degrees, growth. `shift` is added for a frame.
    `has_texture` tells whether the table has some everywhere: light can be told from paper there.
    """

    def __init__(self, seed):
        self._random = random = np.random.default_rng([seed, 1])
        self.colour = random.uniform(90, 150) * random.uniform(0.85, 1.1, 3)
        surface = SURFACES[random.integers(len(SURFACES))]
        self.has_texture, field = surface is not _print, surface(random)
        tint = random.uniform(0.85, 1.1, 3)
        self._canvas = np.clip(self.colour + field[..., None] * tint, 0, 255).astype(np.uint8)
        noise = random.uniform(1, 2)
        self._noises = [np.rint(random.normal(0, noise, (HEIGHT + 16, WIDTH + 16, 3)))
                        .astype(np.int16) for _ in range(3)]
        self.things, self.pose, self.light = [], AT_REST.copy(), 1.0
        # How far the table was pushed, and a part of the robot's frame that stays where it is.
        self.push, self.bracket = np.zeros(2), None
        self.begin_frame()

    def begin_frame(self):
        """Forget what lasts for one frame."""
        self.arms, self.shift, self.moving, self.flicker = [], AT_REST.copy(), [], 1.0
        self.damages, self.is_lost, self.orders, self.gains = [], False, [], []

    @property
    def is_calm(self):
        """Whether nothing moves, and nobody reaches in."""
        return not (self.arms or self.moving or self.damages or self.is_lost or self.gains
                    or self.shift.any() or self.flicker != 1.0)

    def shoot(self):
        """Take a picture, shape (240, 320, 3), uint8."""
        canvas = self._canvas.copy()
        for thing in self.things:
            thing.draw(canvas)
        for arm, reach in self.arms:
            arm.draw(canvas, reach)
        if self.push.any():
            shift = np.column_stack([np.eye(2), self.push])
            canvas = cv2.warpAffine(
                canvas, shift, SHAPE[::-1], borderMode=cv2.BORDER_REFLECT)
        if self.bracket is not None:
            canvas[:MARGIN + BRACKET[1], :MARGIN + BRACKET[0]] = self.bracket
        for gain in self.gains:
            canvas = cv2.convertScaleAbs(canvas * gain[..., None])
        picture = cv2.warpAffine(canvas, view_of(
            self.pose + self.shift, SIZE, MARGIN), SIZE)
        picture = cv2.convertScaleAbs(picture, alpha=self.light * self.flicker)
        v, u, which = self._random.integers((16, 16, 3))
        return cv2.add(picture, self._noises[which][v:v + HEIGHT, u:u + WIDTH], dtype=cv2.CV_8U)

    def free_place(self, random, but=None):
        """Find a place for an object, in px; None where there is none."""
        for _ in range(20):
            at = random.uniform((30, 30), (WIDTH - 30, HEIGHT - 30))
            if self.is_free(at, but):
                return at
        return None

    def is_free(self, at, but=None, reach=26):
        """Tell whether no object is near a place, and no part of the robot's frame."""
        if self.bracket is not None and (at < np.add(BRACKET, reach + _APART)).all():
            return False
        return all(np.hypot(*(other.at - at)) > other.reach + reach + _APART
                   for other in self.things if other is not but)

    def add_bracket(self):
        """Show a part of the robot's frame in the picture's corner."""
        shape = MARGIN + BRACKET[1], MARGIN + BRACKET[0]
        field = _field(np.random.default_rng(1), 3, 3)[:shape[0], :shape[1], None]
        self.bracket = np.uint8(np.clip(70 + 25 * field, 5, 250)).repeat(3, 2)

    def new_thing(self, random, at):
        """Make an object that can be told from the table."""
        sign = random.choice([-1, 1])
        return Thing(random, np.clip(self.colour + sign * random.uniform(60, 110)
                                     + random.uniform(-8, 8, 3), 5, 250), at)


def seen_from_table(pose):
    """Give the map from places on the table to the pixels of a camera, shape (3, 3)."""
    corners = np.array([[0, 0], [1, 0], [0, 1]], float)
    origin, right, down = bumped_camera.seen_at(pose, corners, SIZE, MARGIN)
    return np.array([[*column, 0.0] for column in (right - origin, down - origin)]
                    + [[*origin, 1.0]]).T


def _field(random, width, height):
    return smooth_noise(random, SHAPE, width, height)


def _wood(random):
    return random.uniform(5, 11) * _field(random, random.uniform(8, 18), 1.5) + 4 * _field(
        random, 25, 5)


def _speckle(random):
    return random.uniform(4, 10) * _field(random, *random.uniform(1, 2, 2))


def _stone(random):
    return random.uniform(6, 12) * _field(random, *random.uniform(3, 6, 2))


def _print(random):
    field = np.zeros(SHAPE, np.float32)
    for _ in range(60):
        u, v = (int(random.integers(0, length)) for length in SHAPE[::-1])
        level, shape = float(random.uniform(-30, 25)), random.integers(3)
        du, dv = (int(x) for x in random.integers(6, 45, 2))
        if shape == 0:
            cv2.rectangle(field, (u, v), (u + du, v + dv), level, 2)
        elif shape == 1:
            cv2.circle(field, (u, v), du // 3, level, -1, cv2.LINE_AA)
        else:
            cv2.line(field, (u, v), (u + du, v - dv), level, 2, cv2.LINE_AA)
    return field


SURFACES = _wood, _speckle, _stone, _print
_SKINS = (134, 169, 222), (103, 143, 198), (60, 85, 140), (30, 42, 70)


def _unlike(random, table_colour):
    # Skin, or a sleeve that is darker or lighter than the table.
    if random.random() < 0.4:
        return np.array(_SKINS[random.integers(len(_SKINS))]) * random.uniform(0.8, 1.1)
    levels = random.choice([-1, 1]) * random.uniform(12, 140)
    return np.clip(table_colour + levels + random.uniform(-4, 4, 3), 3, 250)


def _sixteenths(at):
    return tuple(round(x * 16) for x in at)


def _whole(at):
    return tuple(int(x) for x in at)
