# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Upright objects stand where their swept silhouettes say, whatever their shape and place."""

from camera_to_base.surface import Outline, RayedSilhouette
import cv2
import numpy as np
import pytest

HEIGHT_CM = 78.0
FEET = {'straight': (0.0, 0.0), 'tilted': (0.0, -45.0), 'beside the object': (3.0, 2.0)}


def box(centre, length, width, angle):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [length / 2, width / 2]
    return centre + corners @ turn.T


def disc(centre, radius, count=120):
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])


def silhouette(base, foot, share):
    """Sweep a convex base up to a height: the hull of what is seen of it and of the top."""
    top = foot + (base - foot) / (1 - share)
    hull = cv2.convexHull(np.concatenate([base, top]).astype(np.float32))[:, 0].astype(float)
    ends = np.vstack([hull, hull[:1]])
    lengths = np.r_[0, np.cumsum(np.hypot(*np.diff(ends, axis=0).T))]
    steps = np.linspace(0, lengths[-1], 96, endpoint=False)
    return np.column_stack([np.interp(steps, lengths, column) for column in ends.T])


@pytest.mark.parametrize('foot', FEET)
@pytest.mark.parametrize('seed', range(20))
def test_footprint_of_a_prism_is_its_base(foot, seed):
    random, foot = np.random.default_rng(seed), np.array(FEET[foot])
    centre, share = random.uniform(-15, 15, 2), random.uniform(0.01, 0.08)
    base = (disc(centre, random.uniform(1, 2.5)) if seed % 2 else box(
        centre, random.uniform(2.5, 6), random.uniform(1.5, 2.4), random.uniform(0, np.pi)))
    found = RayedSilhouette(silhouette(base, foot, share), foot).footprint(share)
    truth = Outline.of(base)
    np.testing.assert_allclose(found.outline.centre, truth.centre, atol=0.01)
    assert found.outline.area == pytest.approx(truth.area, rel=0.02)
    assert found.fit > 0.98


@pytest.mark.parametrize('orientation', [1, -1])
def test_camera_above_the_object_sees_its_top(orientation):
    base, foot = disc(np.array([0.5, 0.2]), 3.0)[::orientation], np.zeros(2)
    found = RayedSilhouette(base / 0.95, foot).footprint(0.05)
    np.testing.assert_allclose(found.outline.centre, [0.5, 0.2], atol=0.01)
    assert found.outline.area == pytest.approx(9 * np.pi, rel=0.01)


def test_flat_object_stands_on_its_silhouette():
    base = box(np.array([10.0, 5.0]), 4.0, 2.0, 0.3)
    found = RayedSilhouette(silhouette(base, np.zeros(2), 0.0), np.zeros(2)).footprint(0.0)
    np.testing.assert_allclose(found.outline.centre, [10.0, 5.0], atol=0.01)
    assert found.fit == 1.0


def test_silhouette_that_is_too_short_for_a_height_does_not_fit_it():
    foot, share = np.array([0.0, -45.0]), 2 / HEIGHT_CM
    seen = RayedSilhouette(silhouette(disc(np.array([3.0, 4.0]), 1.2), foot, share), foot)
    fits = [seen.footprint(height / HEIGHT_CM).fit for height in (1, 2, 5, 12)]
    assert fits[0] > 0.99 and fits[1] > 0.98 and fits[2] < 0.9 and fits[3] == 0


def test_size_is_that_of_the_box():
    outline = Outline.of(box(np.array([10.0, 5.0]), 4.0, 2.0, 0.3))
    np.testing.assert_allclose(outline.size_along(0.3), [4.0, 2.0])
    assert outline.narrowest_angle() % np.pi == pytest.approx(0.3, abs=1e-3)
