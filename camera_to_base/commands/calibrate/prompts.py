# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Questions to the person at the terminal."""

import os
import sys
import termios
from typing import Callable, Collection, TypeVar

from camera_to_base.calibration import Suggestion
from camera_to_base.errors import CalibrationError, CameraToBaseError, InputEndedError

T = TypeVar('T')


def ask(question: str) -> str:
    """
    Print a question, and return the line that is typed.

    Questions go to standard error: standard output carries the report alone. What was typed into
    a terminal before the question is dropped: it answers another one.

    :raises InputEndedError: If the input has ended.
    """
    _drop_typed_ahead()
    print(question, end=' ', file=sys.stderr, flush=True)
    line = sys.stdin.readline()
    if not line:
        print(file=sys.stderr)
        raise InputEndedError(
            'the input has ended before all questions were answered: run it in a terminal')
    return line.strip()


def _drop_typed_ahead() -> None:
    try:
        number = sys.stdin.fileno()
        if os.isatty(number):
            termios.tcflush(number, termios.TCIFLUSH)
    except (AttributeError, OSError, ValueError, termios.error):
        pass  # no file, or a terminal that is gone: reading it tells


def tell(text: str) -> None:
    """Print a line for the person."""
    print(text, file=sys.stderr, flush=True)


def until_right(step: Callable[[], T], again: str) -> T:
    """
    Repeat a step until it raises no error that the person can mend; print each error.

    :param again: The question after an error; 'q' as its answer raises the error.
    """
    while True:
        try:
            return step()
        except InputEndedError:
            raise
        except CameraToBaseError as error:
            tell(f'  {error}')
            if ask(again).lower() == 'q':
                raise


def until_it_fits(
    fit: Callable[[], T], touches: str, again: str, numbers: Collection[int],
    repeat: Callable[[int], None],
) -> T:
    """
    Repeat a fit until it raises no error; after each error a single touch may be repeated.

    :param touches: What does not fit, in the line that tells the error.
    :param again: How a touch is repeated, as in 'a pair to measure it again'.
    :param numbers: The touches' numbers.
    :param repeat: Repeats the touch of a number.
    :raises CalibrationError: The fit's, if the answer is 'q'.
    """
    while True:
        try:
            return fit()
        except CalibrationError as error:
            tell(f'The {touches} do not fit: {error}')
            answer = ask(f'Type the number of {again}, or q to stop without a file:')
            if answer.lower() == 'q':
                raise
            if answer.isdecimal() and int(answer) in numbers:
                repeat(int(answer))


def ask_for_object(suggestion: Suggestion) -> None:
    """Ask the person to put the object to a place."""
    ask(f'  Put one object near the {suggestion.name} of the calibrated area, as the picture '
        'shows it. Take your hand and the robot out of the picture, and press Enter:')
