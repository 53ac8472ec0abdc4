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

"""Compares several values of a detector parameter on the same frames."""

from dataclasses import replace
import math
import re
from typing import Iterable, Iterator, List, NamedTuple, Optional

from camera_to_base.commands.locate.sighting_counter import SightingCounter
from camera_to_base.detection import DETECTOR_SPECS, DetectorSettings
from camera_to_base.errors import InvalidValueError
from camera_to_base.settings import CameraSettings
from camera_to_base.sources import TimedFrame

NAMES = ('threshold', 'faintest', 'closing_size', 'median_size', 'min_area_cm2',
         'max_area_cm2')
# Each value needs its own detector.
MOST_VALUES = 100


class SweepRange(NamedTuple):
    """
    The parameter and the values to try.

    :param name: One of NAMES; 'threshold' is that of the method in use.
    :param values: At least two, in order.
    """

    name: str
    values: List[float]


class SweepResult(NamedTuple):
    """
    The result of a sweep.

    :param name: The parameter's full name, such as 'detector.threshold'.
    :param current: Its value in the settings.
    :param values: The values that were tried.
    :param counters: One for each value.
    """

    name: str
    current: float
    values: List[float]
    counters: List[SightingCounter]


def sweep_range(text: str) -> SweepRange:
    """
    Parse the option `--sweep`.

    :param text: NAME=FIRST:LAST:STEP; LAST is included if the steps reach it exactly.
    :raises InvalidValueError: If the text has another form.
    """
    name, _, span = text.partition('=')
    numbers = [_number(part) for part in span.split(':')]
    if name not in NAMES or len(numbers) != 3 or None in numbers:
        raise InvalidValueError(
            f"a sweep must be NAME=FIRST:LAST:STEP as in threshold=40:120:10, got '{text}'; NAME "
            f'is one of {", ".join(NAMES)}')
    first, last, step = numbers
    count = math.floor((last - first) / step + 1e-9) + 1 if step > 0 else 0
    if not 2 <= count <= MOST_VALUES:
        raise InvalidValueError(
            f"a sweep must have 2 to {MOST_VALUES} values, got '{text}': choose another "
            'FIRST, LAST or STEP')
    return SweepRange(name, [round(first + index * step, 9) for index in range(count)])


def sweep(
    settings: CameraSettings, wanted: SweepRange, frames: Iterable[TimedFrame]
) -> SweepResult:
    """
    Find the objects on the same frames with each value; the frames are read once.

    :param settings: The camera node's settings.
    :raises CameraToBaseError: If a value cannot be used, or the parameter has no effect.
    """
    name = _name_in(settings.detector, wanted.name)
    values = list(_values(name, wanted.values))
    counters = [
        SightingCounter(replace(settings, detector=replace(settings.detector, **{name: value})))
        for value in values]
    for timed in frames:
        for counter in counters:
            counter.see(timed)
    return SweepResult(f'detector.{name}', getattr(settings.detector, name), values, counters)


def sweep_lines(result: SweepResult) -> List[str]:
    """Return a table of the number of frames with an object, for each value."""
    name = f'{result.name} (now {result.current:g})'
    header = f'{name}  {"no object":>9}  {"one":>7}  {"more":>7}'
    return [header, *(
        f'{value:>{len(name)}g}  {counter.frames - counter.with_any:>9}'
        f'  {counter.with_one:>7}  {counter.with_more:>7}'
        for value, counter in zip(result.values, result.counters))]


def _number(text: str) -> Optional[float]:
    return float(text) if re.fullmatch(r'-?\d{1,9}(\.\d{1,9})?', text) else None


def _name_in(detector: DetectorSettings, name: str) -> str:
    if name == 'threshold' and detector.method == 'precise':
        return 'faintest'
    if not detector.has_effect(name):
        raise InvalidValueError(
            f'detector.{name} has no effect with detector.method {detector.method}: choose the '
            'other method in the parameter file')
    return name


def _values(name: str, values: List[float]) -> Iterator[float]:
    spec = next(spec for spec in DETECTOR_SPECS if spec.name == f'detector.{name}')
    for value in values:
        is_whole = type(spec.default) is int and value == int(value)
        yield spec.checked(int(value) if is_whole else value)
