# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the renderers of bumped cameras share: where such a camera looks, and noise."""

import cv2
import numpy as np


def view_of(move, size, margin):
    """
    Give the map from the canvas to the picture of a bumped camera, shape (2, 3).

    :param move: du and dv in px, turn in degrees, growth.
    :param size: Width and height of the picture, in px.
    :param margin: How far the canvas goes on beside the picture, in px.
    """
    du, dv, angle, growth = move
    centre = tuple(margin + length / 2 for length in size)
    matrix = cv2.getRotationMatrix2D(centre, angle, 1 + growth)
    matrix[:, 2] += du - margin, dv - margin
    return matrix


def seen_at(move, points, size, margin):
    """Tell where a bumped camera sees points of the unmoved picture, shape (..., 2), in px."""
    matrix = view_of(move, size, margin)
    return (np.asarray(points, float) + margin) @ matrix[:, :2].T + matrix[:, 2]


def smooth_noise(random, shape, width, height):
    """Draw noise of a grain's width and height, in px; its standard deviation is 1."""
    field = random.standard_normal(shape).astype(np.float32)
    field = cv2.GaussianBlur(field, (0, 0), sigmaX=width, sigmaY=height)
    return field / field.std()
