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

"""What the pages show of a cell: its objects, its health, and why nothing is published."""

import time
from typing import Any, Dict, Optional

from camera_to_base.dashboard.live.cells import Cell
from camera_to_base.dashboard.live.charts import Charts
from camera_to_base.dashboard.live.frames import SeenFrame
from camera_to_base.dashboard.live.geometry import Geometry
from camera_to_base.dashboard.live.health import CellHealth
from camera_to_base.dashboard.live.positions import CellPositions
from camera_to_base.dashboard.live.silence import silence, SILENT_S, State, warning
from camera_to_base.dashboard.live.watch_data import left_out_data, objects_data


class CellStatus:
    """
    Puts together what came from a cell's nodes.

    :param positions: What they publish.
    :param health: What they say about themselves.
    :param camera: The camera node's full name.
    :param transform: The transform node's full name.
    """

    def __init__(
        self, positions: CellPositions, health: CellHealth, camera: str, transform: str
    ) -> None:
        self._positions, self._health = positions, health
        self._camera, self._transform = camera, transform
        self._charts = Charts()
        self._was_seen = False

    def watch_data(self, cell: Cell, geometry: Optional[Geometry]) -> Dict[str, Any]:
        """
        Return the part `watch` as JSON.

        :param cell: The nodes that run.
        :param geometry: Where things are; None where it is not known.
        """
        self._was_seen |= cell.camera is not None
        state = State(cell, self._was_seen, self._positions.silent_s,
                      self._health.report(self._camera), self._health.report(self._transform))
        frame = self._positions.newest
        shown = self._shown
        return {
            'silence': silence(state), 'warning': warning(state),
            'rate_hz': round(self._positions.rate_hz, 1),
            'age_s': None if frame is None else round(time.time() - frame.stamp_s, 1),
            'latency_ms': self._latency_ms,
            'objects': objects_data(shown, geometry) if shown else [],
            'left_out': left_out_data(shown, geometry) if shown else [],
            'map': geometry and geometry.map_data, 'image': geometry and geometry.image_data}

    def health_data(self) -> Dict[str, Any]:
        """Return the part `health` as JSON; it is called once a second."""
        self._charts.add(round(self._positions.rate_hz, 1), self._latency_ms)
        return {'nodes': self._health.data, 'charts': self._charts.data}

    @property
    def _shown(self) -> Optional[SeenFrame]:
        return self._positions.newest if self._positions.silent_s <= SILENT_S else None

    @property
    def _latency_ms(self) -> Optional[float]:
        shown = self._shown
        return None if shown is None else round(1e3 * shown.latency_s, 1)
