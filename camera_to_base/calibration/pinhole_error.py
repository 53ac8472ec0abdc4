# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
How far a fitted pinhole camera is off: what each board says that the fit has not seen.

Each board is left out in turn, and predicted from the others, up to where it lies. To first order
this follows from the equations of the fit to all. The prediction errors, relative to those that
corners with an error of 1 px would have, give the variance of a corner; a board with much larger
ones than the others does not belong to them.
"""

from typing import List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.calibration.pinhole_problem import expected_px, PinholeProblem, POSE_NUMBERS
from camera_to_base.uncertainty import pooled_variance
import numpy as np

# How many residuals the expected error of a corner is worth, and how many smooth ones; how many
# smooth shapes the errors of a board's corners may have that are no pose.
_FEW, _FEW_SMOOTH, _SMOOTH = 10.0, 2.0, 14
# A number that boards determine by this share of what all do is not determined by them.
_NOTHING = 1e-9


class BoardPart(NamedTuple):
    """
    What a board says of the shared numbers, whatever its own numbers are.

    :param design: Shape (m, s), how its pixels' coordinates move by the lens and the table's pose.
    :param residuals: Shape (m,), in px.
    :param freedom: How many of them are independent of the board's own numbers.
    """

    design: np.ndarray
    residuals: np.ndarray
    freedom: int


class BoardError(NamedTuple):
    """
    A board under the fit to the others.

    :param relative: Mean squared prediction error, relative to corners with an error of 1 px.
    :param errors: Shape (n, 2), of its corners that count, in px.
    :param freedom: Of how many independent numbers the errors are.
    """

    relative: float
    errors: np.ndarray
    freedom: int

    @property
    def rms_px(self) -> float:
        """Root of the mean squared prediction error of a coordinate, in px."""
        return float(np.sqrt(np.sum(self.errors ** 2) / self.freedom))


class FurtherNumbers(NamedTuple):
    """
    Numbers that would make the fit better.

    :param values: Shape (k,).
    :param gain: By how much each of them lessens the sum of squared residuals, in variances of a
        residual: about 1 for numbers that mean nothing.
    """

    values: np.ndarray
    gain: float


class PinholeEquations:
    """
    The linear equations of a fit, at its solution.

    :param numbers: The solution.
    :param kept: Shape (n,), which corners count.
    """

    def __init__(self, problem: PinholeProblem, numbers: np.ndarray, kept: np.ndarray) -> None:
        self._problem, self._numbers = problem, numbers
        self._rows = np.repeat(kept, 2)
        self._residuals = problem.residuals(numbers)
        self._jacobian = problem.jacobian(numbers)
        self.expected_px = expected_px(problem.image_size)
        self._basis, firsts = self._shared_basis()
        self.parts = [self._part(board, firsts) for board in range(len(problem.boards))]

    def left_out(self) -> List[BoardError]:
        """Predict each board from the others; a single one has the residuals of its own fit."""
        if len(self.parts) == 1:
            part, = self.parts
            square = float(part.residuals @ part.residuals)
            return [BoardError(
                square / part.freedom, part.residuals.reshape(-1, 2), part.freedom)]
        precision, slope = self._prior()
        normal = precision + sum(part.design.T @ part.design for part in self.parts)
        slope = slope + sum(part.design.T @ part.residuals for part in self.parts)
        return [_left_out(part, normal, slope) for part in self.parts]

    def variance(self, left_out: Sequence[BoardError]) -> float:
        """
        Return the variance of a corner's coordinate, in px².

        Where errors of neighbouring corners are alike (JPEG, a shadow, a board that moves), it is
        that of independent ones that move lens and pose as much.
        """
        freedom = np.array([part.freedom for part in self.parts], float)
        squares = float(sum(freedom * [one.relative for one in left_out]))
        alike = [self._alike(board) for board in range(len(self.parts))]
        return max(pooled_variance(squares, float(freedom.sum()), self.expected_px, _FEW),
                   pooled_variance(sum(alike), _SMOOTH * (len(alike) - 1), self.expected_px,
                                   _FEW_SMOOTH))

    def covariance(self, variance: float) -> np.ndarray:
        """Return the covariance of all numbers, shape (size, size)."""
        design = self._jacobian[self._rows]
        _, deviations = self._problem.prior()
        return variance * _inverse(design.T @ design + np.diag(variance / deviations ** 2))

    def further(self, columns: np.ndarray, expected: Sequence[float]) -> 'FurtherNumbers':
        """
        Estimate numbers that the fit does not have.

        :param columns: Shape (2 n, k), how the pixels' coordinates move by them.
        :param expected: Shape (k,), how large they may be: their standard deviations.
        """
        design = np.hstack([self._jacobian, columns])[self._rows]
        residuals, count = self._residuals[self._rows], columns.shape[1]
        _, deviations = self._problem.prior()
        precision = np.diag((self.expected_px / np.append(deviations, expected)) ** 2)
        inverse = _inverse(design.T @ design + precision)
        step = -inverse @ (design.T @ residuals)
        rest = residuals + design @ step
        # A picture that is wrong makes its own smooth errors large, and not those of most others.
        alike = float(np.median([self._alike(board) for board in range(len(self.parts))]))
        variance = max(float(rest @ rest) / max(len(rest) - design.shape[1], 1),
                       alike / _SMOOTH, (self.expected_px / 4) ** 2)
        found, own = step[-count:], inverse[-count:, -count:]
        return FurtherNumbers(found, float(found @ np.linalg.solve(own, found)) / count / variance)

    def _alike(self, board: int) -> float:
        """Return the sum of squares of the smooth part of a board's residuals, in px²."""
        rows = self._problem.rows[board]
        used, points = self._rows[rows], self._problem.boards[board].points
        x, y = (2 * (points - points.mean(axis=0)) / np.ptp(points, axis=0)).T
        shapes = np.column_stack([x * x, x * y, y * y, x ** 3, x * x * y, x * y * y, y ** 3])
        smooth = np.kron(shapes, np.eye(2))[used]
        # What a pose explains is none.
        axes = np.linalg.qr(self._jacobian[rows, self._problem.pose_of(board)][used])[0]
        axes = np.linalg.qr(smooth - axes @ (axes.T @ smooth))[0]
        return float(np.sum((axes.T @ self._residuals[rows][used]) ** 2))

    def _prior(self) -> Tuple[np.ndarray, np.ndarray]:
        expected, deviations = self._problem.prior()
        shared = self._problem.shared
        weights = (self.expected_px / deviations[shared]) ** 2
        slope = weights * (self._numbers - expected)[shared]
        return self._basis @ np.diag(weights) @ self._basis.T, self._basis @ slope

    def _shared_basis(self) -> Tuple[np.ndarray, np.ndarray]:
        """
        Return the moves of the shared numbers that are no shift or turn on the table.

        These would be the own numbers of the flat placements.
        """
        problem = self._problem
        firsts = problem.by_motion_of_first(self._numbers)
        start = problem.pose_at
        pose = self._jacobian[problem.rows[0], start:start + POSE_NUMBERS]
        scale = np.linalg.norm(pose, axis=0)
        on_table = np.linalg.lstsq(pose / scale, firsts, rcond=None)[0] / scale[:, None]
        others = np.linalg.svd((on_table / np.linalg.norm(on_table, axis=0)).T)[2][3:]
        basis = np.zeros((problem.shared.stop - 3, problem.shared.stop))
        basis[:start, :start] = np.eye(start)
        basis[start:start + 3, start:start + POSE_NUMBERS] = others
        basis[start + 3:, start + POSE_NUMBERS:] = np.eye(problem.shared.stop - start - 6)
        return basis, firsts

    def _part(self, board: int, firsts: np.ndarray) -> BoardPart:
        rows, shared = self._problem.rows[board], self._problem.shared
        used = self._rows[rows]
        own = firsts if board == 0 else self._jacobian[rows, self._problem.own(board)]
        axes = np.linalg.qr(own[used])[0]
        design = (self._jacobian[rows, shared] @ self._basis.T)[used]
        residuals = self._residuals[rows][used]
        return BoardPart(design - axes @ (axes.T @ design),
                         residuals - axes @ (axes.T @ residuals),
                         max(int(used.sum()) - own.shape[1], 1))


def _left_out(part: BoardPart, normal: np.ndarray, slope: np.ndarray) -> BoardError:
    # What the other boards do not determine, as the table of a single flat one, stays as it is.
    others = _inverse(normal - part.design.T @ part.design, np.diag(normal))
    step = -others @ (slope - part.design.T @ part.residuals)
    error = part.residuals + part.design @ step
    # (1 + A N^-1 A')^-1 = 1 - A (N + A'A)^-1 A', where N is of the others.
    along = part.design.T @ error
    square = float(error @ error - along @ _inverse(normal) @ along)
    return BoardError(square / part.freedom, error.reshape(-1, 2), part.freedom)


def _inverse(normal: np.ndarray, usual: Optional[np.ndarray] = None) -> np.ndarray:
    """
    Invert a positive definite matrix whose numbers have different units.

    :param usual: Its usual diagonal: numbers with next to nothing of it are left out.
    """
    diagonal = np.diag(normal)
    known = diagonal > _NOTHING * (diagonal if usual is None else usual)
    scale = np.where(known, 1 / np.sqrt(np.where(known, diagonal, 1.0)), 0.0)
    return scale[:, None] * np.linalg.pinv(
        normal * scale * scale[:, None], rcond=1e-13, hermitian=True) * scale
