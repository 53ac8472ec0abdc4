# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Renders the scenes that detection_speed times: a table, and what lies on it."""

from typing import Dict, List, Tuple

import cv2
import numpy as np

TABLES = 'plain', 'textured', 'wood', 'printed'
SCENES: Dict[str, List[Tuple[float, float]]] = {
    'nothing there': [],
    'one coin': [(0.4, 0.55)],
    'four coins': [(0.2, 0.2), (0.8, 0.25), (0.25, 0.8), (0.75, 0.75)],
    'everything changed': [],
}
_TABLE, _COIN, _NOISE = 180.0, 60, 1.5
_SQUARE, _DARK_SQUARE = 0.075, 90
# No coin touches the picture's edge there.
_PLACES = 13


def make_frames(
    table: str, scene: str, size: Tuple[int, int], count: int
) -> Tuple[np.ndarray, List[np.ndarray]]:
    """Render a noisy table, and frames of it with what a scene has, in another place on each."""
    rng = np.random.default_rng(1)
    picture = _table(table, size, rng)
    frames = []
    for number in range(count):
        frame = picture.copy()
        if scene == 'everything changed':
            cells = rng.integers(0, 100, (12, 16, 1), dtype=np.uint8)
            frame[:] = cv2.resize(cells, size, interpolation=cv2.INTER_NEAREST)[:, :, None]
        for u, v in SCENES[scene]:
            centre = int((u + 0.01 * (number % _PLACES)) * size[0]), int(v * size[1])
            cv2.circle(frame, centre, round(0.0336 * size[0]), (_COIN,) * 3, -1, cv2.LINE_AA)
        frames.append(_noisy(frame, rng))
    return _noisy(picture, rng), frames


def _table(table: str, size: Tuple[int, int], rng: np.random.Generator) -> np.ndarray:
    width, height = size
    level = np.full((height, width), _TABLE, np.float32)
    if table == 'textured':
        level += 12 * _smooth(rng, size, 1.5, 1.5)
    elif table == 'wood':
        v = np.mgrid[:height, :width][0] + 9 * _smooth(rng, size, 90, 12)
        level *= 1 + 0.08 * (np.sin(v / 7) + np.sin(v / 2.3) / 2)
    elif table == 'printed':
        rows, columns = np.mgrid[:height, :width] // round(_SQUARE * width)
        level[(rows + columns) % 2 == 0] = _DARK_SQUARE
    colour = (0.65, 0.85, 1.0) if table == 'wood' else (1.0, 1.0, 1.0)
    return np.uint8(np.clip(level[..., None] * np.float32(colour), 0, 255))


def _smooth(
    rng: np.random.Generator, size: Tuple[int, int], across: float, down: float
) -> np.ndarray:
    noise = rng.standard_normal((size[1], size[0]), dtype=np.float32)
    noise = cv2.GaussianBlur(noise, (0, 0), sigmaX=across, sigmaY=down)
    return noise / noise.std()


def _noisy(picture: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    noise = rng.standard_normal(picture.shape, dtype=np.float32) * np.float32(_NOISE)
    return np.clip(np.rint(picture + noise), 0, 255).astype(np.uint8)
