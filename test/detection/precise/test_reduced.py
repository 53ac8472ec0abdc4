# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Large objects are placed on a reduced picture, nearly as well as on the whole one."""

from camera_to_base.detection.precise.detector import PreciseDifferenceDetector
from camera_to_base.detection.precise.piece import enlarged, Piece, reduced
import cv2
import numpy as np
import pytest

HEIGHT, WIDTH, FINE = 480, 640, 8


def grain(random, sigma, scale):
    noise = random.normal(0, 1, (HEIGHT, WIDTH)).astype(np.float32)
    return cv2.GaussianBlur(noise, (0, 0), scale) * sigma * scale * 3.5


def picture(random, light):
    grey = 255 * np.clip(light, 0, 1) ** (1 / 2.2) + random.normal(0, 1.2, light.shape)
    return cv2.merge([np.clip(grey, 0, 255).astype(np.uint8)] * 3)


def covered_shares(centre, radius):
    """Draw a disc at FINE times the size; give the shares, and the centre as it was drawn."""
    drawn = np.zeros((HEIGHT * FINE, WIDTH * FINE), np.uint8)
    place = [round((value + 0.5) * FINE - 0.5) for value in centre]
    cv2.circle(drawn, place, round(radius * FINE), 255, cv2.FILLED)
    shares = cv2.resize(drawn, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA) / np.float32(255)
    return shares, (np.array(place) + 0.5) / FINE - 0.5


@pytest.mark.parametrize('seed', range(4))
def test_large_textured_object_with_a_shadow_is_placed_well(seed):
    random = np.random.default_rng(seed)
    shares, centre = covered_shares(random.uniform((220, 190), (420, 290)), 145.0)
    table = np.clip((150 + grain(random, 3, 2)) / 255, 0, 1) ** 2.2
    thing = np.clip((70 + grain(random, 6, 6)) / 255, 0, 1) ** 2.2
    moved = cv2.warpAffine(shares, np.float32([[1, 0, 10], [0, 1, 8]]), (WIDTH, HEIGHT))
    shadow = 1 - 0.35 * cv2.GaussianBlur(moved, (0, 0), 4)
    detector = PreciseDifferenceDetector(picture(random, table))
    found, = detector.detect(picture(random, table * shadow * (1 - shares) + thing * shares))
    assert found.centre == pytest.approx(centre, abs=0.15)
    assert found.area == pytest.approx(shares.sum(), rel=0.005)


def test_small_piece_stays_as_it_is():
    piece = Piece(*(np.ones((30, 40, *rest)) for rest in ((3,), (3,), ())))
    assert reduced(piece, 1200) == (piece, 1)


@pytest.mark.parametrize('size', [(200, 300), (201, 303), (199, 301)])
def test_reduced_piece_has_the_light_and_the_mask_of_the_whole_one(size):
    light = np.full((*size, 3), 0.25, np.float32)
    mask = np.zeros(size, np.uint8)
    mask[50:, 60:] = 1
    piece, scale = reduced(Piece(light, 2 * light, mask), 20_000)
    assert scale == 2 and piece.mask.size <= 20_000
    assert (piece.frame == 0.25).all() and (piece.table == 0.5).all()
    assert np.array_equal(enlarged(piece.mask, scale, mask), mask)
