# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
How exactly the camera's place is known after `calibrate board`, in cells with known truth.

Each cell has a camera 60 to 100 cm above a table (straight, or tilted by 10 or 30 degrees) with a
lens of its own: focal length, k1, k2, tangential terms, and a principal point about 12 px off. A
chessboard (9 x 6, 25 mm) lies in four places and is held at a tilt in four more. The pictures are
rendered with lamp, blur, noise and JPEG of a webcam, and the package finds the corners.

With --boards FOLDER, the pictures left??.jpg and right??.jpg of a rig of two cameras (OpenCV's
samples): each picture in turn is the table, the others are held at a tilt. The pose of the right
camera in the left one is the same in all of them, and its scatter is compared with what is said.

    scripts/benchmark camera_place [--quick] [--json FILE] [--cells 34] [--seed 1]
                                   [--boards FOLDER]
"""

import argparse
from pathlib import Path
import sys

from camera_to_base.calibration.boards.placement import make_placement, PrintedBoard
from camera_to_base.calibration.camera_error import camera_error
from camera_to_base.calibration.pinhole import calibrate_pinhole
from camera_to_base.calibration.pinhole_fit import fit_pinhole
from camera_to_base.calibration.rigid_fit import align
from camera_to_base.errors import CameraToBaseError
from camera_to_base.surface import LensModel, MatchedPoints, SURFACE_DEFAULTS
from camera_to_base.surface.pinhole import pinhole_of_values
from camera_to_base.uncertainty import (
    CAMERA_COVARIANCE, camera_covariance, scales_at, SURFACE_COVARIANCE, surface_covariance,
    warp_design)
import cv2
import numpy as np
from rows import print_rows

SIZE = 1280, 720
TILTS_DEG = 0.0, 10.0, 30.0
BOARD = PrintedBoard()
# Where flat boards lie, as shares of half the picture.
SIDES = (-1, -1), (1, 1), (-1, 1), (1, -1)
HEIGHT_CM = 5.0
# Of the squared distance in units of the covariance, two dimensions.
CONTAINED = 4.605


def main():
    options = parse()
    rows = [] if options.boards else summaries(options)
    print_rows(rows or [rig(options.boards)], options.json)


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('--json')
    parser.add_argument('--cells', type=int, default=34)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--boards', type=Path)
    return parser.parse_args()


def summaries(options):
    for tilt_deg in TILTS_DEG:
        rng = np.random.default_rng([options.seed, int(tilt_deg)])
        cells = [checked_cell(rng, tilt_deg) for _ in range(1 if options.quick else options.cells)]
        found = [one for one in cells if one is not None]
        numbers = {name: np.array([one[name] for one in found]) for name in found[0]}
        yield {
            'camera': f'tilted by {tilt_deg:g} deg', 'cells': len(cells),
            'refused': len(cells) - len(found),
            'height %': spread(100 * numbers['height']), 'foot mm': spread(numbers['foot_mm']),
            'height within 1 %': share(numbers['height'] <= 0.01),
            'foot within 5 mm': share(numbers['foot_mm'] <= 5.0),
            'at the boards mm': spread(numbers['boards_mm']),
            'picture / boards': spread(numbers['picture_mm'] / numbers['boards_mm']),
            'squares / 2': round(float(np.mean(numbers['flat'])) / 2, 2),
            'in ellipses, z = 0': share(numbers['flat'] <= CONTAINED),
            f'in ellipses, z = {HEIGHT_CM:g} cm': share(numbers['raised'] <= CONTAINED),
            'height in 95 %': share(numbers['height_in']), 'warned': share(numbers['warned'])}


def spread(values):
    return ' / '.join(f'{value:.2f}' for value in (
        values.mean(), np.percentile(values, 95), values.max()))


def share(values):
    return round(float(np.mean(values)), 3)


class Cell:
    """A camera at the origin, and a table in front of it."""

    def __init__(self, rng, tilt_deg):
        width, height = SIZE
        focal = width * rng.uniform(0.75, 1.1)
        off = rng.normal(0, 12 / np.sqrt(2), 2)
        self.lens = LensModel(
            SIZE, (focal, focal), ((width - 1) / 2 + off[0], (height - 1) / 2 + off[1]),
            (rng.uniform(-0.25, 0.1), rng.uniform(-0.05, 0.1), *rng.normal(0, 0.001, 2), 0.0))
        axis = rng.uniform(0, 2 * np.pi)
        self.camera = rotation(np.radians(tilt_deg) * np.array([np.cos(axis), np.sin(axis), 0]))
        self.height_cm, self.rng = rng.uniform(60, 100), rng
        columns, rows = np.meshgrid(np.arange(width), np.arange(height))
        pixels = np.column_stack([columns.ravel(), rows.ravel()]).astype(float)
        self.rays = np.column_stack([self.lens.rays(pixels), np.ones(len(pixels))])
        self.grid = BOARD.further_points()
        self.grid = np.column_stack([self.grid - self.grid.mean(axis=0), np.zeros(len(self.grid))])

    def on_table(self, pixels):
        """Return where pixels show the table, shape (n, 2), from the foot point."""
        rays = np.column_stack([self.lens.rays(pixels), np.ones(len(pixels))]) @ self.camera
        return rays[:, :2] / rays[:, 2:] * self.height_cm

    def place(self, side):
        """Return rotation and middle of a board that lies towards a side, as far as it fits."""
        for out in np.arange(0.95, 0, -0.05):
            yaw = rotation([0, 0, self.rng.uniform(-0.3, 0.3)])
            middle = self.on_table(np.array(SIZE) / 2 * (1 + out * np.array([side])))[0]
            pose = self.camera @ yaw, self.camera @ [*middle, self.height_cm]
            if self.is_inside(pose):
                return pose
        raise ValueError('the picture is smaller than the board')

    def hold(self, number):
        """Return rotation and middle of a board that is held, tilted towards a side."""
        while True:
            tilt = np.radians(self.rng.uniform(15, 40))
            towards = np.pi / 2 * (0, 2, 1, 3)[number % 4] + self.rng.uniform(-0.4, 0.4)
            held = rotation(tilt * np.array([np.cos(towards), np.sin(towards), 0]))
            held = self.camera @ held @ rotation([0, 0, self.rng.uniform(-0.3, 0.3)])
            middle = self.on_table(np.array([SIZE]) * self.rng.uniform(0.25, 0.75, 2))[0]
            away = self.rng.uniform(0.6, 0.95)
            pose = held, away * self.camera @ [*middle, self.height_cm]
            if self.is_inside(pose):
                return pose

    def is_inside(self, pose):
        """Tell whether the picture shows the board, with its white rim."""
        shown = self.lens.project(1.35 * self.grid @ pose[0].T + pose[1])
        return bool(np.all((shown > 4) & (shown < np.array(SIZE) - 5)))

    def picture(self, pose):
        """Render a board on a table: shape (h, w, 3), uint8, BGR."""
        across = self.rays @ pose[0]
        normal = pose[0].T @ pose[1]
        columns, rows = BOARD.corners
        square = BOARD.square_mm / 10
        with np.errstate(divide='ignore', invalid='ignore'):
            places = across[:, :2] / across[:, 2:] * normal[2] - normal[:2]
        places = places / square + (np.array([columns, rows]) + 1) / 2
        # The share of white in a pixel: a square wave that is blurred by the pixel's footprint.
        shape = SIZE[1], SIZE[0]
        width = np.maximum(np.abs(np.gradient(places.reshape(*shape, 2), axis=1)).sum(axis=2),
                           np.abs(np.gradient(places.reshape(*shape, 2), axis=0)).sum(axis=2))
        wave = [np.clip(distance(places[:, axis]).reshape(shape) / width, -0.5, 0.5)
                for axis in range(2)]
        white = 0.5 + 2 * wave[0] * wave[1]
        inside = np.all((places > 0) & (places < [columns + 1, rows + 1]), axis=1).reshape(shape)
        rim = np.all((places > -1) & (places < [columns + 2, rows + 2]), axis=1).reshape(shape)
        light = np.where(inside, 0.08 + 0.72 * white, np.where(rim, 0.8, 0.35))
        lamp = self.rng.uniform(0.75, 1.0, 4)
        light = light * cv2.resize(lamp.reshape(2, 2), SIZE)
        light = cv2.GaussianBlur(light, (0, 0), self.rng.uniform(0.5, 1.0))
        levels = 255 * light ** (1 / 2.2) + self.rng.normal(0, self.rng.uniform(1, 3), shape)
        grey = np.clip(levels.round(), 0, 255).astype(np.uint8)
        jpeg = cv2.imencode('.jpg', grey, [cv2.IMWRITE_JPEG_QUALITY, 90])[1]
        return cv2.imdecode(jpeg, cv2.IMREAD_COLOR)


def distance(places):
    """Return how far places are from the next line of a grid, with alternating sign."""
    nearest = np.round(np.nan_to_num(places, nan=-9.0, posinf=-9.0, neginf=-9.0))
    return (places - nearest) * np.where(nearest % 2, -1.0, 1.0)


def rotation(vector):
    return cv2.Rodrigues(np.array(vector, float))[0]


def checked_cell(rng, tilt_deg):
    """Return the figures of a cell; None where pictures were refused, which is printed."""
    try:
        return cell(rng, tilt_deg)
    except CameraToBaseError as error:
        print(f'at {tilt_deg:g} deg: {error}', file=sys.stderr)
        return None


def cell(rng, tilt_deg):
    """Calibrate one cell as the command does, and compare it with the truth."""
    truth = Cell(rng, tilt_deg)
    poses = [*map(truth.place, SIDES), *map(truth.hold, range(4))]
    seen = [make_placement(BOARD, truth.picture(pose), f'picture {number}', number)
            for number, pose in enumerate(poses)]
    flat = seen[:len(SIDES)]
    found = calibrate_pinhole(BOARD, flat, seen[len(SIDES):], 'rendered')
    values = {**SURFACE_DEFAULTS, **found.values}
    surface = pinhole_of_values(values)
    # The first placement defines the frame: where its corners truly are.
    first = flat[0].matched
    true_first = truth.on_table(first.pixels)
    frame = frame_of(true_first, first.points)
    at_boards = np.concatenate([one.matched.pixels for one in flat])
    columns, rows = np.meshgrid(*(np.linspace(10, size - 11, count)
                                  for size, count in zip(SIZE, (16, 9))))
    picture = np.column_stack([columns.ravel(), rows.ravel()])
    error_mm = [10 * np.linalg.norm(surface.locate(pixels) - frame(truth.on_table(pixels)), axis=1)
                for pixels in (at_boards, picture)]
    place, foot = surface.camera_place, frame(np.zeros((1, 2)))[0]
    camera = found.report['camera']
    spots = picture[rng.choice(len(picture), 8, replace=False)]
    return {
        'height': abs(place.height_cm / truth.height_cm - 1),
        'height_in': abs(place.height_cm - truth.height_cm) <= camera['height_cm_95'],
        'foot_mm': 10 * np.linalg.norm(place.foot_cm - foot),
        'boards_mm': root_mean_square(error_mm[0]), 'picture_mm': root_mean_square(error_mm[1]),
        'flat': squares(values, surface, truth, frame, spots, 0.0),
        'raised': squares(values, surface, truth, frame, spots, HEIGHT_CM),
        'warned': bool(found.report['warnings'])}


def frame_of(there, here):
    """Return a function that takes points of the table, shape (n, 2), to the camera frame."""
    turn, shift = align(raised(there), raised(here))
    return lambda points: (raised(points) @ turn.T + shift)[:, :2]


def raised(points):
    return np.column_stack([points, np.zeros(len(points))])


def root_mean_square(values):
    return float(np.sqrt(np.mean(values ** 2)))


def squares(values, surface, truth, frame, spots, height_cm):
    """Return the squared errors of raised points, in units of the said covariance."""
    share = height_cm / truth.height_cm
    # The ray to a pixel, cut at a height.
    true = frame(truth.on_table(spots) * (1 - share))
    place = surface.camera_place
    seen, foot, own = surface.locate(spots), np.array(place.foot_cm), height_cm / place.height_cm
    errors = foot + (seen - foot) * (1 - own) - true
    moves = scales_at(surface, spots) @ warp_design(spots, SIZE, surface.distortion) * (1 - own)
    warp, camera = (matrix(values[name]) for name, matrix in (
        (SURFACE_COVARIANCE, surface_covariance), (CAMERA_COVARIANCE, camera_covariance)))
    found = []
    for error, move, spot in zip(errors, moves, seen):
        away = np.column_stack([np.eye(2), (spot - foot) / place.height_cm]) * own
        covariance = move @ warp @ move.T + away @ camera[:3, :3] @ away.T
        found.append(error @ np.linalg.solve(covariance, error))
    return found


def rig(folder):
    """Compare the pose of one camera of a rig in the other, from each pair of pictures."""
    names = sorted(path.name[4:] for path in folder.glob('left*.jpg'))
    looks = {side: found_boards(folder, side, names) for side in ('left', 'right')}
    both = [name for name in names if all(name in look for look in looks.values())]
    poses, errors, variances, off = [], [], [], []
    for name in both:
        pose = []
        for side, look in looks.items():
            others = [matched for other, matched in look.items() if other != name]
            fit = fit_pinhole([look[name]], others, (640, 480))
            pose.append(fit.surface)
            errors.append(camera_error(fit).place[:3, :3])
            off.append(100 * np.linalg.norm(
                fit.surface.locate(look[name].pixels) - fit.placed[0], axis=1).mean()
                / np.ptp(look[name].points[:, 0]))
        left, right = pose
        turn = left.optical_from_camera
        variances.append(np.diag(turn @ (errors[-1] + errors[-2]) @ turn.T))
        # Where the right camera is, as the left one sees it.
        poses.append(turn @ (right.position_cm - left.position_cm))
    found = np.array(poses)
    said = np.sqrt(np.mean(variances, axis=0))
    return {'pairs': len(both),
            'right camera in the left one, cm': found.mean(axis=0).round(3).tolist(),
            'scatter cm': found.std(axis=0, ddof=1).round(3).tolist(),
            'said cm': said.round(3).tolist(),
            'corners off, % of the width': round(float(np.mean(off)), 4)}


def found_boards(folder, side, names):
    found = {}
    for name in names:
        try:
            look = BOARD.find(cv2.imread(str(folder / (side + name))))
        except CameraToBaseError as error:
            print(f'{side}{name}: {error}')
            continue
        found[name] = MatchedPoints(BOARD.further_points()[look.numbers], look.pixels)
    return found


if __name__ == '__main__':
    main()
