# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Checks whether pictures of a board belong to one board, one lens and one table."""

from typing import Any, Dict, Iterator, List, NamedTuple, Sequence

from camera_to_base.calibration.figures import MM_PER_CM
from camera_to_base.calibration.pinhole_fit import PinholeFit
from camera_to_base.calibration.pinhole_problem import expected_px
from camera_to_base.errors import CalibrationError
import numpy as np

# A board's prediction error that is refused: so many usual errors, and times that of the others;
# and one that is named. Boards of simulated cells stay below 1.5 times.
_REFUSED_EXPECTED, _REFUSED_FACTOR = 6.0, 4.0
_DOUBTED_EXPECTED, _DOUBTED_FACTOR = 3.0, 2.5
# Of a picture's corners, so many may be bad ones.
_MOST_BAD = 0.1
# A fault explains the residuals if each of its numbers lessens their squares by so many variances.
DOUBTED_GAIN, REFUSED_GAIN, _CLEAR_GAIN = 12.0, 22.0, 500.0
# How large faults may be: standard deviations of a zoom, and of a centre in widths of the picture.
_ZOOM, _SHIFT = 0.2, 0.05
# A fault is harmful from these sizes on.
_HARMFUL_ZOOM, _HARMFUL_SHIFT = 0.01, 0.01
# A bend is fitted; one of this size is told, and refused. A board of 26 real pictures has 0.2 mm.
_DOUBTED_BEND_MM, _REFUSED_BEND_MM = 0.6, 1.2
# Half widths of 95 % from which on heights of objects are worse than a ruler's.
_DOUBTED_HEIGHT, _DOUBTED_FOOT = 0.02, 0.02
TILT_MORE = ('tilt the board by about 30 degrees, and towards another side in each picture: left, '
             'right, near and far')


def check_boards(fit: PinholeFit, names: Sequence[str]) -> List[str]:
    """
    Check that the pictures belong together.

    Several faults make all pictures fit worse. Each is tried as an explanation, to first order:
    the one that explains most is named.

    :param names: Of the pictures, the flat ones first.
    :returns: Sentences about what is doubtful.
    :raises CalibrationError: If a picture does not belong to the others, the board is bent, or
        the zoom was changed.
    """
    explanations = _explanations(fit, names)
    likely = max(explanations, key=lambda one: one.gain, default=None)
    if likely is None or likely.gain < DOUBTED_GAIN or not likely.is_harmful:
        return [*_bend(fit), *(_worst(fit, names) if len(names) > 1 else ()),
                *_bad_corners(fit, names)]
    if fit.problem.known is not None:
        # Through another camera's lens, a flat board looks bent.
        return [likely.sentence]
    # A bent board makes single pictures misfit, too, but less than another board does.
    bend = [] if likely.gain > _CLEAR_GAIN else _bend(fit)
    if likely.gain > REFUSED_GAIN:
        raise CalibrationError(likely.sentence)
    return [*bend, likely.sentence]


class Explanation(NamedTuple):
    """
    A fault that would explain residuals.

    :param gain: See `FurtherNumbers`.
    :param is_harmful: Whether it is large enough to matter.
    """

    gain: float
    sentence: str
    is_harmful: bool


def _explanations(fit: PinholeFit, names: Sequence[str]) -> Iterator[Explanation]:
    problem, everything = fit.problem, range(len(names))
    slopes = problem.by_lens(fit.numbers)[:, :3]
    if problem.known is not None:
        yield _other_lens(fit, slopes, everything, (
            'the intrinsics contradict the board, by {}: are they those of this camera, at this '
            'zoom and focus, and is the picture not rectified?'))
        return
    if problem.flat_count < len(names):
        yield _other_lens(fit, slopes, everything[problem.flat_count:], (
            'the tilted pictures have another lens than the flat ones, by {}: was the zoom or the '
            'focus changed, or are the pictures mirrored? Take all again, with the zoom fixed and '
            'autofocus off'))
    for board in everything:
        yield _other_lens(fit, slopes, [board], (
            f'{names[board]} does not fit the other pictures, by {{}}: was the board moved while '
            'it was taken, is it mirrored, of another zoom, or of another board? Take it again, '
            'or leave it out'))


