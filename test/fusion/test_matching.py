# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Silhouettes of one object find each other; what does not fit is said, and not guessed."""

from camera_to_base.fusion import match
import cv2
import numpy as np
import pytest
from two_cameras import base_of, PAIRS, place, random_object, seen, seen_as_one

TILTED = PAIRS['tilted 30 degrees, opposite sides']
HIGHEST_CM = 10.0


def both(objects, cameras=TILTED, random=None):
    return [[seen(base, height, camera, random) for base, height in objects]
            for camera in cameras]


def box(x, y, length=4.0, width=3.0, angle=0.3):
    return base_of('box', length, width, (x, y), angle)


@pytest.mark.parametrize('pair', PAIRS)
def test_objects_of_any_height_find_their_partners(pair):
    random = np.random.default_rng(2)
    objects = [(box(-10, 0), 2.0), (box(0, 4, 3.0, 2.0), 6.0), (box(9, -3), 1.0),
               (box(3, -8, 5.0, 2.0), 4.0), (box(-6, 8), 0.2)]
    first, second = both(objects, PAIRS[pair], random)
    found = match([first, second[::-1]], HIGHEST_CM)
    assert sorted(group.members for group in found.groups) == [
        ((0, number), (1, 4 - number)) for number in range(5)]
    assert not (found.alone or found.disagreeing or found.ambiguous)
    for group in found.groups:
        assert group.solution.height.height_cm == pytest.approx(
            objects[group.members[0][1]][1], abs=0.15)


def test_an_object_that_one_camera_does_not_see_is_alone():
    first, second = both([(box(-10, 0), 2.0), (box(8, 0), 3.0)])
    found = match([first, second[:1]], HIGHEST_CM)
    assert [group.members for group in found.groups] == [((0, 0), (1, 0))]
    assert found.alone == [(0, 1)]


def test_a_camera_that_sees_nothing_leaves_all_alone():
    first, _ = both([(box(-10, 0), 2.0), (box(8, 0), 3.0)])
    assert match([first, []], HIGHEST_CM).alone == [(0, 0), (0, 1)]


def test_two_objects_that_both_cameras_see_as_one_are_left_out():
    random, count, published = np.random.default_rng(11), 0, 0
    while count < 60:
        first, height, centre = random_object(random)
        angle, away = random.uniform(0, 2 * np.pi), random.uniform(2.0, 8.0)
        second = random_object(random)[0]
        second = second - second.mean(axis=0) + centre + away * np.array(
            [np.cos(angle), np.sin(angle)])
        objects = [(first, height), (second, random.uniform(1, 8))]
        cameras = list(PAIRS.values())[count % len(PAIRS)]
        outlines = [seen_as_one(objects, camera, random) for camera in cameras]
        if cv2.intersectConvexConvex(*(cv2.convexHull(one.astype(np.float32)) for one in (
                first, second)))[0] > 0 or None in outlines:
            continue
        count += 1
        found = match([[one] for one in outlines], HIGHEST_CM)
        published += len(found.groups)
        assert len(found.groups) == 1 or found.disagreeing == [(0, 0), (1, 0)]
    assert published <= 1


def test_two_objects_that_one_camera_sees_as_one_are_not_guessed():
    camera, other = TILTED
    bases = [box(0.0, -2.0, 3.0, 3.0, 0.0), box(0.0, 4.0, 3.0, 3.0, 0.0)]
    single = [seen(base, 6.0, camera) for base in bases]
    merged = seen(np.vstack(bases), 6.0, other)
    found = match([single, [merged]], HIGHEST_CM)
    assert found.groups == [] and found.alone == []
    assert sorted(found.disagreeing) == [(0, 0), (0, 1), (1, 0)]


def test_what_would_be_higher_than_allowed_is_no_pair():
    views = both([(box(0, 0), 8.0)])
    assert len(match(views, 8.5).groups) == 1
    assert match(views, 5.0).disagreeing == [(0, 0), (1, 0)]


def test_camera_that_was_bumped_across_disagrees():
    base = box(0, 0)
    found = match([[seen(base, 3.0, TILTED[0])],
                   [seen(base, 3.0, TILTED[1], moved=(0.5, 0.0))]], HIGHEST_CM)
    assert found.groups == [] and found.disagreeing == [(0, 0), (1, 0)]


def test_one_silhouette_that_fits_two_of_the_other_camera_is_ambiguous():
    # Each neighbour fits, with another height and another width.
    first, second = both([(box(0, y, 2.0, 2.0, 0.0), 6.0) for y in (0.0, 2.5)])
    # The outlines of small pictures; else the neighbour would not fit.
    coarse = [[one._replace(noise_cm=0.06) for one in seen] for seen in (first[:1], second)]
    found = match(coarse, HIGHEST_CM)
    assert found.groups == [] and sorted(found.ambiguous) == [(0, 0), (1, 0), (1, 1)]
    assert [group.members for group in match([first, second], HIGHEST_CM).groups] == [
        ((0, 0), (1, 0)), ((0, 1), (1, 1))]


def test_three_cameras_join_their_silhouettes():
    cameras = place(30, -90), place(30, 30), place(30, 150)
    found = match(both([(box(-5, 0), 2.0), (box(6, 3), 5.0)], cameras), HIGHEST_CM)
    assert [group.members for group in found.groups] == [
        ((0, 0), (1, 0), (2, 0)), ((0, 1), (1, 1), (2, 1))]
