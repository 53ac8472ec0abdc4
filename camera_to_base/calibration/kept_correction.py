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

"""A parameter file that keeps the correction of a running node."""

from typing import Any, Mapping, NamedTuple, Sequence

from camera_to_base.calibration.cell_file import cell_text, TITLE
from camera_to_base.errors import CalibrationError
from camera_to_base.parameters import ParameterFile


class OfferedCorrection(NamedTuple):
    """
    What a camera node offers to keep, see its service `~/corrected_surface`.

    :param sentence: What it corrects.
    :param values: The parameters that make the correction a calibration, by full name.
    :param before: The parameters of the surface that it corrects.
    """

    sentence: str
    values: Mapping[str, Any]
    before: Mapping[str, Any]


def corrected_file_text(path: str, file: ParameterFile, offer: OfferedCorrection) -> str:
    """
    Return the text of a parameter file with a correction.

    The camera frame is the same as before, so that the base frame, the markers and the areas stay.

    :param path: The file, for the message.
    :raises CalibrationError: If it holds another surface than the one that was corrected.
    """
    others = [name for name, value in file.values.items()
              if name in offer.before and value != offer.before[name]]
    if others:
        raise CalibrationError(
            f"'{path}' has another {others[0]} than the running node, so that its correction does "
            'not belong to this file: name the file that the node was started with')
    record = offer.values['calibration.surface']
    return cell_text({**file.values, **offer.values}, [f'kept: {record}'], _without(
        file.comments, 'kept: '))


def _without(comments: Sequence[str], beginning: str) -> Sequence[str]:
    kept = [line for line in comments if line != TITLE and not line.startswith(beginning)]
    while kept and not kept[0]:
        del kept[0]
    return kept
