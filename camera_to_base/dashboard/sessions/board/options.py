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

"""The printed board that a person says to have."""

from typing import Any, Dict, Mapping, NamedTuple, Tuple

from camera_to_base.calibration import PAPERS, PrintedBoard, sheet_content
from camera_to_base.checks import finite_number, whole_number
from camera_to_base.errors import InvalidValueError


class BoardOptions(NamedTuple):
    """
    What is printed.

    :param corners: Inner corners along a row and along a column.
    :param square_mm: A square's edge as printed.
    :param charuco: Whether it has markers.
    :param paper: What it is printed on.
    """

    corners: Tuple[int, int] = (9, 6)
    square_mm: float = 25.0
    charuco: bool = False
    paper: str = 'A4'

    @property
    def board(self) -> PrintedBoard:
        """The board."""
        return PrintedBoard(self.corners, self.square_mm, self.charuco)

    @property
    def data(self) -> Dict[str, Any]:
        """The options as JSON."""
        return {**self._asdict(), 'corners': list(self.corners)}

    def changed(self, body: Mapping[str, Any]) -> 'BoardOptions':
        """
        Return the options with some changed.

        :param body: As in `data`.
        :raises InvalidValueError: If one cannot be used.
        """
        wanted = {**self._asdict(), **{name: body[name] for name in self._fields if name in body}}
        corners = wanted['corners']
        if not isinstance(corners, (list, tuple)) or len(corners) != 2:
            raise InvalidValueError(f'corners must be two counts as in 9 x 6, got {corners!r:.80}')
        if wanted['paper'] not in PAPERS:
            raise InvalidValueError(
                f'paper must be one of {", ".join(PAPERS)}, got {wanted["paper"]!r:.80}')
        return BoardOptions(
            tuple(whole_number('the count of inner corners', count, 3, 100) for count in corners),
            finite_number('square_mm', wanted['square_mm'], 1, 1000), bool(wanted['charuco']),
            wanted['paper'])

    def sheet(self) -> bytes:
        """
        Draw the board, as `calibrate sheet` does.

        :returns: A PDF.
        :raises InvalidValueError: If it does not fit on the paper.
        """
        return sheet_content(self.paper, *self.corners, self.square_mm, 'pdf',
                             with_markers=self.charuco)
