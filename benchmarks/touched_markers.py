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
How exact a calibration from four touched markers is, and whether its uncertainty is honest.

Each case is a camera with a lens of its own, of another model than ours, and with a principal
point of its own. It looks at four markers (40 mm, 36 x 26 cm between their middles) whose print
is off by 0.3 %, with the noise, blur and JPEG of a webcam at 720p. The robot touches their
middles with an error of 0.5 to 1.4 mm. The error is that of positions in the base frame: of 42
points in the area between the markers, and of 54 points over the whole picture.

    scripts/benchmark touched_markers [--quick] [--json FILE] [--cases 100] [--seed 1]
"""

from pathlib import Path
import sys

from camera_to_base.calibration import calibrate_touched_markers
from camera_to_base.errors import CameraToBaseError, HorizonError
from camera_to_base.markers import see_markers
from camera_to_base.parameters import checked_values, TRANSFORM_SPECS
from camera_to_base.surface import make_surface, SURFACE_SPECS
from camera_to_base.uncertainty import (
    position_uncertainty, uncertain_transform_of, UNCERTAINTY_SPECS)
import cv2
from markers import AREA, parse, SHARES, SIZE
import numpy as np
from rows import print_rows

sys.path.insert(0, str(Path(__file__).parents[1] / 'test'))
from rendered_markers import marker_corners, random_camera, Table  # noqa: E402, I100

PICTURE = np.stack(np.meshgrid(np.linspace(20, 1260, 9), np.linspace(20, 700, 6)),
                   axis=-1).reshape(-1, 2)
# The base frame's z points up, the table's y is seen clockwise from x: where the robot stands.
TURN, PLACE = np.array([[0.8, 0.6], [0.6, -0.8]]), np.array([12.0, -31.0])


def main():
    options = parse(__doc__, 100)
    rng = np.random.default_rng(options.seed)
    table = Table(seed=options.seed)
    cases = [case(rng, table) for _ in range(3 if options.quick else options.cases)]
    rows = [summary(name, [one[index] for one in cases if one is not None], len(cases))
            for index, name in enumerate(('between the markers', 'whole picture'))]
    print_rows(rows, options.json)


def case(rng, table):
    """Return errors in mm and squared distances, between the markers and in the picture."""
    lens = rng.uniform(-0.25, 0.03), rng.uniform(-0.03, 0.06)
    camera = random_camera(rng, lens=lens, focal_px=rng.uniform(850, 1200))
    camera.centre = camera.centre + rng.normal(0, 8, 2)
    if not camera.sees():
        return case(rng, table)
    frame = camera.frame(table, rng, blur=rng.uniform(0.4, 1.4), noise=rng.uniform(1, 4),
                         jpeg=int(rng.choice([75, 85, 95])))
    error_cm = rng.uniform(0.05, 0.14)
    touched = {number: tuple(base(corners.mean(axis=0)) + rng.normal(0, error_cm, 2))
               for number, corners in marker_corners().items()}
    try:
        values = calibrate_touched_markers(
            lambda lens: [see_markers(frame, lens).corners], touched,
            40 * (1 + rng.normal(0, 0.003)), SIZE, source='a rendered camera').calibration.values
    except CameraToBaseError as error:
        print(error)
        return None
    return (judged(values, camera.project(AREA), AREA),
            judged(values, PICTURE, camera._points(PICTURE)))


def base(points):
    """Return where points of the table are in the base frame."""
    return np.asarray(points) @ TURN.T + PLACE


def judged(values, pixels, points):
    """Return errors in the base frame, in mm, and their squared distances."""
    known = {**checked_values([*SURFACE_SPECS, *UNCERTAINTY_SPECS], values),
             'detector.method': 'precise', 'uncertainty.centre_floor_px': 0.0,
             'uncertainty.height_tolerance_cm': 0.0}
    surface = make_surface(known)
    uncertainty = position_uncertainty(known, surface)
    transform = uncertain_transform_of(checked_values(TRANSFORM_SPECS, values))
    distances, squares = [], []
    for pixel, true in zip(pixels, base(points)):
        try:
            found = (*surface.locate([pixel])[0], 0.0)
        except HorizonError:
            continue
        missed = transform.settings.conversion.convert_point(*found)[:2] - true
        covariance = transform.base_covariance(
            found, uncertainty.of_pixel(pixel, SIZE).matrix)[:2, :2]
        distances.append(10 * float(np.linalg.norm(missed)))
        squares.append(float(missed @ np.linalg.solve(covariance, missed)))
    return distances, squares


def summary(name, cases, count):
    distances = np.concatenate([one[0] for one in cases])
    squares = np.concatenate([one[1] for one in cases])
    return {'where': name, 'cases': count, 'refused': count - len(cases),
            'mean mm': round(float(distances.mean()), 2),
            '99 % mm': round(float(np.quantile(distances, 0.99)), 2),
            'worst mm': round(float(distances.max()), 2),
            **{f'inside {share}': round(float((squares < limit).mean()), 3)
               for share, limit in SHARES.items()}}


if __name__ == '__main__':
    cv2.setNumThreads(1)
    main()
