# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Bands of a lamp that flickers are no objects, and do not move what lies there."""

import math

from camera_to_base.detection.precise.detector import PreciseDifferenceDetector
from camera_to_base.detection.precise.other_light import find_bands, without_bands
import cv2
import numpy as np
import pytest

HEIGHT, WIDTH, FINE = 240, 320, 8
CENTRE, RADIUS = (150.3, 121.7), 16.0


def disc():
    drawn = np.zeros((HEIGHT * FINE, WIDTH * FINE), np.uint8)
    place = [round((value + 0.5) * FINE - 0.5) for value in CENTRE]
    cv2.circle(drawn, place, round(RADIUS * FINE), 255, cv2.FILLED)
    return cv2.resize(drawn, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)[..., None] / 255


def flicker(height, period, phase=0.7):
    return (1 + height * np.sin(2 * np.pi * np.arange(HEIGHT) / period + phase))[:, None, None]


def photograph(light, seed):
    noise = np.random.default_rng(seed).normal(0, 1.5, (HEIGHT, WIDTH, 3))
    grey = 255 * np.clip(light, 0, 1) ** (1 / 2.2) * np.ones((1, 1, 3)) + noise
    return np.clip(np.rint(grey), 0, 255).astype(np.uint8)


@pytest.mark.parametrize('height', [0.05, 0.1, 0.2])
@pytest.mark.parametrize('period', [60, 150, 400])
@pytest.mark.parametrize('colour', [0.05, 0.25])
def test_object_in_the_light_of_a_lamp_that_flickers_is_found_alone(height, period, colour):
    table = np.full((HEIGHT, WIDTH, 1), 0.5)
    detector = PreciseDifferenceDetector(photograph(table, 1))
    scene = table * (1 - disc()) + colour * disc()
    found, = detector.detect(photograph(scene * flicker(height, period), 2))
    assert math.dist(found.centre, CENTRE) < 0.2


def test_bands_on_a_table_with_squares_that_are_too_light_are_no_objects():
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    table = np.where((rows // 40 + columns // 40) % 2, 1.05, 0.1)[..., None]
    detector = PreciseDifferenceDetector(photograph(table, 1))
    assert detector.detect(photograph(table * flicker(0.1, 150), 2)) == []


def test_frame_without_its_bands_looks_like_the_background():
    table = np.full((HEIGHT, WIDTH, 1), 0.5)
    background, frame = photograph(table, 1), photograph(table * flicker(0.2, 100), 2)
    even = without_bands(frame, background, find_bands(frame, background))
    assert abs(np.float32(even).mean(axis=(1, 2)) - background.mean(axis=(1, 2))).max() < 3.5


@pytest.mark.parametrize('shade', [
    np.s_[:, 100:], np.s_[100:, :200], np.s_[60:, :]])  # a side, a corner, most of the picture
def test_shade_with_an_edge_is_no_band(shade):
    light = np.full((HEIGHT, WIDTH, 1), 0.5)
    background = photograph(light, 1)
    light[shade] *= 0.5
    assert find_bands(photograph(light, 2), background) is None
