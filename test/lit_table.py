# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A table in linear light, what lies on it, and the camera's picture of both."""

from camera_to_base.detection import PreciseDifferenceDetector
import cv2
import numpy as np

SIZE = 240, 320
TABLE = np.float32([0.28, 0.42, 0.55])  # light, B, G and R


def coded(light, seed, quality=95, noise=1.5):
    """Give a camera's picture of light, shape (h, w, 3), with noise and JPEG."""
    grey = 255 * np.clip(light, 0, 1) ** (1 / 2.2)
    grain = np.random.default_rng(seed).normal(0, noise, light.shape)
    picture = np.uint8(np.clip(np.rint(grey + grain), 0, 255))
    jpeg = cv2.imencode('.jpg', picture, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return cv2.imdecode(jpeg, cv2.IMREAD_COLOR)


def covered(*corners, blur=0.7):
    """Give which part of each pixel a polygon covers, shape (h, w, 1), float32."""
    large = np.zeros((SIZE[0] * 4, SIZE[1] * 4), np.uint8)
    cv2.fillPoly(large, [np.int32(np.array(corners) * 4)], 255)
    shares = cv2.resize(large, SIZE[::-1], interpolation=cv2.INTER_AREA) / np.float32(255)
    return cv2.GaussianBlur(shares, (0, 0), blur)[..., None]


def disc(u, v, radius):
    """Give which part of each pixel a disc covers."""
    return covered(*ring(u, v, radius))


def ring(u, v, radius):
    """Give corners of a disc, shape (60, 2), px."""
    turns = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    return np.column_stack([u + radius * np.cos(turns), v + radius * np.sin(turns)])


def felt(texture, seed):
    """Give the light of a table whose light varies by this part."""
    grain = cv2.GaussianBlur(np.random.default_rng(seed).normal(0, 1, SIZE), (0, 0), 1.2)
    return TABLE * (1 + texture * grain / grain.std())[..., None].astype(np.float32)


def shaded(light, shares, depth=0.5, tint=(1, 1, 1)):
    """Lay a shade with a soft edge on it."""
    soft = cv2.GaussianBlur(shares, (0, 0), 1.5)[..., None]
    return light * (1 - soft * (1 - (1 - depth) * np.float32(tint)))


def painted(light, shares, colour):
    """Lay a thing on it."""
    return light * (1 - shares) + shares * np.float32(colour)


def detect(light, background, quality=95):
    """Find what lies on a table."""
    detector = PreciseDifferenceDetector(coded(background, 1, quality))
    return detector.detect(coded(light, 2, quality))


def overlap(detection, true):
    """Give the intersection of an outline and a mask of shape (h, w), over their union."""
    found = np.zeros(SIZE, np.uint8)
    cv2.fillPoly(found, [detection.outline], 1)
    return (found & true).sum() / (found | true).sum()
