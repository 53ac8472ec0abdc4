# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The surface computed anew from the corners of markers: which lie where they were, and the fit.

Blur and the camera's gamma make all markers of a picture look smaller by the same fraction of a
pixel: that inset is fitted, too.
"""

from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

from camera_to_base.checks import ImageSize
from camera_to_base.errors import CalibrationError, CameraToBaseError, InvalidValueError
from camera_to_base.markers.find import TABLE_MARKERS
from camera_to_base.parameters import ParameterSpec, Values
from camera_to_base.surface import (
    HomographySurface, LensModel, PinholeSurface, RadialDistortion, Surface)
from camera_to_base.uncertainty import HOMOGRAPHY_NUMBERS, pooled_variance, warp_design
import cv2
import numpy as np

# The usual error of a corner's coordinate, that of the lens's model included, in pictures of this
# width; and how many residuals it is worth.
_EXPECTED_PX, _USUAL_WIDTH, _EXPECTED_WORTH = 0.1, 1280, 10.0
_ROUNDS = 3

Corners = Dict[int, np.ndarray]
MarkerLens = Union[RadialDistortion, LensModel]

NUMBERS, CORNERS = 'markers.numbers', 'markers.corners_cm'
# With fewer, no surface is computed.
LEAST_MARKERS = 3
_COUNTS = tuple(range(LEAST_MARKERS, len(TABLE_MARKERS) + 1))
_LEAST_AREA = 1e-4

MARKER_SPECS = [
    ParameterSpec(NUMBERS, [],
                  'The numbers of the markers that lie on the surface; written by `calibrate '
                  'markers`. Empty for none.', (0, len(TABLE_MARKERS) - 1),
                  lengths=(0, *_COUNTS)),
    ParameterSpec(CORNERS, [],
                  'Where the corners of these markers lie, in the camera frame: x and y of each, '
                  'as it is printed from the top left clockwise, one marker after the other.',
                  (-10000, 10000), unit='cm', lengths=(0, *(8 * count for count in _COUNTS))),
]

# Focal lengths that are tried, in widths of the picture: from fish-eyes to telephoto lenses.
_FOCAL = np.geomspace(0.3, 10, 300)
# The calibrated view shows the calibrated place to this share of the height, or the two do not
# belong together.
_LARGEST_MISS = 0.2
UNKNOWN: Tuple[List[float], float] = ([], 0.0)

# A marker whose middle is seen this near to where the surface has it has not moved, and neither
# has the camera, in px of a picture 1280 px wide.
_IN_PLACE_PX = 1.0
# Residuals of markers that fit to each other stay below 0.29 px in simulation, lenses of other
# models included; a marker that was moved by 3 mm gives 0.3 px and more.
_FIT_PX = 0.3
# Without a marker that was moved by 1 mm, the others fit better by this factor in the median.
_BETTER_WITHOUT = 3.0
_LEAST_MOVE_CM = 0.1


class MarkerFit(NamedTuple):
    """
    A surface fitted to markers.

    :param surface: With the lens that was given.
    :param numbers: The markers that it was fitted to, n of them.
    :param pixels: Shape (4 n, 2), their corners in the picture, without the inset, in px.
    :param points: Shape (4 n, 2), their corners on the surface, in cm.
    :param gain: Shape (8, 8 n), how corners in px move the homography's numbers of the warp.
    :param rms_px: Root of the mean squared residual of a coordinate.
    :param variance: Of a corner's coordinate, in px².
    """

    surface: HomographySurface
    numbers: Tuple[int, ...]
    pixels: np.ndarray
    points: np.ndarray
    gain: np.ndarray
    rms_px: float
    variance: float


def fit_markers(
    known: Corners, seen: Corners, image_size: ImageSize, lens: MarkerLens
) -> MarkerFit:
    """
    Fit a surface to the markers that are both known and seen.

    With the whole lens of a pinhole camera, it is the camera's new pose that is fitted.

    :param known: By number, shape (4, 2), x and y, in cm, in the camera frame.
    :param seen: By number, shape (4, 2), u and v, in px.
    :raises CalibrationError: If no camera sees the markers so.
    """
    numbers = tuple(sorted(set(known) & set(seen)))
    points = np.concatenate([known[number] for number in numbers])
    pixels = np.concatenate([seen[number] for number in numbers])
    outwards = outward_moves(pixels)
    design = warp_design(pixels, image_size, lens)[:, :, :HOMOGRAPHY_NUMBERS]
    if isinstance(lens, LensModel):
        design = design @ _pose_warps(points, lens.undistort(pixels), image_size, lens)
    columns = np.concatenate([design, outwards[:, :, None]], axis=2)
    gain, inset = np.linalg.pinv(columns.reshape(-1, columns.shape[2])), 0.0
    for _ in range(_ROUNDS):
        surface = _surface(points, lens.undistort(pixels + inset * outwards), image_size, lens)
        residuals = surface.pixels(points) - pixels - inset * outwards
        inset += float(gain[-1] @ residuals.ravel())
    freedom = max(residuals.size - columns.shape[2], 1)
    squares = float(np.sum(residuals ** 2))
    expected = _EXPECTED_PX * scale_of(image_size)
    moves = gain[:-1]
    if isinstance(lens, LensModel):
        moves = _pose_warps(points, lens.undistort(pixels), image_size, lens) @ moves
    return MarkerFit(surface, numbers, pixels + inset * outwards, points, moves,
                     float(np.sqrt(squares / freedom)),
                     pooled_variance(squares, freedom, expected, _EXPECTED_WORTH))


def scale_of(image_size: ImageSize) -> float:
    """Return how much larger a length in px is than in a picture of the usual width."""
    return max(image_size[0] / _USUAL_WIDTH, 0.5)


def outward_moves(pixels: np.ndarray) -> np.ndarray:
    """
    Return how the corners of markers move if all their edges move outwards by 1 px.

    :param pixels: Shape (4 n, 2), clockwise as they are seen.
    :returns: The same shape.
    """
    quads = pixels.reshape(-1, 4, 2)
    sides = np.roll(quads, -1, axis=1) - quads
    normals = np.stack([sides[..., 1], -sides[..., 0]], axis=-1)
    normals /= np.linalg.norm(sides, axis=-1, keepdims=True)
    pairs = np.stack([np.roll(normals, 1, axis=1), normals], axis=-2)
    return np.linalg.solve(pairs, np.ones((*pairs.shape[:-1], 1)))[..., 0].reshape(-1, 2)


def _pose(points: np.ndarray, straight: np.ndarray, lens: LensModel) -> np.ndarray:
    """Return rotation vector and shift of the camera frame in the optical frame, shape (6,)."""
    view = (np.column_stack([points, np.zeros(len(points))]), straight, lens.matrix, np.zeros(4))
    poses = []
    for rotation, shift in zip(*cv2.solvePnPGeneric(*view, flags=cv2.SOLVEPNP_IPPE)[1:3]):
        rotation, shift = cv2.solvePnPRefineLM(*view, rotation, shift)
        off = cv2.projectPoints(view[0], rotation, shift, *view[2:])[0][:, 0] - straight
        poses.append((float(np.linalg.norm(off)), np.concatenate([rotation, shift]).ravel()))
    return min(poses, key=lambda one: one[0] if np.isfinite(one[0]) else np.inf)[1]


def _pose_warps(
    points: np.ndarray, straight: np.ndarray, image_size: ImageSize, lens: LensModel
) -> np.ndarray:
    """Return by which of the warp's eight numbers a pose's six move the picture, shape (8, 6)."""
    pose = _pose(points, straight, lens)
    board = np.column_stack([points, np.zeros(len(points))])
    shown, slopes = cv2.projectPoints(board, pose[:3], pose[3:], lens.matrix, np.zeros(4))
    plain = LensModel(image_size, lens.focal, lens.centre)
    design = warp_design(shown[:, 0], image_size, plain)[:, :, :HOMOGRAPHY_NUMBERS]
    return np.linalg.lstsq(
        design.reshape(-1, HOMOGRAPHY_NUMBERS), slopes[:, :6], rcond=None)[0]


def _surface(
    points: np.ndarray, straight: np.ndarray, image_size: ImageSize, lens: MarkerLens
) -> HomographySurface:
    try:
        if isinstance(lens, LensModel):
            pose = _pose(points, straight, lens)
            matrix = cv2.Rodrigues(pose[:3].copy())[0]
            surface = PinholeSurface(lens, pose[:3], -matrix.T @ pose[3:])
        else:
            homography, _ = cv2.findHomography(points, straight)
            surface = HomographySurface(np.linalg.inv(homography), image_size, lens)
        is_seen = bool(np.isfinite(surface.pixels(points)).all())
    except (TypeError, ValueError, cv2.error, InvalidValueError, np.linalg.LinAlgError):
        is_seen = False  # findHomography returns None where there is none
    if not is_seen:
        raise CalibrationError('no camera sees the markers where they are in the picture')
    return surface


def known_markers(values: Values) -> Corners:
    """
    Read the markers of a calibration from its parameters.

    :param values: By full name.
    :returns: By number, shape (4, 2), x and y, in cm; none is {}.
    :raises InvalidValueError: If the parameters do not belong together.
    """
    numbers, corners = values[NUMBERS], values[CORNERS]
    if numbers:
        refuse_polynomial(values)
    if 8 * len(numbers) != len(corners):
        raise InvalidValueError(
            f'{CORNERS} must be 8 numbers for each of {NUMBERS}, got {len(corners)} for '
            f'{len(numbers)}')
    found = {int(number): np.reshape(corners[8 * index:8 * index + 8], (4, 2)).astype(float)
             for index, number in enumerate(numbers)}
    if len(found) != len(numbers) or any(number % 1 for number in numbers):
        raise InvalidValueError(
            f'{NUMBERS} must be different whole numbers, got {list(numbers)}')
    for number, marker in found.items():
        if abs(_area(marker)) < _LEAST_AREA:
            raise InvalidValueError(f'{CORNERS}: marker {number} has no area')
    return found


def refuse_polynomial(values: Values) -> None:
    """
    Refuse a surface that cannot be computed anew.

    :raises InvalidValueError: If it is the polynomial, which no camera elsewhere has.
    """
    if values['surface.model'] == 'polynomial':
        raise InvalidValueError(
            'markers need surface.model homography or parallel: calibrate with calibrate board, '
            'or calibrate points without --model polynomial')


def marker_values(corners: Corners) -> Dict[str, Any]:
    """Give the parameters that :func:`known_markers` reads, rounded to a tenth of a micrometre."""
    numbers = sorted(corners)
    flat = np.concatenate([corners[number].ravel() for number in numbers])
    return {NUMBERS: [float(number) for number in numbers], CORNERS: flat.round(5).tolist()}


def _area(corners: np.ndarray) -> float:
    x, y = corners.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def moved_place(
    values: Values, calibrated: Surface, moved: HomographySurface
) -> Tuple[List[float], float]:
    """
    Return where a camera stands after a move: the point below it, and its height, in cm.

    :param values: The calibration's parameters, by full name, with the camera's height.
    :param calibrated: The flat surface of these parameters.
    :param moved: The surface after the move.
    :returns: UNKNOWN where it cannot be computed.
    """
    if not isinstance(calibrated, HomographySurface) or not values['surface.camera_foot_cm']:
        return UNKNOWN
    known = np.array([*values['surface.camera_foot_cm'], values['surface.camera_height_cm']])
    width = moved.image_size[0]
    misses = [_miss(calibrated, factor * width, known) for factor in _FOCAL]
    best = int(np.argmin(misses))
    if misses[best] > _LARGEST_MISS * known[2]:
        return UNKNOWN
    fine = _FOCAL[best] * np.linspace(0.98, 1.02, 41)
    focal = width * min(fine, key=lambda factor: _miss(calibrated, factor * width, known))
    x, y, height_cm = _place(moved, focal).tolist()
    return [round(x, 4), round(y, 4)], round(height_cm, 4)


def _miss(surface: HomographySurface, focal_px: float, known: np.ndarray) -> float:
    return float(np.linalg.norm(_place(surface, focal_px) - known))


def _place(surface: HomographySurface, focal_px: float) -> np.ndarray:
    """Return x and y of the foot point, and the height, for a focal length."""
    homography = np.linalg.inv(surface.surface_from_pixel)
    u, v = surface.distortion.centre
    camera = np.array([[focal_px, 0, u], [0, focal_px, v], [0, 0, 1]])
    first, second, third = np.linalg.solve(camera, homography).T
    scale = np.sqrt(np.linalg.norm(first) * np.linalg.norm(second))
    along_x, along_y, displacement = first / scale, second / scale, third / scale
    normal = np.cross(along_x, along_y)
    return np.array([-along_x @ displacement, -along_y @ displacement,
                     abs(normal @ displacement)])


class MarkerVerdict(NamedTuple):
    """
    What the markers of a picture say.

    :param in_place: The markers that are seen where the surface in use has them.
    :param moved: Those that were moved on the table.
    :param fit: The surface by the markers, where the camera stands elsewhere; None where the
        surface in use holds, or where it cannot be told.
    :param trouble: Why it cannot be told, a sentence; '' where it can.
    """

    in_place: Tuple[int, ...] = ()
    moved: Tuple[int, ...] = ()
    fit: Optional[MarkerFit] = None
    trouble: str = ''


def judge_markers(
    known: Corners, shown: Corners, seen: Corners, image_size: ImageSize,
    lens: MarkerLens, *, tolerance_px: float = 0.0,
) -> MarkerVerdict:
    """
    Compare the markers of a picture with the surface in use.

    :param known: By number, shape (4, 2), in cm, at least three.
    :param shown: The same, in px, where the surface in use has them; NaN where it does not.
    :param seen: By number, shape (4, 2), in px.
    :param tolerance_px: By how much more than usual markers in place may be seen elsewhere.
    """
    seen = {number: corners for number, corners in seen.items() if number in known}
    if not seen:
        return MarkerVerdict(trouble='no marker is seen')
    near, limit_px = [], _IN_PLACE_PX * scale_of(image_size) + tolerance_px
    for number, corners in seen.items():
        shift = corners.mean(axis=0) - shown[number].mean(axis=0)
        if np.linalg.norm(shift) <= limit_px:  # not so for NaN
            near.append(number)
    away = tuple(sorted(set(seen) - set(near)))
    if not away or len(near) >= LEAST_MARKERS:
        return MarkerVerdict(tuple(sorted(near)), away)
    if len(seen) < LEAST_MARKERS or len(seen) == LEAST_MARKERS == len(near) + 1:
        verb = 'is' if len(away) == 1 else 'are'
        return MarkerVerdict(tuple(sorted(near)), trouble=(
            f'{names_of(away)} {verb} not where the calibration has it, and only {len(seen)} of '
            f'{len(known)} markers are seen'))
    return _fitted(known, seen, image_size, lens)


def _fitted(
    known: Corners, seen: Corners, image_size: ImageSize, lens: MarkerLens
) -> MarkerVerdict:
    limit_px = _FIT_PX * scale_of(image_size)
    try:
        everything = fit_markers(known, seen, image_size, lens)
        others = _best_without_one(known, seen, image_size, lens)
        if others is not None and others.rms_px * _BETTER_WITHOUT < everything.rms_px:
            number, = set(seen) - set(others.numbers)
            has_moved = _shift_cm(known, seen, number, others) >= _LEAST_MOVE_CM
            if has_moved and others.rms_px <= limit_px:
                return MarkerVerdict(moved=(number,), fit=others)
    except CameraToBaseError as error:
        return MarkerVerdict(trouble=str(error))
    if everything.rms_px <= limit_px:
        return MarkerVerdict(fit=everything)
    return MarkerVerdict(trouble=(
        f'{names_of(everything.numbers)} do not lie to each other as they did, by '
        f'{everything.rms_px:.1f} px: one was moved, or the paper is not flat'))


def _best_without_one(
    known: Corners, seen: Corners, image_size: ImageSize, lens: MarkerLens
) -> Optional[MarkerFit]:
    """Return the best fit to all markers but one; None where too few are left."""
    if len(seen) <= LEAST_MARKERS:
        return None
    fits = [fit_markers(known, {number: corners for number, corners in seen.items()
                                if number != left_out}, image_size, lens) for left_out in seen]
    return min(fits, key=lambda fit: fit.rms_px)


def _shift_cm(known: Corners, seen: Corners, number: int, fit: MarkerFit) -> float:
    there = fit.surface.locate(seen[number]).mean(axis=0)
    return float(np.linalg.norm(there - known[number].mean(axis=0)))


def names_of(numbers: Sequence[int]) -> str:
    """Give the names of markers for a sentence."""
    names = ', '.join(map(str, numbers))
    return f'marker {names}' if len(numbers) == 1 else f'markers {names}'
