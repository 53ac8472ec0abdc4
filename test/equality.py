# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""
Hold the fast detector against the tutorial's OpenCV calls, on frames made to part them.

    python3 test/equality.py --frames 100000 --seed 1
    python3 test/equality.py --frames 100000 --seed 1 --sizes 24 260
"""

import argparse
import sys
import time

from camera_to_base.detection.tutorial.absolute_difference import AbsoluteDifferenceDetector
import cv2
import numpy as np


def tutorial(mask):
    """Return the (box, centre, area) that the tutorial takes from its mask, or None."""
    contours = cv2.findContours(mask, cv2.RETR_TREE, cv2.CHAIN_APPROX_SIMPLE)[-2]
    areas = [cv2.contourArea(contour) for contour in contours]
    if not areas:
        return None
    largest = contours[areas.index(max(areas))]
    x, y, w, h = cv2.boundingRect(largest)
    return (x, y, w, h), (x + int(w / 2), y + int(h / 2)), max(areas)


def tutorial_mask(frame, background, threshold=95, closing_size=20, median_size=5):
    """Return the tutorial's mask."""
    def treat(picture):
        grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
        kernel = np.ones((closing_size, closing_size), np.uint8)
        closed = cv2.morphologyEx(grey, cv2.MORPH_CLOSE, kernel)
        return cv2.medianBlur(closed, median_size)
    difference = cv2.absdiff(treat(frame), treat(background))
    return cv2.threshold(difference, threshold, 255, cv2.THRESH_BINARY)[1]


def outer_outlines(mask):
    """Return the outer outlines in the tutorial's mask, the largest first, of shape (n, 2)."""
    outlines = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)[-2]
    return [outline[:, 0] for outline in sorted(
        outlines, key=lambda outline: -cv2.contourArea(outline))]


def random_size(rng):
    """Return a height and a width: mostly small, some as large as a camera's."""
    size = int(rng.integers(4))
    return (
        rng.integers(1, 30, 2) if size == 0 else
        rng.integers(20, 120, 2) if size == 1 else
        rng.integers(100, 260, 2) if size == 2 else
        rng.integers((60, 200), (200, 420)) if rng.random() < .9 else
        rng.integers((200, 600), (500, 1000)))


def random_case(rng, sizes=None):
    """Return settings and a background for a few frames, with sides of `sizes`, least and most."""
    height, width = random_size(rng) if sizes is None else rng.integers(sizes[0], sizes[1] + 1, 2)
    # Without any smoothing, every hole and island stays.
    other = int(rng.integers(1, 41)), int(rng.choice([1, 3, 5, 7, 9, 11]))
    closing, median = ([(20, 5)] * 6 + [(1, 1)] + [other] * 3)[rng.integers(10)]
    threshold = 95 if rng.random() < .6 else int(rng.choice([0, 1, 5, 40, 94, 128, 200, 254, 255]))
    picture = calm_table if rng.random() < .5 else random_picture
    return int(height), int(width), closing, median, threshold, picture(
        rng, int(height), int(width))


