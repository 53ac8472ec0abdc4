# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
Days on which the camera is moved, and the markers are covered, moved, swapped and shone at.

Each day is a cell with a lens of its own, calibrated from points that a board would give, with
640 x 360 px and 10 frames a second through the whole pipeline, and `background_retake` auto or
never. At random, the camera is bumped, carried elsewhere, put back or zoomed; markers are covered,
moved or swapped; light, glare, hands, new backgrounds and restarts come between. A point is wrong
if it is more than 2 mm (1 mm and 1 px) from the coin. At the end all is tidied, and the coin must
be found.

    scripts/benchmark marker_days [--quick] [--json FILE] [--days 40] [--seed 1]
"""

import argparse
import json
from pathlib import Path
import sys

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / 'test'))
from marker_day import play  # noqa: E402, I100


def main():
    """Print each day that went wrong, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--quick', action='store_true', help='one short day, for its exit code')
    parser.add_argument('--json', metavar='FILE', help='write the days as a list of objects')
    parser.add_argument('--days', type=int, default=40)
    parser.add_argument('--seed', type=int, default=1)
    arguments = parser.parse_args()
    days = range(1 if arguments.quick else arguments.days)
    rows = [row(1000 * arguments.seed + day, ('coin',) if arguments.quick else None)
            for day in days]
    print(told(rows))
    if arguments.json:
        Path(arguments.json).write_text(json.dumps(rows))


def row(seed, kinds):
    course = play(seed, kinds)
    found = {'day': seed, 'points': len(course.errors_mm) + len(course.wrong),
             'wrong': [list(one) for one in course.wrong], 'errors_mm': course.errors_mm,
             'outside': int(course.outside), 'ends well': course.back_s is not None,
             'held back': dict(course.reasons)}
    if course.wrong or course.back_s is None:
        print(f'day {seed}: {course.wrong}, ends well: {course.back_s is not None}, events '
              f'{", ".join(course.events)}', flush=True)
    return found


def told(rows):
    errors = [error for one in rows for error in one['errors_mm']] or [0.0]
    points = max(sum(one['points'] for one in rows), 1)
    return (f'{len(rows)} days, {points} points, wrong {sum(len(one["wrong"]) for one in rows)}, '
            f'error mean {np.mean(errors):.2f}, 99 % {np.percentile(errors, 99):.2f}, worst '
            f'{max(errors):.2f} mm, outside of their 99 % ellipse '
            f'{sum(one["outside"] for one in rows) / points:.2%}, days that did not end well '
            f'{sum(not one["ends well"] for one in rows)}')


if __name__ == '__main__':
    cv2.setNumThreads(1)
    main()
