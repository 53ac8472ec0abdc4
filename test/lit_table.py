# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A table in linear light, what lies on it, and the camera's picture of both."""

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
