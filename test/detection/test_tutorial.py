# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import re

from camera_to_base.checks import check_frame
from camera_to_base.detection.detection import Box, Pixel
from camera_to_base.detection.tutorial import AbsoluteDifferenceDetector
from camera_to_base.errors import FrameSizeError, InvalidValueError
import cv2
import numpy as np
import pytest

FRAMES_OF_A_KIND = 20


def contours_of(background, frame, threshold, closing_size, median_size):
    kernel = np.ones((closing_size, closing_size), np.uint8)
    grey_background = cv2.cvtColor(background, cv2.COLOR_BGR2GRAY)
    grey_background = cv2.morphologyEx(grey_background, cv2.MORPH_CLOSE, kernel)
    grey_background = cv2.medianBlur(grey_background, median_size)
    grey_frame = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
    grey_frame = cv2.morphologyEx(grey_frame, cv2.MORPH_CLOSE, kernel)
    grey_frame = cv2.medianBlur(grey_frame, median_size)
    difference = cv2.absdiff(grey_frame, grey_background)
    _, mask = cv2.threshold(difference, threshold, 255, cv2.THRESH_BINARY)
    contours, _ = cv2.findContours(mask, cv2.RETR_TREE, cv2.CHAIN_APPROX_SIMPLE)
    return contours


def tutorial_object(contours):
    if len(contours) < 1:
        return None
    areas = [cv2.contourArea(contour) for contour in contours]
    x, y, w, h = cv2.boundingRect(contours[np.argmax(areas)])
    return (x, y, w, h), (x + int(w / 2), y + int(h / 2))


def detected_object(detections):
    return (detections[0].box, detections[0].centre) if detections else None


def has_equals(contours):
    areas = sorted(cv2.contourArea(contour) for contour in contours)
    return len(areas) > 1 and areas[-1] == areas[-2]


def random_size(rng):
    return tuple(int(length) for length in rng.integers(1, 91, 2))


def plain(size, level):
    return np.full((*size, 3), level, np.uint8)


def noise_all_over(rng, threshold):
    size = random_size(rng)
    return tuple(rng.integers(0, rng.integers(1, 257), (*size, 3), dtype=np.uint8)
                 for _ in range(2))


def noise_close_to_the_threshold(rng, threshold):
    size = random_size(rng)
    background = plain(size, 0 if rng.random() < 0.5 else 255)
    levels = threshold + rng.integers(-1, 3, size)
    frame = np.abs(background.astype(int) - levels[:, :, None]).clip(0, 255).astype(np.uint8)
    return background, frame


def whole_change(rng, threshold):
    size = random_size(rng)
    return plain(size, rng.integers(0, 256)), plain(size, rng.integers(0, 256))


def rectangles_also_over_the_border(rng, threshold):
    background = plain(random_size(rng), 250)
    frame = background.copy()
    for _ in range(rng.integers(1, 6)):
        x, y = rng.integers(-10, 90, 2)
        w, h = rng.integers(1, 60, 2)
        cv2.rectangle(frame, (int(x), int(y)), (int(x + w), int(y + h)), rng.integers(
            0, 256, 3).tolist(), -1)
    return background, frame


def equal_squares_on_a_grid(rng, threshold):
    edge, gap = (int(length) for length in rng.integers(1, 45, 2))
    margin = int(rng.choice([0, 1, 25]))
    columns, rows = (int(count) for count in rng.integers(1, 5, 2))
    size = [count * (edge + gap) - gap + 2 * margin for count in (rows, columns)]
    background = plain(size, 230)
    frame = background.copy()
    for row in range(rows):
        for column in range(columns):
            x, y = margin + column * (edge + gap), margin + row * (edge + gap)
            frame[y:y + edge, x:x + edge] = 15
    return background, frame


def thin_lines_and_rings(rng, threshold):
    dark, light = (20, 235) if rng.random() < 0.5 else (235, 20)
    background = plain(random_size(rng), light)
    frame = background.copy()
    for _ in range(rng.integers(1, 5)):
        (x, y), (x2, y2) = rng.integers(0, 90, (2, 2)).tolist()
        thickness, radius = int(rng.integers(1, 4)), int(rng.integers(0, 30))
        cv2.line(frame, (x, y), (x2, y2), (dark,) * 3, thickness)
        cv2.circle(frame, (x, y), radius, (dark,) * 3, thickness)
        cv2.rectangle(frame, (x, y), (x2, y2), (dark,) * 3, thickness)
    return background, frame


