# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The least-squares problem of a pinhole camera that sees a board flat on the table and tilted."""

from typing import List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.calibration.homography_fit import moved, plane_motion
from camera_to_base.checks import ImageSize
from camera_to_base.surface import LensModel, MatchedPoints, PinholeSurface
import cv2
import numpy as np

# Numbers of a lens of plumb_bob that is fitted: logarithm of the focal length, which keeps it
# positive; centre; coefficients.
FOCAL, CENTRE, COEFFICIENTS = 0, slice(1, 3), slice(3, 8)
_FOCAL_LIMITS = np.log([1.0, 1e6])
LENS_NUMBERS, POSE_NUMBERS, BEND_NUMBERS, MOTION_NUMBERS = 8, 6, 3, 3
# What is expected before anything is measured: a centre within 0.03 halves of the picture's
# diagonal (22 px of 1280 x 720), and coefficients k1 k2 p1 p2 k3 of usual lenses.
_EXPECTED_CENTRE = 0.03
EXPECTED_COEFFICIENTS = (0.5, 0.5, 0.01, 0.01, 0.5)
# How far paper on a plate is from flat between its middle and its rim, in cm.
EXPECTED_BEND_CM = 0.03
# How far a printed corner is from where it should be, in cm: 26 real pictures say 0.005 to 0.009.
EXPECTED_CORNER_CM, _LEAST_CORNER_CM, _MOST_CORNER_CM = 0.007, 0.0005, 0.02
# The usual error of a corner's coordinate, in pictures of this width.
_EXPECTED_PX, _USUAL_WIDTH = 0.1, 1280


def expected_px(image_size: ImageSize) -> float:
    """Return the usual error of a corner's coordinate, in px."""
    return _EXPECTED_PX * max(image_size[0] / _USUAL_WIDTH, 0.5)


class Shown(NamedTuple):
    """
    Where a lens shows points, and how this changes.

    :param pixels: Shape (n, 2).
    :param by_point: Shape (n, 2, 3), by a move of the point in the optical frame, in px for a cm.
    :param by_lens: Shape (n, 2, 8), by the lens's numbers.
    """

    pixels: np.ndarray
    by_point: np.ndarray
    by_lens: np.ndarray


def lens_of(numbers: np.ndarray, image_size: ImageSize) -> LensModel:
    """Make the lens of its numbers, shape (8,): log of focal length, centre, k1 k2 p1 p2 k3."""
    focal = float(np.exp(np.clip(numbers[FOCAL], *_FOCAL_LIMITS)))
    return LensModel(image_size, (focal, focal), tuple(numbers[CENTRE]),
                     tuple(numbers[COEFFICIENTS]) if numbers[COEFFICIENTS].any() else ())


def shown_by(lens: LensModel, points: np.ndarray) -> Shown:
    """
    Project points, with derivatives.

    :param points: Shape (n, 3), in the optical frame, in cm.
    """
    nothing, count = np.zeros(3), len(points)
    coefficients = np.array(lens.coefficients or (0.0,) * 5)
    if lens.model == 'equidistant':
        pixels, slopes = cv2.fisheye.projectPoints(
            points[:, None], nothing, nothing, lens.matrix, coefficients)
        moves, own = slopes[:, 11:14], slopes[:, :4]
    else:
        pixels, slopes = cv2.projectPoints(
            points, nothing, nothing, lens.matrix, coefficients)
        moves, own = slopes[:, 3:6], slopes[:, 6:15]
    by_lens = np.zeros((2 * count, LENS_NUMBERS))
    by_lens[:, FOCAL], by_lens[:, CENTRE] = own[:, :2] @ lens.focal, own[:, 2:4]
    if lens.model == 'plumb_bob':
        by_lens[:, COEFFICIENTS] = own[:, 4:9]
    return Shown(pixels.reshape(count, 2), moves.reshape(count, 2, 3),
                 by_lens.reshape(count, 2, LENS_NUMBERS))