def _other_lens(
    fit: PinholeFit, slopes: np.ndarray, boards: Sequence[int], text: str
) -> Explanation:
    """Give some pictures a focal length and a centre of their own."""
    problem, columns = fit.problem, np.zeros_like(slopes)
    for board in boards:
        columns[problem.rows[board]] = slopes[problem.rows[board]]
    width = problem.image_size[0]
    found = fit.equations.further(columns, [_ZOOM, _SHIFT * width, _SHIFT * width])
    zoom, shift_px = found.values[0], float(np.linalg.norm(found.values[1:]))
    return Explanation(
        found.gain, text.format(f'{100 * abs(zoom):.1f} % of the focal length and {shift_px:.0f} '
                                'px of the centre'),
        bool(abs(zoom) > _HARMFUL_ZOOM or shift_px > _HARMFUL_SHIFT * width))


def check_place(report: Dict[str, Any], is_known: bool) -> List[str]:
    """
    Check that the camera's place is exact enough for heights.

    :param report: The field `camera`, see :class:`CameraError`.
    :param is_known: Whether the lens was known.
    """
    height, foot = report['height_cm_95'], report['foot_cm_95']
    if max(height / _DOUBTED_HEIGHT, foot / _DOUBTED_FOOT) <= report['height_cm']:
        return []
    cure = 'lay the board in more places' if is_known else TILT_MORE
    return [f"the camera's height is known to {height:.1f} cm and its foot point to {foot:.1f} cm "
            f'only, so that positions of objects with a height are less exact: {cure}']


def _worst(fit: PinholeFit, names: Sequence[str]) -> List[str]:
    errors = np.sqrt([one.relative for one in fit.left_out])
    worst, unit = int(np.argmax(errors)), expected_px(fit.problem.image_size)
    usual = float(np.median(np.delete(errors, worst))) if len(errors) > 1 else unit
    is_tilted = worst >= fit.problem.flat_count
    text = (f'{names[worst]} does not fit the other pictures: it is off by {errors[worst]:.1f} px '
            f'rms where the others are off by {usual:.1f} px: '
            + ('was the board or the camera moved while it was taken, is it mirrored, of another '
               'board or another zoom' if is_tilted else
               'was the camera moved between the pictures, is the board not flat on the table, or '
               'the picture mirrored or of another board')
            + '? Take it again, or leave it out')
    if errors[worst] > max(_REFUSED_EXPECTED * unit, _REFUSED_FACTOR * usual):
        raise CalibrationError(text)
    return [text] if errors[worst] > max(_DOUBTED_EXPECTED * unit, _DOUBTED_FACTOR * usual) else []


def _bad_corners(fit: PinholeFit, names: Sequence[str]) -> List[str]:
    doubts = []
    for board, name in enumerate(names):
        kept = fit.kept_of(board)
        bad = int((~kept).sum())
        if bad > _MOST_BAD * len(kept):
            raise CalibrationError(
                f'{bad} of the {len(kept)} corners of {name} are not where the other pictures '
                'have them: is something in front of the board, is it bent, or the picture '
                'blurred? Take it again, or leave it out')
        if bad:
            doubts.append(f'{bad} corner{"s" if bad > 1 else ""} of {name} were left out as bad')
    return doubts


def _bend(fit: PinholeFit) -> List[str]:
    bend_mm = MM_PER_CM * float(np.abs(fit.problem.bend_cm(fit.numbers)).sum())
    if bend_mm < _DOUBTED_BEND_MM:
        return []
    is_known = fit.problem.known is not None
    text = (f'the board {"looks" if is_known else "is"} bent, by about {bend_mm:.1f} mm between '
            'its middle and its rim: '
            # Through another lens than the one it has, a flat board looks bent.
            + ('are the intrinsics those of this camera, at this zoom and focus, and is the '
               'picture not rectified? Otherwise ' if is_known else '')
            + 'glue it to something flat and stiff, and take the pictures again')
    if bend_mm > _REFUSED_BEND_MM:
        raise CalibrationError(text)
    return [text]
