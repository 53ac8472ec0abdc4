# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures how many errors the ellipses of positions contain, and how wide the ellipses are.

    scripts/benchmark uncertainty [--cells 2000] [--boards FOLDER] [--quick] [--json FILE]

First in simulation: random cells with tilt, lens, noise, touch errors and heights, each term
alone, then all together. The height's error lies on a line, the others have two dimensions. Then,
with --boards, on pictures of a chessboard of 9 x 6 inner corners, 25 mm apart: the surface is
calibrated with 18 corners and tested on the other 36. `width` is the half axes' length divided by
the one that 90 % would need.
"""

import argparse
import glob
import json
import os
from typing import Any, Dict, List, Optional

from camera_to_base.calibration.boards.board import board_points, find_board
from camera_to_base.calibration.checks import surface_error
from camera_to_base.calibration.homography_fit import HomographyProblem
from camera_to_base.surface import MatchedPoints
from camera_to_base.uncertainty import radius_for, scales_at, warp_design
import cv2
import numpy as np
from uncertainty_cells import Cell, TERMS

SHARES = 0.5, 0.9, 0.95
# In one dimension.
_ON_A_LINE = {0.5: 0.6745, 0.9: 1.6449, 0.95: 1.96}
# 99 % of a normal distribution.
_DEVIATIONS = 2.576


def contained(squares: np.ndarray, is_line: bool = False) -> List[float]:
    """Return which part of relative squares lies within the ellipse of each share."""
    limits = [(_ON_A_LINE[share] if is_line else radius_for(share)) ** 2 for share in SHARES]
    return [float(np.mean(squares < limit)) for limit in limits]


def simulated(count: int, seed: int = 7) -> List[Dict[str, Any]]:
    """Return a row for each term: how many errors its ellipses contain."""
    outcomes = [Cell(np.random.default_rng([seed, number])).outcomes() for number in range(count)]
    return [{'what': term, 'cells': count, 'contained': contained(
        np.array([outcome[term].square for outcome in outcomes]), term == 'height')}
        for term in TERMS]


def interval(share: float, count: int) -> float:
    """Return half the width of the binomial 99 % interval."""
    return _DEVIATIONS * float(np.sqrt(share * (1 - share) / count))


def choices() -> Dict[str, List[np.ndarray]]:
    """Return masks of 18 of 6 x 9 corners: blocks, at random, and spread over the board."""
    random = np.random.default_rng(0)
    blocks = [(0, 3, 0, 6), (3, 6, 3, 9), (1, 4, 1, 7), (0, 6, 0, 3), (0, 6, 3, 6), (0, 6, 6, 9)]
    masks = {name: [] for name in ('a block', 'at random', 'spread')}
    for top, bottom, left, right in blocks:
        mask = np.zeros((6, 9), bool)
        mask[top:bottom, left:right] = True
        masks['a block'].append(mask.ravel())
    for _ in range(3):
        mask = np.zeros(54, bool)
        mask[random.permutation(54)[:18]] = True
        masks['at random'].append(mask)
    mask = np.zeros((6, 9), bool)
    mask[np.ix_([0, 2, 5], [0, 2, 3, 5, 6, 8])] = True
    masks['spread'].append(mask.ravel())
    return masks


def left_out_squares(pixels: np.ndarray, points: np.ndarray, used: np.ndarray, size) -> np.ndarray:
    """Calibrate with some corners; return the relative squares of the others' errors."""
    matched = MatchedPoints(points[used], pixels[used])
    problem = HomographyProblem([matched], size, with_distortion=True)
    surface = problem.surface(problem.solve()[0], np.arange(len(matched)))
    fit = surface_error(surface, matched, size, 'corner')
    scales = scales_at(surface, pixels[~used])
    design = warp_design(pixels[~used], size, surface.distortion)
    # A corner that is left out has the error of a corner, too.
    in_picture = (design @ fit.covariance @ design.transpose(0, 2, 1)
                  + fit.point_px ** 2 * np.eye(2))
    covariances = scales @ in_picture @ scales.transpose(0, 2, 1)
    errors = surface.locate(pixels[~used]) - points[~used]
    return np.einsum('ni,nij,nj->n', errors, np.linalg.inv(covariances), errors)


def on_boards(folder: str, most: Optional[int] = None) -> List[Dict[str, Any]]:
    """Return a row for each way to choose 18 corners of the boards in a folder."""
    points = board_points(9, 6, 25.0)
    squares: Dict[str, List[np.ndarray]] = {}
    paths = sorted(path for kind in ('jpg', 'png') for path in glob.glob(
        os.path.join(folder, f'*.{kind}')))[:most]
    for path in paths:
        image = cv2.imread(path)
        pixels = find_board(image, 9, 6).pixels.astype(float)
        for name, masks in choices().items():
            squares.setdefault(name, []).extend(left_out_squares(
                pixels, points, used, (image.shape[1], image.shape[0])) for used in masks)
    return [{'what': f'18 corners {name}', 'pictures': len(paths),
             'contained': contained(np.concatenate(found)),
             'width': float(radius_for(0.9) / np.sqrt(np.quantile(np.concatenate(found), 0.9)))}
            for name, found in squares.items()]


def print_rows(rows: List[Dict[str, Any]]) -> None:
    """Print a table."""
    for row in rows:
        shares = ' '.join(f'{share:7.1%}' for share in row['contained'])
        width = f'{row["width"]:7.2f}' if 'width' in row else ''
        print(f'{row["what"]:22} {shares} {width}', flush=True)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--cells', type=int, default=2000)
    parser.add_argument('--boards', metavar='FOLDER', help='pictures of a chessboard')
    parser.add_argument('--quick', action='store_true', help='few cells, for its exit code')
    parser.add_argument('--json', metavar='FILE', help='write the rows as a list of objects')
    arguments = parser.parse_args()
    cells = 20 if arguments.quick else arguments.cells
    print(f'{cells} random cells: errors within the ellipse of')
    print(f'{"term":22} ' + ' '.join(f'{share:7.0%}' for share in SHARES))
    rows = simulated(cells)
    print_rows(rows)
    print(f'{"99 % interval: +-":22} ' + ' '.join(
        f'{interval(share, cells):7.1%}' for share in SHARES))
    if arguments.boards:
        print(f'\nboards in {arguments.boards}: corners left out, within the ellipse of')
        print(f'{"calibrated with":22} ' + ' '.join(f'{share:7.0%}' for share in SHARES)
              + '   width')
        boards = on_boards(arguments.boards, 1 if arguments.quick else None)
        print_rows(boards)
        rows += boards
    if arguments.json:
        with open(arguments.json, 'w') as file:
            json.dump(rows, file, indent=1)


if __name__ == '__main__':
    main()