def calm_table(rng, height, width):
    """Return a background as most tables are: light or grey, with little contrast."""
    table = np.full((height, width, 1), rng.integers(90, 256), np.float32)
    if rng.random() < .5:
        table += rng.uniform(0, 40) * np.linspace(-1, 1, width, dtype=np.float32)[:, None]
    if rng.random() < .5:
        coarse = rng.normal(0, rng.uniform(1, 15), (height // 8 + 2, width // 8 + 2))
        table[..., 0] += cv2.resize(coarse.astype(np.float32), (width, height))
    noise = rng.choice([0, .7, 1.5, 4]) * rng.standard_normal((height, width, 3))
    return np.clip(table + rng.uniform(-20, 20, 3) + noise, 0, 255).astype(np.uint8)


def random_picture(rng, height, width):
    """Return a background: flat, gradient, noise, blocks or two levels."""
    kind = rng.integers(6)
    if kind == 0:
        return np.full((height, width, 3), rng.integers(0, 256, 3), np.uint8)
    if kind == 1:
        ramp = np.linspace(rng.integers(0, 256), rng.integers(0, 256), width)
        return np.repeat(np.tile(ramp, (height, 1))[..., None], 3, 2).astype(np.uint8)
    if kind == 2:
        return rng.integers(0, 256, (height, width, 3), dtype=np.uint8)
    if kind == 3:
        cell = int(rng.integers(2, 40))
        small = rng.integers(0, 256, (height // cell + 1, width // cell + 1, 3), dtype=np.uint8)
        return np.kron(small, np.ones((cell, cell, 1), np.uint8))[:height, :width]
    if kind == 4:
        return np.where(rng.random((height, width, 1)) < rng.random(), 255, 0).astype(
            np.uint8).repeat(3, 2)
    noise = rng.normal(rng.integers(40, 220), rng.choice([2, 10, 30]), (height, width, 3))
    return np.clip(noise, 0, 255).astype(np.uint8)


def random_frame(rng, background, threshold, closing):
    """Return a frame: the background, disturbed in one of many ways, or in several."""
    frame = background.copy()
    for _ in range(int(rng.choice([1, 1, 1, 2, 3]))):
        disturb(rng, frame, background, threshold, closing)
    return frame


def disturb(rng, frame, background, threshold, closing):
    """Draw one disturbance into a frame."""
    height, width = frame.shape[:2]
    kind = rng.integers(15)
    if kind > 12:       # dark things with soft rims, some hardly larger than the kernel
        for _ in range(int(rng.integers(1, 6))):
            shape = np.zeros((height, width), np.uint8)
            corners = rng.uniform(-1, 1, (5, 2)) * rng.uniform(1, 40) + rng.integers(
                0, (width, height))
            x, y = (int(c) for c in corners[0])
            if rng.random() < .5:
                cv2.fillPoly(shape, [corners.astype(np.int32)], 255, cv2.LINE_AA)
            else:
                cv2.rectangle(shape, (x, y), (x + closing + int(rng.integers(-3, 4)),
                                              y + closing + int(rng.integers(-3, 20))), 255, -1)
            share = shape[..., None] / 255
            level = background.mean() - threshold + rng.uniform(-60, 15)
            frame[:] = np.clip(frame * (1 - share) + level * share, 0, 255)
    elif kind == 12:      # rings in rings, with threads: nested outlines of equal area
        for _ in range(int(rng.integers(1, 8))):
            x, y = (int(c) for c in rng.integers(0, (width, height)))
            r = int(rng.integers(1, 12))
            rhombus = np.array([[x - r, y], [x, y - r], [x + r, y], [x, y + r]])
            cv2.polylines(frame, [rhombus], True, (0, 0, 0))
            if rng.random() < .5:
                cv2.line(frame, (x + r, y), (x + r + int(rng.integers(9)), y), (0, 0, 0))
    elif kind == 0:     # noise that just stays below, meets or passes the threshold
        step = rng.choice([threshold - 1, threshold, threshold + 1])
        signs = rng.choice([-1, 0, 1], (height, width, 1 if rng.random() < .5 else 3))
        frame[:] = np.clip(frame + step * signs, 0, 255)
    elif kind == 1:     # the whole picture, lighter or darker
        frame[:] = np.clip(frame.astype(int) + rng.integers(-130, 131), 0, 255)
    elif kind == 2:     # single pixels
        for _ in range(int(rng.integers(1, 30))):
            frame[rng.integers(height), rng.integers(width)] = rng.integers(0, 256, 3)
    elif kind == 3:     # sparse salt and pepper
        chosen = rng.random((height, width)) < 10 ** rng.uniform(-4, -.5)
        frame[chosen] = rng.choice([0, 255])
    elif kind == 4:     # equal objects: equal areas
        side = int(rng.integers(1, max(2, min(height, width) // 3)))
        for _ in range(int(rng.integers(2, 6))):
            x, y = rng.integers(-side, width), rng.integers(-side, height)
            frame[max(y, 0):max(y + side, 0), max(x, 0):max(x + side, 0)] = 0
    elif kind == 5:     # thin rings: holes
        centre = tuple(int(c) for c in rng.integers(0, (width, height)))
        radius = int(rng.integers(1, max(2, max(height, width) // 2)))
        cv2.circle(frame, centre, radius, [int(c) for c in rng.integers(0, 256, 3)],
                   int(rng.integers(1, 5)))
    elif kind == 6:     # pieces at the border
        t = int(rng.integers(1, 2 * closing + 8))
        side = [np.s_[:t], np.s_[-t:], np.s_[:, :t], np.s_[:, -t:]][rng.integers(4)]
        frame[side] = rng.integers(0, 256, 3)
    elif kind == 7:     # one channel only
        x, y = rng.integers(0, (width, height))
        frame[y:y + 30, x:x + 30, rng.integers(3)] ^= 255
    elif kind == 8:     # stripes
        frame[:, ::int(rng.integers(2, 2 * closing + 2))] = rng.choice([0, 255])
    elif kind == 9:     # nothing
        pass
    elif kind == 10:    # another picture
        frame[:] = random_picture(rng, height, width)
    else:               # rectangles and discs, near the threshold or far from it
        for _ in range(int(rng.integers(1, 6))):
            x, y = (int(c) for c in rng.integers((-30, -30), (width + 30, height + 30)))
            r = int(rng.integers(0, 45))
            shape = np.zeros((height, width), np.uint8)
            if rng.random() < .5:
                cv2.circle(shape, (x, y), r, 1, -1)
            else:
                cv2.rectangle(shape, (x, y), (x + r, y + int(rng.integers(0, 45))), 1, -1)
            step = rng.choice([threshold, threshold + 1, threshold + 30, 255]) * rng.choice(
                [-1, 1])
            frame[:] = np.where(shape[..., None] > 0, np.clip(
                background.astype(int) + step, 0, 255), frame)


def mismatches(frames, seed, sizes=None):
    """Yield each case that differs; `frames` in all, see `random_case`."""
    rng = np.random.default_rng(seed)
    done = found = 0
    while done < frames:
        height, width, closing, median, threshold, background = random_case(rng, sizes)
        detector = AbsoluteDifferenceDetector(
            background, threshold=threshold, closing_size=closing, median_size=median)
        for _ in range(min(8, frames - done)):
            frame = random_frame(rng, background, threshold, closing)
            mask = tutorial_mask(frame, background, threshold, closing, median)
            expected = tutorial(mask)
            got = detector.detect(frame)
            first = (got[0].box, got[0].centre, got[0].area) if got else None
            outlines = outer_outlines(mask)
            if first != expected or len(got) != len(outlines) or not all(
                    np.array_equal(one.outline, other) for one, other in zip(got, outlines)):
                yield (height, width, closing, median, threshold), first, expected
            found += expected is not None
            done += 1
    mismatches.found = found


def main():
    """Run and report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--frames', type=int, default=2000)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--sizes', type=int, nargs=2, metavar=('LEAST', 'MOST'),
                        help='sides of the frames, in px; otherwise small ones and large ones')
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    started, wrong = time.time(), 0
    for case in mismatches(arguments.frames, arguments.seed, arguments.sizes):
        wrong += 1
        print('MISMATCH', *case)
        if wrong > 20:
            break
    print(f'OpenCV {cv2.__version__}: {arguments.frames} frames, '
          f'{mismatches.__dict__.get("found")} with an object, {wrong} mismatches, '
          f'{time.time() - started:.0f} s')
    sys.exit(wrong > 0)


if __name__ == '__main__':
    main()
