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

"""The pairs of a session, and the fit to those that are valid."""

from typing import Any, Dict, List, Optional

from camera_to_base.dashboard.sessions.robot.data import pair_data, PixelOf
from camera_to_base.dashboard.sessions.robot.pair_list import (
    fit_pairs, MeasuredWith, Pair, PairFit)
from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import Values


class PairBook:
    """
    Keeps pairs by their numbers.

    `fit` is the fit to the valid ones; None if they are too few.
    """

    def __init__(self) -> None:
        self._pairs: List[Pair] = []
        self._fitted: Any = None
        self.fit: Optional[PairFit] = None

    def __len__(self) -> int:
        return len(self._pairs)

    @property
    def next_number(self) -> int:
        """The number of the next pair."""
        return 1 + max((pair.number for pair in self._pairs), default=0)

    def numbered(self, number: Any) -> Pair:
        """
        Return a pair.

        :raises InvalidValueError: If there is none with the number.
        """
        for pair in self._pairs:
            if pair.number == number:
                return pair
        raise InvalidValueError(f'there is no pair {number!r:.20}')

    def put(self, pair: Pair) -> None:
        """Add a pair; it replaces the one with its number."""
        kept = [one for one in self._pairs if one.number != pair.number]
        self._pairs = sorted([*kept, pair], key=lambda one: one.number)

    def remove(self, pair: Pair) -> None:
        """Remove a pair."""
        self._pairs.remove(pair)

    def clear(self) -> None:
        """Remove all pairs."""
        self._pairs, self._fitted, self.fit = [], None, None

    def tell_background(self, mark: Any) -> None:
        """Say with which background the pairs were measured, which was not known."""
        self._pairs = [pair.with_background(mark) for pair in self._pairs]

    def fit_again(self, now: MeasuredWith, surface_values: Values, base_z: str) -> bool:
        """
        Fit the valid pairs, unless nothing has changed.

        :param now: What makes a pair valid.
        :returns: Whether something has changed.
        """
        valid = [pair for pair in self._pairs if pair.measured_with.difference(now) is None]
        wanted = valid, surface_values, base_z
        if wanted == self._fitted:
            return False
        self._fitted, self.fit = wanted, fit_pairs(*wanted)
        return True

    def data(self, now: MeasuredWith, pixel_of: PixelOf) -> List[Dict[str, Any]]:
        """Describe the pairs as JSON."""
        return [pair_data(pair, self.fit, pair.measured_with.difference(now), pixel_of)
                for pair in self._pairs]
