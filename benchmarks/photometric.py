# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Renders a table with objects as a camera sees it, in units of light, with the truth.

A lamp of some size stands beside the camera, and the room adds its own light. Each object is a
plate of some thickness that hovers over the table: each point of the lamp casts a sharp shadow of
it, and their mean is the shadow with its penumbra. A pixel's light goes through a lens, a sensor
with a colour filter, noise and a curve, and perhaps through JPEG.

This shares nothing with the detector or with the simulated board of the package, so that figures
measured with it are no detector's own.
"""

from dataclasses import dataclass, field
from typing import List, NamedTuple, Optional, Tuple

import cv2
import numpy as np

_FINE = 6  # fine pixels along the side of a pixel


class Lamp(NamedTuple):
    """
    What lights the table.

    :param place: Of its middle over the picture, in px: u, v and its height.
    :param radius: In px; the larger, the softer the shadows.
    :param share: Of the light that comes from it and not from the room.
    """

    place: Tuple[float, float, float] = (160.0, -500.0, 900.0)
    radius: float = 60.0
    share: float = 0.6


@dataclass
class Conditions:
    """
    What a picture shows, and how it is taken.

    :param shape: disc, bar, ring, block or plus.
    :param colour: The object's reflectance, B, G and R; one number for grey.
    :param second_colour: Of its stripes; None for none.
    :param radius: In px.
    :param thickness: How far its face is above the table, in px; 0 casts no shadow.
    :param gloss: Light that a spot of it mirrors; 1 is as bright as white paper.
    :param table: Reflectance, B, G and R.
    :param pattern: board, stripes, grain, or None.
    :param shade: Light that somebody takes away who stands beside the table.
    :param tremble: The camera moves by as many px at most.
    :param flicker: The lamp's brightness changes by this share from frame to frame.
    :param electrons: That a white pixel gathers; the fewer, the noisier.
    :param blur: Of the lens, in px.
    :param quality: Of the JPEG; 0 for none.
    """

    shape: str = 'disc'
    colour: Tuple[float, ...] = (0.12,)
    second_colour: Optional[Tuple[float, ...]] = None
    radius: float = 17.0
    thickness: float = 0.0
    gloss: float = 0.0
    table: Tuple[float, float, float] = (0.42, 0.46, 0.5)
    pattern: Optional[str] = None
    shade: float = 0.0
    tremble: float = 0.0
    flicker: float = 0.0
    electrons: float = 9000.0
    blur: float = 0.8
    quality: int = 92
    lamp: Lamp = field(default_factory=Lamp)


class Photographer:
    """
    Takes pictures of a table, with an object somewhere or without.

    :param seed: Makes the places and the noise.
    """

    def __init__(
        self, conditions: Conditions, seed: int = 0, size: Tuple[int, int] = (640, 480)
    ) -> None:
        self.size = size
        self._conditions = conditions
        self._random = np.random.default_rng(seed)
        self._table = self._reflectance()

    def background(self) -> np.ndarray:
        """Take a picture of the empty table in its usual light: shape (h, w, 3), uint8, BGR."""
        return self._picture(None, usual=True)

    def frame(self) -> Tuple[np.ndarray, Tuple[float, float]]:
        """Take a picture with an object: the picture, and where its middle is, u and v in px."""
        c, (width, height) = self._conditions, self.size
        margin = 3 * c.radius + c.thickness + 20
        place = self._random.uniform(margin, (width - margin, height - margin))
        outline, hole = _outline(c.shape, c.radius, self._random.uniform(0, 2 * np.pi))
        move = self._random.uniform(-c.tremble, c.tremble, 2) if c.tremble else np.zeros(2)
        thing = outline + place, None if hole is None else hole + place
        picture = self._picture(thing, move=move)
        return picture, tuple(_centroid(outline) + place + move)

    def _picture(self, thing, move: np.ndarray = np.zeros(2), usual: bool = False) -> np.ndarray:
        c = self._conditions
        flicker = 0.0 if usual else self._random.uniform(-c.flicker, c.flicker)
        light = self._light(None if thing is None else thing[0], usual) * (1 + flicker)
        radiance = self._table * light[..., None]
        if thing is not None:
            radiance = self._with(radiance, thing, self._light(None, usual) * (1 + flicker))
        if move.any():
            shift = np.float32([[1, 0, move[0]], [0, 1, move[1]]])
            radiance = cv2.warpAffine(radiance, shift, self.size, flags=cv2.INTER_CUBIC,
                                      borderMode=cv2.BORDER_REPLICATE)
        return self._photograph(radiance)

    def _light(self, outline: Optional[np.ndarray], usual: bool) -> np.ndarray:
        c, (width, height) = self._conditions, self.size
        v, u = np.mgrid[:height, :width].astype(np.float32)
        (x, y, z), radius, share = c.lamp
        squared = (u - x) ** 2 + (v - y) ** 2 + z ** 2
        lamp = z ** 3 / squared ** 1.5  # the inverse square, and the slant of the light
        lamp /= lamp[height // 2, width // 2]
        if outline is not None and c.thickness:
            angles = np.arange(16) * 2.4  # the golden angle spreads points over a disc
            reach = radius * np.sqrt((np.arange(16) + 0.5) / 16)
            lamp = lamp * np.mean([1 - self._coverage(_shadow(
                outline, np.array([x, y]) + r * np.array([np.cos(a), np.sin(a)]), z,
                c.thickness)) for r, a in zip(reach, angles)], axis=0)
        light = share * lamp + 1 - share
        return light if usual or not c.shade else light * self._shade(u, v)

    def _shade(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        # An arm: a band that comes in from a side, with a rounded end.
        angle = self._random.uniform(0, 2 * np.pi)
        along = (u - self.size[0] / 2) * np.cos(angle) + (v - self.size[1] / 2) * np.sin(angle)
        across = (v - self.size[1] / 2) * np.cos(angle) - (u - self.size[0] / 2) * np.sin(angle)
        end = self._random.uniform(-20, 120)
        distance = np.hypot(np.minimum(along - end, 0), across - self._random.uniform(-60, 60))
        return 1 - self._conditions.shade / (1 + np.exp(np.clip((distance - 90) / 3, -30, 30)))

    def _with(self, radiance: np.ndarray, thing, light: np.ndarray) -> np.ndarray:
        c, (outline, hole) = self._conditions, thing
        cover = self._coverage(outline)
        if hole is not None:
            cover = cover - self._coverage(hole)
        colour = np.ones(3, np.float32) * np.float32(c.colour)
        face = np.broadcast_to(colour, radiance.shape)
        v, u = np.mgrid[:self.size[1], :self.size[0]].astype(np.float32)
        middle = _centroid(outline)
        if c.second_colour is not None:
            stripe = (np.floor((u + v - middle.sum()) / 7) % 2)[..., None]
            face = face * (1 - stripe) + stripe * np.float32(c.second_colour)
        seen = face * light[..., None]
        if c.gloss:
            du, dv = u - middle[0] + 0.3 * c.radius, v - middle[1] + 0.4 * c.radius
            spot = np.maximum(1 - (du * du + dv * dv) / (0.35 * c.radius) ** 2, 0)
            seen = seen + c.gloss * spot[..., None]
        return radiance + (seen - radiance) * cover[..., None]

    def _coverage(self, outline: np.ndarray) -> np.ndarray:
        # Of each pixel, from fine pixels in a window around the outline.
        low = np.maximum(np.floor(outline.min(axis=0)).astype(int) - 2, 0)
        high = np.minimum(np.ceil(outline.max(axis=0)).astype(int) + 3, self.size)
        cover = np.zeros(self.size[::-1], np.float32)
        if (high <= low).any():
            return cover
        fine = np.zeros((high - low)[::-1] * _FINE, np.uint8)
        corners = ((outline - low + 0.5) * _FINE - 0.5) * 256
        cv2.fillPoly(fine, [np.rint(corners).astype(np.int32)], 255, cv2.LINE_8, 8)
        cover[low[1]:high[1], low[0]:high[0]] = cv2.resize(
            fine, tuple(int(length) for length in high - low),
            interpolation=cv2.INTER_AREA) / np.float32(255)
        return cover

    def _reflectance(self) -> np.ndarray:
        c, (width, height) = self._conditions, self.size
        v, u = np.mgrid[:height, :width].astype(np.float32)
        factor = np.ones((height, width), np.float32)
        if c.pattern == 'board':
            factor = np.where((u // 40 + v // 40) % 2 == 0, 0.25, 1.3).astype(np.float32)
        elif c.pattern == 'stripes':
            factor = (1 + 0.25 * np.sign(np.sin((u + 0.4 * v) / 9))).astype(np.float32)
        elif c.pattern == 'grain':
            noise = self._random.standard_normal((height, width)).astype(np.float32)
            noise = cv2.GaussianBlur(noise, (0, 0), 6, sigmaY=1)
            factor = 1 + 0.12 * noise / noise.std()
        return factor[..., None] * np.float32(c.table)

    def _photograph(self, radiance: np.ndarray) -> np.ndarray:
        c = self._conditions
        light = cv2.GaussianBlur(np.maximum(radiance, 0).astype(np.float32), (0, 0), c.blur)
        sensor = np.empty(light.shape[:2], np.float32)
        # Green, red / blue, green: OpenCV's GB pattern.
        sensor[::2, ::2], sensor[1::2, 1::2] = light[::2, ::2, 1], light[1::2, 1::2, 1]
        sensor[::2, 1::2], sensor[1::2, ::2] = light[::2, 1::2, 2], light[1::2, ::2, 0]
        counted = self._random.normal(sensor * c.electrons, np.sqrt(sensor * c.electrons + 25))
        counts = np.clip(counted / c.electrons * 40000, 0, 65535).astype(np.uint16)
        colours = cv2.cvtColor(counts, cv2.COLOR_BayerGR2BGR).astype(np.float32) / 40000
        # The curve of Rec. 709, as cameras have it that were made for video.
        coded = np.where(colours < 0.018, 4.5 * colours,
                         1.099 * np.power(np.maximum(colours, 1e-6), 0.45) - 0.099)
        picture = np.clip(np.rint(coded * 255), 0, 255).astype(np.uint8)
        if c.quality:
            _, data = cv2.imencode('.jpg', picture, [cv2.IMWRITE_JPEG_QUALITY, c.quality])
            picture = cv2.imdecode(data, cv2.IMREAD_COLOR)
        return picture


def _shadow(outline: np.ndarray, lamp: np.ndarray, height: float, above: float) -> np.ndarray:
    # Where the rays from a point of the lamp through the outline meet the table.
    return outline + (outline - lamp) * above / (height - above)


def _outline(
    shape: str, radius: float, angle: float
) -> Tuple[np.ndarray, Optional[np.ndarray]]:
    turns = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    circle = radius * np.column_stack([np.cos(turns), np.sin(turns)])
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    if shape == 'disc':
        return circle, None
    if shape == 'ring':
        return circle, 0.5 * circle
    corners: List[Tuple[float, float]] = {
        'bar': [(-2, -.25), (2, -.25), (2, .25), (-2, .25)],
        'block': [(-1, -.7), (1, -.7), (1, .7), (-1, .7)],
        'plus': [(-1, -.3), (-.3, -.3), (-.3, -1), (.3, -1), (.3, -.3), (1, -.3), (1, .3),
                 (.3, .3), (.3, 1), (-.3, 1), (-.3, .3), (-1, .3)]}[shape]
    return radius * np.array(corners) @ turn, None


def _centroid(outline: np.ndarray) -> np.ndarray:
    x, y = outline.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    return np.array([((x + np.roll(x, -1)) * cross).sum(),
                     ((y + np.roll(y, -1)) * cross).sum()]) / (3 * cross.sum())