class _Pose(NamedTuple):
    """A rotation matrix (3, 3), its change by the rotation vector (3, 3, 3), and the shift."""

    matrix: np.ndarray
    slopes: np.ndarray
    shift: np.ndarray

    @classmethod
    def of(cls, numbers: np.ndarray) -> '_Pose':
        """Make it of a rotation vector and a shift, shape (6,)."""
        matrix, slopes = cv2.Rodrigues(np.ascontiguousarray(numbers[:3], float))
        return cls(matrix, slopes.reshape(3, 3, 3), numbers[3:])

    def points(self, points: np.ndarray) -> np.ndarray:
        """Take them to the optical frame, shape (n, 3)."""
        return points @ self.matrix.T + self.shift

    def by_pose(self, points: np.ndarray) -> np.ndarray:
        """Return how the points move by the pose's numbers, shape (n, 3, 6)."""
        slopes = np.empty((len(points), 3, POSE_NUMBERS))
        slopes[:, :, :3] = np.einsum('kij,nj->nik', self.slopes, points)
        slopes[:, :, 3:] = np.eye(3)
        return slopes


class PinholeProblem:
    """
    The least-squares problem.

    Its numbers: the lens (8, some of them fixed), the pose of the camera frame in the optical
    frame (6), how the board is bent along its x, its y, and twisted (3), how far each of its
    corners is from where it should be (3 each), the turn and the shift on the table of each flat
    placement but the first (3), and the pose of each board that is held at a tilt (6).

    :param flat: The points of each flat placement, in its own coordinates; those of the first are
        the camera frame's. At least one.
    :param tilted: The same of the boards held at a tilt, each in the board's coordinates.
    :param free: Which of the coefficients k1 k2 p1 p2 k3 are fitted.
    :param known: The lens, if it is known; then none of its numbers is fitted.
    :param corners: Which of the board's corners the points of each board are, shape (n,) each;
        None where the board is as it should be.
    :param corner_cm: Standard deviation of a corner's place on the board.
    """

    def __init__(
        self, flat: Sequence[MatchedPoints], tilted: Sequence[MatchedPoints],
        image_size: ImageSize, free: Sequence[int] = (), known: Optional[LensModel] = None,
        corners: Optional[Sequence[np.ndarray]] = None, corner_cm: float = EXPECTED_CORNER_CM,
    ) -> None:
        self.image_size, self.known, self._free = tuple(image_size), known, tuple(free)
        self.boards = [*flat, *tilted]
        self.flat_count = len(flat)
        self._pixels = np.concatenate([board.pixels for board in self.boards])
        self.rows = self._rows_of_boards()
        width, height = image_size
        self._middle = np.array([(width - 1) / 2, (height - 1) / 2])
        self.free_lens = np.array([], int) if known is not None else np.array(
            [FOCAL, 1, 2, *(COEFFICIENTS.start + index for index in free)])
        self.pose_at = len(self.free_lens)
        self._corners, self._corner_cm = corners, corner_cm
        self._corner_count = 0 if corners is None else 1 + max(int(one.max()) for one in corners)
        self._first_turn = _turn_of_first(self.boards, corners)
        self.size = (self.shared.stop + MOTION_NUMBERS * (len(flat) - 1)
                     + POSE_NUMBERS * len(tilted))
        self._shapes = [_bends(board.points) for board in self.boards]

    def with_corners(
        self, corners: Optional[Sequence[np.ndarray]], corner_cm: float = EXPECTED_CORNER_CM
    ) -> 'PinholeProblem':
        """Return the problem whose board is printed so exactly."""
        return PinholeProblem(
            self.boards[:self.flat_count], self.boards[self.flat_count:], self.image_size,
            self._free, self.known, corners, corner_cm)

    @property
    def shared(self) -> slice:
        """The numbers that flat placements share: lens, the table's pose, the board's shape."""
        return slice(0, self._corners_at + 3 * self._corner_count)

    @property
    def camera(self) -> slice:
        """The numbers of the camera: lens, and the table's pose."""
        return slice(0, self.pose_at + POSE_NUMBERS)

    @property
    def _corners_at(self) -> int:
        return self.camera.stop + BEND_NUMBERS

    def bend_cm(self, numbers: np.ndarray) -> np.ndarray:
        """Return the bend along x and y, and the twist, between middle and rim, shape (3,)."""
        return numbers[self.camera.stop:self._corners_at]

    def printed_cm(self, numbers: np.ndarray, covariance: np.ndarray) -> float:
        """Return how far corners are from where they should be: the standard deviation."""
        corners = slice(self._corners_at, self.shared.stop)
        squares = (numbers ** 2 + np.diag(covariance))[corners].reshape(-1, 3)
        # Heights are less certain: pictures that are hardly tilted do not tell them.
        return float(np.clip(np.sqrt(squares[:, :2].mean()), _LEAST_CORNER_CM, _MOST_CORNER_CM))

    def own(self, board: int) -> slice:
        """Return which numbers are a board's own; none for the first one."""
        start = self.shared.stop + MOTION_NUMBERS * max(min(board, self.flat_count) - 1, 0)
        if board < self.flat_count:
            return slice(start, start + (MOTION_NUMBERS if board else 0))
        start += POSE_NUMBERS * (board - self.flat_count)
        return slice(start, start + POSE_NUMBERS)

    def pose_of(self, board: int) -> slice:
        """Return which numbers are a board's pose: the table's for a flat placement."""
        if board < self.flat_count:
            return slice(self.pose_at, self.pose_at + POSE_NUMBERS)
        return self.own(board)

    def lens(self, numbers: np.ndarray) -> LensModel:
        """Return the lens."""
        if self.known is not None:
            return self.known
        values = np.zeros(LENS_NUMBERS)
        values[self.free_lens] = numbers[:self.pose_at]
        return lens_of(values, self.image_size)

    def table_pose(self, numbers: np.ndarray) -> np.ndarray:
        """Return the camera frame's rotation vector and shift in the optical frame, (6,)."""
        return numbers[self.pose_at:self.pose_at + POSE_NUMBERS]

    def surface(self, numbers: np.ndarray) -> PinholeSurface:
        """Return the camera over the surface."""
        pose = self.table_pose(numbers)
        matrix = cv2.Rodrigues(np.ascontiguousarray(pose[:3]))[0]
        return PinholeSurface(self.lens(numbers), pose[:3], -matrix.T @ pose[3:])

    def placed(self, numbers: np.ndarray, board: int) -> np.ndarray:
        """Return where a flat placement's points lie in the camera frame, shape (n, 2)."""
        points = self._printed(numbers, board)[:, :2]
        return moved(points, numbers[self.own(board)]) if board else points

    def residuals(self, numbers: np.ndarray) -> np.ndarray:
        """Return shown minus measured pixels, shape (2 n,)."""
        lens = self.lens(numbers)
        shown = [shown_by(lens, self._pose(numbers, board).points(self._points(numbers, board)))
                 .pixels for board in range(len(self.boards))]
        return (np.concatenate(shown) - self._pixels).ravel()

    def jacobian(self, numbers: np.ndarray) -> np.ndarray:
        """Return the derivative of :meth:`residuals`, shape (2 n, size)."""
        lens, slopes = self.lens(numbers), np.zeros((2 * len(self._pixels), self.size))
        for board, rows in enumerate(self.rows):
            pose, points = self._pose(numbers, board), self._points(numbers, board)
            shown = shown_by(lens, pose.points(points))
            by_pose = (shown.by_point @ pose.by_pose(points)).reshape(-1, POSE_NUMBERS)
            slopes[rows, :self.pose_at] = shown.by_lens.reshape(-1, LENS_NUMBERS)[
                :, self.free_lens]
            slopes[rows, self.pose_of(board)] = by_pose
            lift = (shown.by_point @ pose.matrix[:, 2])[:, :, None] * self._shapes[board][:, None]
            slopes[rows, self.camera.stop:self._corners_at] = lift.reshape(-1, BEND_NUMBERS)
            if self._corners is not None:
                self._by_corners(slopes, numbers, board, shown.by_point @ pose.matrix)
            if 0 < board < self.flat_count:
                slopes[rows, self.own(board)] = self._by_motion(numbers, board, shown, pose)
        return slopes

    def by_lens(self, numbers: np.ndarray) -> np.ndarray:
        """Return how the pixels move by the numbers of the lens, known or not, (2 n, 8)."""
        lens = self.lens(numbers)
        return np.concatenate([
            shown_by(lens, self._pose(numbers, board).points(self._points(numbers, board))).by_lens
            for board in range(len(self.boards))]).reshape(-1, LENS_NUMBERS)

    def by_motion_of_first(self, numbers: np.ndarray) -> np.ndarray:
        """Return how the first placement's pixels move if it is shifted and turned, (2 n, 3)."""
        pose = self._pose(numbers, 0)
        shown = shown_by(self.lens(numbers), pose.points(self._points(numbers, 0)))
        return self._by_motion(numbers, 0, shown, pose)

    def prior(self) -> Tuple[np.ndarray, np.ndarray]:
        """Return the expected value and the standard deviation of the numbers; inf for none."""
        deviations, expected = np.full(self.size, np.inf), np.zeros(self.size)
        self.bend_cm(deviations)[:] = EXPECTED_BEND_CM
        deviations[self._corners_at:self.shared.stop] = self._corner_cm
        if self.known is None:
            half_diagonal = float(np.hypot(*self.image_size)) / 2
            spread = np.array([np.inf, *2 * [_EXPECTED_CENTRE * half_diagonal],
                               *EXPECTED_COEFFICIENTS])
            deviations[:self.pose_at] = spread[self.free_lens]
            expected[1:3] = self._middle
        return expected, deviations

    def _rows_of_boards(self) -> List[slice]:
        ends = 2 * np.cumsum([0, *map(len, self.boards)])
        return [slice(start, end) for start, end in zip(ends, ends[1:])]

    def _pose(self, numbers: np.ndarray, board: int) -> _Pose:
        return _Pose.of(numbers[self.pose_of(board)])

    def _points(self, numbers: np.ndarray, board: int) -> np.ndarray:
        points = self._printed(numbers, board)
        points[:, 2] += self._shapes[board] @ self.bend_cm(numbers)
        if board < self.flat_count:
            points[:, :2] = self.placed(numbers, board)
        return points

    def _printed(self, numbers: np.ndarray, board: int) -> np.ndarray:
        """Return where the corners are in the board's coordinates but for its bend, (n, 3)."""
        points = np.column_stack([self.boards[board].points, np.zeros(len(self.boards[board]))])
        if self._corners is None:
            return points
        off = numbers[self._corners_at:self.shared.stop].reshape(-1, 3)[self._corners[board]]
        return points + (off if board else off @ self._first_turn.T)

    def _by_corners(
        self, slopes: np.ndarray, numbers: np.ndarray, board: int, by_own: np.ndarray
    ) -> None:
        # How pixels move by the corners' places, by_own: in the coordinates of the table or board.
        turn = self._first_turn
        if 0 < board < self.flat_count:
            turn = _turned(numbers[self.own(board)][0])
        by_own = by_own @ turn if board < self.flat_count else by_own
        start = self._corners_at + 3 * self._corners[board]
        rows = np.arange(self.rows[board].start, self.rows[board].stop).reshape(-1, 2)
        slopes[rows[:, :, None], (start[:, None] + np.arange(3))[:, None]] = by_own

    def _by_motion(
        self, numbers: np.ndarray, board: int, shown: Shown, pose: _Pose
    ) -> np.ndarray:
        motion = numbers[self.own(board)] if board else np.zeros(MOTION_NUMBERS)
        turned = moved(self._printed(numbers, board)[:, :2],
                       np.array([motion[0] + np.pi / 2, 0.0, 0.0]))
        moves = np.zeros((len(turned), 3, MOTION_NUMBERS))
        moves[:, :2, 0], moves[:, 0, 1], moves[:, 1, 2] = turned, 1.0, 1.0
        return (shown.by_point @ pose.matrix @ moves).reshape(-1, MOTION_NUMBERS)


def _turned(angle: float) -> np.ndarray:
    return cv2.Rodrigues(np.array([0.0, 0.0, angle]))[0]


def _turn_of_first(
    boards: Sequence[MatchedPoints], corners: Optional[Sequence[np.ndarray]]
) -> np.ndarray:
    """Return how the first placement's coordinates are turned against the board's, (3, 3)."""
    for board, own in zip(boards[1:], (corners or ())[1:]):
        _, here, there = np.intersect1d(own, corners[0], return_indices=True)
        if len(here) > 1:
            return _turned(plane_motion(board.points[here], boards[0].points[there])[0])
    return np.eye(3)


def _bends(points: np.ndarray) -> np.ndarray:
    """Return the height of points on a board that is bent by 1 along x, y, and twisted, (n, 3)."""
    low, high = points.min(axis=0), points.max(axis=0)
    x, y = ((points - (low + high) / 2) / ((high - low) / 2)).T
    return np.column_stack([x * x, y * y, x * y])
