# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Tables, cameras that are bumped, coins and hands: the renderer of the attack.

It knows nothing of the checks. Everything is drawn on the table, in px of the camera before it was
bumped; the camera then takes its picture, with vignetting, light and noise.
"""

from pathlib import Path
import sys

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / 'test'))
from bumped_camera import seen_at, smooth_noise, view_of  # noqa: E402, I100

SIZE = WIDTH, HEIGHT = 640, 480
MARGIN = 90
SHAPE = HEIGHT + 2 * MARGIN, WIDTH + 2 * MARGIN
EDGES = 'left', 'right', 'top', 'bottom'
SKINS = ((134, 169, 222), (103, 143, 198), (75, 110, 170), (60, 85, 140), (40, 60, 105),
         (30, 42, 70))


def _field(random, width, height):
    return smooth_noise(random, SHAPE, width, height)


def wood(random):
    """Draw long, strong grain."""
    return (random.uniform(6, 16) * _field(random, random.uniform(15, 40), random.uniform(1.5, 3))
            + 8 * _field(random, 80, 12))


def grain(random):
    """Draw grain that is hardly more than the noise."""
    return random.uniform(2, 3) * _field(random, random.uniform(6, 20), random.uniform(1.5, 3))


def speckle(random):
    """Draw fine specks."""
    return random.uniform(4, 12) * _field(random, *random.uniform(0.8, 1.5, 2))


def tiles(random):
    """Draw tiles with dark joints, each a little lighter or darker."""
    pitch, (left, top) = random.uniform(55, 110), random.uniform(0, 55, 2)
    v, u = np.mgrid[:SHAPE[0], :SHAPE[1]].astype(np.float32) + np.float32([[[top]], [[left]]])
    field = random.normal(0, 4, (40, 40))[(v // pitch).astype(int), (u // pitch).astype(int)]
    field[(v % pitch < 4) | (u % pitch < 4)] -= 25
    return cv2.GaussianBlur(field.astype(np.float32), (0, 0), 0.8)


def print_(random):
    """Draw a printed sheet: rectangles, discs and lines."""
    field = np.zeros(SHAPE, np.float32)
    for _ in range(70):
        u, v = (int(random.integers(0, length)) for length in SHAPE[::-1])
        du, dv = (int(x) for x in random.integers(10, 90, 2))
        level, shape = float(random.uniform(-60, 40)), random.integers(3)
        if shape == 0:
            cv2.rectangle(field, (u, v), (u + du, v + dv), level, 2)
        elif shape == 1:
            cv2.circle(field, (u, v), du // 3, level, -1, cv2.LINE_AA)
        else:
            cv2.line(field, (u, v), (u + du, v - dv), level, 2, cv2.LINE_AA)
    return field


def marks(random):
    """Draw four marks, one in each corner, on nothing."""
    field = np.zeros(SHAPE, np.float32)
    for u, v in ((0.1, 0.12), (0.9, 0.1), (0.12, 0.88), (0.88, 0.9)):
        at = (MARGIN + int(WIDTH * (u + random.uniform(-0.04, 0.04))),
              MARGIN + int(HEIGHT * (v + random.uniform(-0.04, 0.04))))
        cv2.drawMarker(field, at, float(random.uniform(-90, -50)), int(random.integers(2)),
                       int(random.integers(36, 56)), int(random.integers(4, 8)))
    return cv2.GaussianBlur(field, (0, 0), 0.7)


def lines(random):
    """Draw parallel lines."""
    angle, pitch = random.uniform(0, np.pi), random.uniform(25, 60)
    v, u = np.mgrid[:SHAPE[0], :SHAPE[1]].astype(np.float32)
    field = np.where((u * np.cos(angle) + v * np.sin(angle)) % pitch < 3, -18, 0)
    return cv2.GaussianBlur(field.astype(np.float32), (0, 0), 0.8)


def table_edge(random):
    """Draw the straight edge of a table along a side of the picture, and faint blotches on it."""
    v, u = np.mgrid[:SHAPE[0], :SHAPE[1]].astype(np.float32)
    angle, across = random.uniform(-0.06, 0.06), random.random() < 0.5
    along, beside = (v, u) if across else (u, v)
    distance = beside - (MARGIN + random.uniform(60, 180)) - along * np.tan(angle)
    field = random.uniform(30, 70) * np.tanh(distance / random.uniform(0.6, 3))
    return field + random.uniform(0.5, 1.5) * _field(random, 4, 4)


def plain(_):
    """Draw nothing."""
    return np.zeros(SHAPE, np.float32)


def picture(path):
    """
    Take the surface from a picture or a video.

    :returns: A function that gives one of its frames, turned or mirrored, as the canvas.
    """
    capture = cv2.VideoCapture(path)
    frames = [cv2.resize(frame, SHAPE[::-1]) for _ in range(5) for good, frame in [capture.read()]
              if good]
    if not frames:
        raise SystemExit(f"cannot read '{path}'")

    def draw(random):
        frame = frames[random.integers(len(frames))]
        frame = cv2.flip(frame, int(random.integers(-1, 2)))
        return np.float32(frame) * random.uniform(0.6, 1.1)

    return draw


SURFACES = {'wood': wood, 'faint grain': grain, 'speckle': speckle, 'tiles': tiles,
            'print': print_, 'four marks': marks, 'parallel lines': lines,
            'table edge': table_edge, 'plain': plain}


class Table:
    """
    A table and the camera above it.

    :param name: One of SURFACES, or any name.
    :param random: A numpy Generator.
    :param surface: Draws the surface, shape (h, w) or (h, w, 3); None for that of SURFACES.
    """

    def __init__(self, name, random, surface=None):
        field = (surface or SURFACES[name])(random)
        if field.ndim == 3:
            self.canvas = field
        else:
            colour = random.uniform(90, 190) * random.uniform(0.8, 1.1, 3)
            tint = random.uniform(0.85, 1.1, 3)
            self.canvas = np.float32(colour + field[..., None] * tint)
        self.name = name
        self.colour = self.canvas.mean(axis=(0, 1))
        v, u = np.mgrid[:HEIGHT, :WIDTH].astype(np.float32)
        falloff = random.uniform(0, 0.25)
        radius = np.hypot(u - WIDTH / 2, v - HEIGHT / 2)[..., None]
        self._lens = 1 - falloff * (radius / 400) ** 2
        self._noise_levels = np.float32(random.uniform(1, 2.5))
        self._random = random

    def unlike(self, random):
        """Choose a colour that hardly any of the table has: an object's, BGR."""
        pixels = self.canvas[::8, ::8].reshape(-1, 1, 3)
        colours = random.uniform(10, 245, (24, 3))
        apart = np.abs(pixels - colours).max(axis=2)
        return colours[np.percentile(apart, 1, axis=0).argmax()]

    def shoot(self, move=(0, 0, 0, 0), draw=(), light=1.0):
        """
        Take a picture.

        :param move: The camera's: du and dv in px, turn in degrees, growth.
        :param draw: Functions that draw on a canvas.
        :param light: Factor.
        """
        canvas = self.canvas.copy() if draw else self.canvas
        for function in draw:
            function(canvas)
        return self.exposed(cv2.warpAffine(canvas, view_of(move, SIZE, MARGIN), SIZE), light)

    def exposed(self, picture, light=1.0):
        """Give what reaches the lens as a picture, with vignetting and noise."""
        picture = picture * self._lens * light
        # New noise for each picture: noise that is seen again looks like a camera that has moved.
        picture += self._noise_levels * self._random.standard_normal(
            picture.shape, dtype=np.float32)
        return np.clip(np.rint(picture), 0, 255).astype(np.uint8)


