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

"""Questions to the person at the terminal."""

import sys
from typing import Callable, TypeVar

from camera_to_base.calibration import Suggestion
from camera_to_base.errors import CameraToBaseError, InputEndedError

T = TypeVar('T')


def ask(question: str) -> str:
    """
    Print a question, and return the line that is typed.

    Questions go to standard error: standard output carries the report alone.

    :raises InputEndedError: If the input has ended.
    """
    print(question, end=' ', file=sys.stderr, flush=True)
    line = sys.stdin.readline()
    if not line:
        print(file=sys.stderr)
        raise InputEndedError(
            'the input has ended before all questions were answered: run it in a terminal')
    return line.strip()


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


def ask_for_object(suggestion: Suggestion) -> None:
    """Ask the person to put the object to a place."""
    ask(f'  Put one object near the {suggestion.name} of the calibrated area, as the picture '
        'shows it. Take your hand and the robot out of the picture, and press Enter:')