def single_pixels(rng, threshold):
    size = random_size(rng)
    dark, light = (0, 255) if rng.random() < 0.5 else (255, 0)
    background = plain(size, light)
    frame = background.copy()
    frame[rng.random(size) < rng.choice([0.01, 0.1, 0.4, 0.6])] = dark
    return background, frame


def noisy_coins(rng, threshold):
    background = rng.normal(200, 4, (*random_size(rng), 3))
    frame = rng.normal(200, 4, background.shape)
    coins = np.zeros(background.shape[:2], np.uint8)
    for _ in range(3):
        x, y, radius = rng.integers(0, [90, 90, 25]).tolist()
        cv2.circle(coins, (x, y), radius, 1, -1)
    frame[coins > 0] -= rng.uniform(threshold - 10, 190)
    return tuple(picture.clip(0, 255).astype(np.uint8) for picture in (background, frame))


KINDS = [noise_all_over, noise_close_to_the_threshold, whole_change,
         rectangles_also_over_the_border, equal_squares_on_a_grid, thin_lines_and_rings,
         single_pixels, noisy_coins]


@pytest.mark.parametrize('threshold, closing_size, median_size', [
    (95, 20, 5), (50, 20, 5), (95, 1, 1), (0, 3, 1), (20, 7, 9), (180, 2, 3)])
def test_largest_object_is_the_tutorials_to_the_pixel(threshold, closing_size, median_size):
    parameters = {'threshold': threshold, 'closing_size': closing_size,
                  'median_size': median_size}
    different, seen, equals = [], 0, 0
    for kind, make in enumerate(KINDS):
        for seed in range(FRAMES_OF_A_KIND):
            background, frame = make(np.random.default_rng((seed, kind)), threshold)
            contours = contours_of(background, frame, **parameters)
            detections = AbsoluteDifferenceDetector(background, **parameters).detect(frame)
            if detected_object(detections) != tutorial_object(contours):
                different.append((make.__name__, seed))
            seen += bool(contours)
            equals += has_equals(contours)
    assert different == []
    # The comparison is worth something only with objects, without them, and with equals.
    assert seen > 30 and len(KINDS) * FRAMES_OF_A_KIND - seen > 5 and equals > 3


def dark_rectangles(*boxes, size=(120, 160)):
    frame = plain(size, 220)
    for x, y, width, height in boxes:
        frame[y:y + height, x:x + width] = 20
    return frame


def test_detection_tells_its_box_its_centre_and_its_area():
    detector = AbsoluteDifferenceDetector(plain((60, 80), 220), closing_size=1, median_size=1)
    detection, = detector.detect(dark_rectangles((10, 20, 31, 12), size=(60, 80)))
    assert detection.box == Box(x=10, y=20, width=31, height=12)
    assert detection.centre == Pixel(u=25, v=26)
    assert detection.area == 30 * 11


def test_detections_come_largest_first():
    detector = AbsoluteDifferenceDetector(plain((120, 160), 220), closing_size=1)
    detections = detector.detect(dark_rectangles(
        (5, 5, 12, 12), (40, 5, 40, 40), (100, 5, 20, 20), (5, 60, 30, 30), (60, 60, 20, 50)))
    assert [detection.box.width for detection in detections] == [40, 20, 30, 20, 12]
    areas = [detection.area for detection in detections]
    assert areas == sorted(areas, reverse=True)


def test_hole_in_an_object_is_no_object():
    frame = dark_rectangles((20, 20, 80, 80))
    frame[40:80, 40:80] = 220
    detector = AbsoluteDifferenceDetector(plain((120, 160), 220), closing_size=1)
    assert [detection.box for detection in detector.detect(frame)] == [Box(20, 20, 80, 80)]


def test_background_itself_shows_no_object():
    background = np.random.default_rng(3).integers(0, 256, (90, 120, 3), dtype=np.uint8)
    assert AbsoluteDifferenceDetector(background, threshold=0).detect(background) == []


@pytest.mark.parametrize('difference, count', [(94, 0), (95, 0), (96, 1)])
def test_object_differs_by_more_than_the_threshold(difference, count):
    detector = AbsoluteDifferenceDetector(plain((60, 60), 200))
    frame = plain((60, 60), 200)
    frame[10:50, 10:50] = 200 - difference
    assert len(detector.detect(frame)) == count


def test_threshold_255_lets_nothing_through():
    detector = AbsoluteDifferenceDetector(plain((30, 30), 0), threshold=255)
    assert detector.detect(plain((30, 30), 255)) == []