def moved(move, points):
    """Tell where points of the unmoved picture are in that of a moved camera, shape (n, 2)."""
    return seen_at(move, points, SIZE, MARGIN)


def coin(at, radius=21.0, colour=(52, 60, 70)):
    """Put a coin on the table."""
    def draw(canvas):
        centre = tuple(round((x + MARGIN) * 16) for x in at)
        cv2.circle(canvas, centre, round(radius * 16), tuple(map(float, colour)), -1,
                   cv2.LINE_AA, 4)
    return draw


def arm_cover(edge, tip, width, spread=None):
    """
    Tell what an arm with a hand covers.

    :param spread: Shape (4,), how the fingers are spread; None for a fist.
    :returns: Shape of the canvas, float32, 0..1.
    """
    mask = np.zeros(SHAPE, np.uint8)
    edge, tip = np.array(edge) + MARGIN, np.array(tip) + MARGIN
    cv2.line(mask, _whole(edge), _whole(tip), 255, int(width), cv2.LINE_AA)
    cv2.circle(mask, _whole(tip), int(width * 0.75), 255, -1, cv2.LINE_AA)
    angle = np.arctan2(*(tip - edge)[::-1])
    for number, more in enumerate([] if spread is None else spread):
        turned = angle + (number - 1.5) * 0.35 + 0.1 * more
        end = tip + 1.4 * width * np.array([np.cos(turned), np.sin(turned)])
        cv2.line(mask, _whole(tip), _whole(end), 255, max(3, int(width / 4)), cv2.LINE_AA)
    return cv2.GaussianBlur(mask, (0, 0), 1.0).astype(np.float32) / 255


def arm(cover, colour):
    """Put an arm over the table."""
    def draw(canvas):
        canvas *= 1 - cover[..., None]
        canvas += cover[..., None] * np.float32(colour)
    return draw


def shadow(cover, depth=0.35, width=5):
    """Let something throw its shadow beside it."""
    def draw(canvas):
        beside = np.roll(cover, (14, 18), axis=(0, 1))
        canvas *= (1 - depth * cv2.GaussianBlur(beside, (0, 0), width))[..., None]
    return draw


def beyond(edge, random):
    """Give a place outside of the picture, beyond one of EDGES."""
    along = random.uniform(0.1, 0.9)
    return {'left': (-80, along * HEIGHT), 'right': (WIDTH + 80, along * HEIGHT),
            'top': (along * WIDTH, -80), 'bottom': (along * WIDTH, HEIGHT + 80)}[edge]


def _whole(point):
    return tuple(int(x) for x in point)
