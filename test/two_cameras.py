# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Upright objects as two cameras see them: exact silhouettes with the noise of an outline."""

from camera_to_base.coordinate_transform import CameraPlace
from camera_to_base.fusion import SeenOutline, Viewpoint
import cv2
import numpy as np

# Cameras of 1280 x 720 px, 80 cm away: 1200 px of focal length.
CM_PER_PX = 80 / 1200
NOISE_PX = 0.3
RASTER_CM = 0.02


def place(tilt_deg, towards_deg, away_cm=80.0):
    """Return where a camera is that looks at the middle of the table."""
    tilt, towards = np.deg2rad([tilt_deg, towards_deg])
    foot = away_cm * np.sin(tilt) * np.array([np.cos(towards), np.sin(towards)])
    return CameraPlace(tuple(foot.tolist()), float(away_cm * np.cos(tilt)))


PAIRS = {
    'tilted 30 degrees, opposite sides': (place(30, -90), place(30, 90)),
    'tilted 30 degrees, 90 degrees apart': (place(30, -90), place(30, 0)),
    'one straight, one tilted 35 degrees': (place(0, 0), place(35, -90)),
    'both straight, 40 cm apart': (
        CameraPlace((-20.0, 0.0), 80.0), CameraPlace((20.0, 0.0), 80.0)),
}


def base_of(shape, length, width, centre, angle):
    """Return what an object stands on: a box, a disc or a hexagon; shape (n, 2), in cm."""
    count = {'box': 4, 'disc': 90, 'hexagon': 6}[shape]
    angles = 2 * np.pi * np.arange(count) / count
    unit = np.column_stack([np.cos(angles), np.sin(angles)])
    if shape == 'box':
        unit = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    else:
        width = length
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return np.asarray(centre) + unit * [length / 2, width / 2] @ turn


def seen(base, height_cm, camera, random=None, covariance_cm2=1e-4, moved=(0.0, 0.0),
         noise_px=NOISE_PX):
    """Return the silhouette of an upright object, with noise where there is a random source."""
    foot = np.array(camera.foot_cm)
    top = foot + (base - foot) / (1 - height_cm / camera.height_cm)
    hull = cv2.convexHull(np.concatenate([base, top]).astype(np.float32))[:, 0].astype(float)
    if random is not None:
        ends = np.vstack([hull, hull[:1]])
        lengths = np.r_[0, np.cumsum(np.hypot(*np.diff(ends, axis=0).T))]
        steps = np.arange(0, lengths[-1], 3 * CM_PER_PX)
        hull = np.column_stack([np.interp(steps, lengths, column) for column in ends.T])
        hull += random.normal(0, noise_px * CM_PER_PX, hull.shape)
    return SeenOutline(hull + moved, covariance_cm2 * np.eye(2),
                       Viewpoint(camera, np.zeros((3, 3))))


def seen_as_one(objects, camera, random):
    """Return the silhouette of objects, each a base and a height, as one; None if it is not."""
    hulls = [seen(base, height, camera).corners for base, height in objects]
    origin = np.concatenate(hulls).min(axis=0) - 0.2
    pixels = [np.round((hull - origin) / RASTER_CM).astype(np.int32) for hull in hulls]
    mask = np.zeros(np.concatenate(pixels).max(axis=0)[::-1] + 10, np.uint8)
    for one in pixels:
        cv2.fillPoly(mask, [one], 255)
    outlines, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    if len(outlines) != 1:
        return None
    corners = outlines[0].reshape(-1, 2)[::10] * RASTER_CM + origin
    corners = corners + random.normal(0, NOISE_PX * CM_PER_PX, corners.shape)
    return SeenOutline(corners, 1e-4 * np.eye(2), Viewpoint(camera, np.zeros((3, 3))))


def random_object(random, widest=15.0):
    """Return the base of an object somewhere on the table, its height and its centre."""
    shape = random.choice(['box', 'disc', 'hexagon'])
    centre = random.uniform([-widest, -10], [widest, 10])
    base = base_of(shape, random.uniform(2, 6), random.uniform(2, 6), centre,
                   random.uniform(0, np.pi))
    return base, float(random.uniform(1, 8)), centre