def test_frames_are_left_as_they_are():
    background, frame = plain((120, 160), 220), dark_rectangles((40, 40, 40, 40))
    before = background.copy(), frame.copy()
    AbsoluteDifferenceDetector(background).detect(frame)
    np.testing.assert_array_equal(background, before[0])
    np.testing.assert_array_equal(frame, before[1])


def test_background_is_that_of_construction_whatever_happens_to_the_array():
    background = plain((120, 160), 220)
    detector = AbsoluteDifferenceDetector(background)
    background[:] = 0
    assert detector.detect(plain((120, 160), 220)) == []


def test_detector_keeps_nothing_of_the_last_frame():
    detector = AbsoluteDifferenceDetector(plain((120, 160), 220))
    frames = [dark_rectangles((10, 10, 40, 40)), dark_rectangles((90, 60, 50, 30))]
    first, second = (detector.detect(frame) for frame in frames)
    assert detector.detect(frames[0]) == first != second == detector.detect(frames[1])


@pytest.mark.parametrize('view', [
    lambda frame: frame[::2, ::3],
    lambda frame: frame[::-1, ::-1],
    lambda frame: frame[10:-10, 5:-25],
    lambda frame: frame[:, :, ::-1],
    lambda frame: frame.transpose(1, 0, 2),
], ids=['every second', 'turned', 'cut out', 'colours swapped', 'transposed'])
def test_frame_need_not_be_contiguous(view):
    background, frame = plain((120, 160), 220), dark_rectangles((40, 30, 70, 50))
    detections = AbsoluteDifferenceDetector(view(background)).detect(view(frame))
    contiguous = np.ascontiguousarray(view(background)), np.ascontiguousarray(view(frame))
    assert not view(frame).flags.c_contiguous
    assert detections == AbsoluteDifferenceDetector(contiguous[0]).detect(contiguous[1]) != []


@pytest.mark.parametrize('size', [(240, 320), (480, 641), (640, 480), (1, 1)])
def test_frame_of_another_size_than_the_background_is_refused(size):
    detector = AbsoluteDifferenceDetector(plain((480, 640), 220))
    with pytest.raises(FrameSizeError, match=f'{size[1]} x {size[0]} px.*640 x 480 px'):
        detector.detect(plain(size, 220))


@pytest.mark.parametrize('picture', [
    np.zeros((48, 64), np.uint8),
    np.zeros((48, 64, 1), np.uint8),
    np.zeros((48, 64, 4), np.uint8),
    np.zeros((48, 64, 3), np.float32),
    np.zeros((48, 64, 3), np.int8),
    np.zeros((48, 64, 3), np.uint16),
    np.zeros((0, 64, 3), np.uint8),
    np.zeros((48, 0, 3), np.uint8),
    None,
    [[[0, 0, 0]]],
], ids=['grey', 'grey with a channel', 'four channels', 'float32', 'int8', 'uint16', 'no rows',
        'no columns', 'None', 'list'])
def test_what_is_no_colour_picture_is_refused(picture):
    with pytest.raises(InvalidValueError, match='expected a background'):
        AbsoluteDifferenceDetector(picture)
    with pytest.raises(InvalidValueError, match='expected a frame'):
        AbsoluteDifferenceDetector(plain((48, 64), 220)).detect(picture)


def test_error_tells_the_shape_that_came():
    with pytest.raises(InvalidValueError, match=re.escape('got (48, 64)')):
        check_frame(np.zeros((48, 64), np.uint8))


@pytest.mark.parametrize('name, value', [
    ('threshold', -1), ('threshold', 256), ('threshold', float('nan')),
    ('closing_size', 0), ('closing_size', -20),
    ('median_size', 0), ('median_size', -5), ('median_size', 4)])
def test_error_names_the_bad_parameter_and_its_value(name, value):
    with pytest.raises(InvalidValueError, match=f'^{name} must be .*got {value}$'):
        AbsoluteDifferenceDetector(plain((48, 64), 220), **{name: value})
    parameters = {'threshold': 95, 'closing_size': 20, 'median_size': 5, name: value}
    with pytest.raises(InvalidValueError, match=name):
        AbsoluteDifferenceDetector.check_parameters(**parameters)


@pytest.mark.parametrize('parameters', [(0, 1, 1), (255, 500, 99), (95, 20, 5)])
def test_parameters_at_the_ends_of_their_ranges_are_accepted(parameters):
    threshold, closing_size, median_size = parameters
    AbsoluteDifferenceDetector.check_parameters(threshold, closing_size, median_size)
    detector = AbsoluteDifferenceDetector(
        plain((7, 9), 220), threshold=threshold, closing_size=closing_size,
        median_size=median_size)
    assert detector.detect(plain((7, 9), 220)) == []
