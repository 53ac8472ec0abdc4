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

"""Numbers of the last minute."""

from collections import deque
from typing import Any, Deque, Dict, Optional

_SECONDS = 60


class Charts:
    """Keeps the rate and the latency of each of the last 60 s."""

    def __init__(self) -> None:
        self._rates: Deque[float] = deque(maxlen=_SECONDS)
        self._latencies: Deque[Optional[float]] = deque(maxlen=_SECONDS)

    def add(self, rate_hz: float, latency_ms: Optional[float]) -> None:
        """Add the numbers of a second; None where no frame came."""
        self._rates.append(rate_hz)
        self._latencies.append(latency_ms)

    @property
    def data(self) -> Dict[str, Any]:
        """The numbers as JSON, the oldest first."""
        return {'rate_hz': list(self._rates), 'latency_ms': list(self._latencies)}
