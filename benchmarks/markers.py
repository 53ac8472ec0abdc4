# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
How exact positions are where markers tell where the camera stands, and what looking costs.

Each case is a camera with a lens of its own, whose axis is beside the middle of the picture. It is
calibrated in one place from points that a board would give, learns the four markers there (40 mm,
36 x 26 cm between their middles), is moved to another place, and computes the surface anew from
one frame with the noise, blur, gamma and JPEG of a webcam at 720p; then without each marker.
The error is that of 42 points in the area between the four.

    scripts/benchmark markers [--quick] [--json FILE] [--cases 60] [--seed 1]
"""

import argparse
from pathlib import Path
import sys
import time

from camera_to_base.calibration.checks import surface_error
from camera_to_base.calibration.homography_fit import fit_homography
from camera_to_base.errors import CameraToBaseError
from camera_to_base.markers import lens_of_values, MarkedSurface, marker_values, see_markers
from camera_to_base.pipeline import Limits, ViewWatch
from camera_to_base.surface import Hull, MatchedPoints, SURFACE_DEFAULTS, surface_values
from camera_to_base.uncertainty import scales_at, SURFACE_COVARIANCE, triangle_of, warp_design
import cv2
import numpy as np
from rows import print_rows

sys.path.insert(0, str(Path(__file__).parents[1] / 'test'))
from rendered_markers import random_camera, Table  # noqa: E402, I100

SIZE = (1280, 720)
AREA = np.stack(np.meshgrid(np.linspace(2, 38, 7), np.linspace(2, 28, 6)), axis=-1).reshape(-1, 2)
BOARD = np.stack(np.meshgrid(np.linspace(6, 34, 9), np.linspace(5, 25, 6)), axis=-1).reshape(-1, 2)
OFF_AXIS_PX = 12
# Of the squared distance in units of the covariance, two dimensions.
SHARES = {'50 %': 1.386, '90 %': 4.605, '99 %': 9.210}


def main():
    options = parse()
    rng = np.random.default_rng(options.seed)
    table = Table(seed=options.seed)
    cases = [case(rng, table) for _ in range(3 if options.quick else options.cases)]
    rows = [summary(4, [every for every, _ in cases]),
            summary(3, [one for _, without in cases for one in without]), *costs(rng, table)]
    print_rows(rows, options.json)


def parse(description=__doc__, cases=60):
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('--json')
    parser.add_argument('--cases', type=int, default=cases)
    parser.add_argument('--seed', type=int, default=1)
    return parser.parse_args()


def case(rng, table):
    """Return the errors with all markers, and without each, see `errors`."""
    lens = rng.uniform(-0.2, 0.02), rng.uniform(-0.03, 0.05)
    fixed = {'lens': lens, 'focal_px': rng.uniform(850, 1200),
             'centre_off': rng.normal(0, OFF_AXIS_PX, 2)}
    here, there = random_camera(rng, **fixed), random_camera(rng, **fixed)
    values = calibrated(here, rng)
    seen = see_markers(webcam(here, table, rng), lens_of_values(values)).corners
    surface = MarkedSurface({**values}, {})
    values = {**values, **marker_values({number: surface.surface.locate(pixels)
                                         for number, pixels in seen.items()})}
    marked = MarkedSurface.of(values)
    found = see_markers(webcam(there, table, rng), lens_of_values(values)).corners
    without = [{number: pixels for number, pixels in found.items() if number != left_out}
               for left_out in range(4)]
    return errors(marked, found, there), [errors(marked, some, there) for some in without]


def calibrated(camera, rng):
    pixels = camera.project(BOARD) + rng.normal(0, 0.1, BOARD.shape)
    matched = MatchedPoints(BOARD, pixels)
    surface = fit_homography(matched, SIZE).surface
    covariance = surface_error(surface, matched, SIZE, 'corner').covariance
    return {**SURFACE_DEFAULTS, **surface_values(surface, Hull(pixels)),
            SURFACE_COVARIANCE: triangle_of(covariance)}


def webcam(camera, table, rng):
    return camera.frame(table, rng, blur=rng.uniform(0.4, 1.4), noise=rng.uniform(1, 4),
                        jpeg=int(rng.choice([75, 85, 95])), gamma=rng.uniform(1.8, 2.4))


def errors(marked, seen, camera):
    """Return errors in mm, squared distances, and whether a marker is named; None for no fit."""
    verdict = marked.judge(seen)
    try:
        new = marked.anew(verdict.fit)
    except (AttributeError, CameraToBaseError):
        return None
    pixels = camera.project(AREA)
    missed = new.surface.locate(pixels) - AREA
    moves = scales_at(new.surface, pixels) @ warp_design(pixels, SIZE, new.surface.distortion)
    covariances = moves @ new.covariance @ moves.transpose(0, 2, 1)
    squares = np.einsum('ij,ij->i', missed,
                        np.linalg.solve(covariances, missed[:, :, None])[:, :, 0])
    return 10 * np.linalg.norm(missed, axis=1), squares, bool(verdict.moved)


def summary(count, cases):
    found = [one for one in cases if one is not None]
    distances = np.array([one[0] for one in found])
    squares = np.array([one[1] for one in found])
    return {'what': f'{count} markers seen', 'cases': len(cases),
            'without a surface': len(cases) - len(found),
            'named as moved': sum(one[2] for one in found),
            'mean mm': round(float(distances.mean()), 3),
            'worst mm': round(float(distances.max()), 3),
            **{f'inside {share}': round(float((squares < limit).mean()), 3)
               for share, limit in SHARES.items()}}


def costs(rng, table):
    """Return the CPU time of a look for markers, beside that of the check of the view."""
    rows = []
    for size in ((640, 360), SIZE):
        frames = [cv2.resize(webcam(random_camera(rng), table, rng), size,
                             interpolation=cv2.INTER_AREA) for _ in range(3)]
        lens = lens_of_values({**SURFACE_DEFAULTS, 'surface.image_size': list(size)})
        view = ViewWatch(frames[0], Limits())
        steps = {'view check': lambda: view.reason(frames[0]),
                 'look for markers': lambda: see_markers(frames[0], lens, range(4))}
        rows += [{'what': name, 'width': size[0], 'CPU ms': milliseconds(step)}
                 for name, step in steps.items()]
    return rows


def milliseconds(step):
    times = []
    for _ in range(9):
        started = time.process_time()
        step()
        times.append(time.process_time() - started)
    return round(1000 * float(np.median(times)), 2)


if __name__ == '__main__':
    cv2.setNumThreads(1)
    main()
