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

"""The newest state of each cell, and the pages that look at it."""

import json
import math
from typing import Any, Callable, Dict, Protocol, Set

import tornado.ioloop

# A page that is loaded again finds the cell still watched, with its charts.
_LINGER_S = 5.0


class Viewer(Protocol):
    """A page that looks at a cell."""

    def show(self, key: str, text: str) -> None:
        """Send a text; a newer one with the same key replaces it."""


class StateHub:
    """
    Keeps parts of the state, and passes them on.

    :param look_at: Called with a cell when the first page looks at it.
    :param look_away: Called with a cell when nobody has looked for some seconds.
    """

    def __init__(
        self, look_at: Callable[[str], None], look_away: Callable[[str], None]
    ) -> None:
        self._look_at, self._look_away = look_at, look_away
        self._parts: Dict[str, Dict[str, str]] = {}
        self._viewers: Dict[str, Set[Viewer]] = {}

    def add(self, cell: str, viewer: Viewer) -> None:
        """Show the state of a cell to a page from now on."""
        if cell not in self._viewers:
            self._viewers[cell] = set()
            self._look_at(cell)
        self._viewers[cell].add(viewer)
        for part, text in self._parts.get(cell, {}).items():
            viewer.show(part, text)

    def remove(self, cell: str, viewer: Viewer) -> None:
        """End that."""
        self._viewers.get(cell, set()).discard(viewer)
        tornado.ioloop.IOLoop.current().call_later(_LINGER_S, self._end_if_unwatched, cell)

    def put(self, cell: str, part: str, text: str) -> None:
        """Keep a part's new text, and show it."""
        if cell in self._viewers:
            self._parts.setdefault(cell, {})[part] = text
            for viewer in self._viewers[cell]:
                viewer.show(part, text)

    def _end_if_unwatched(self, cell: str) -> None:
        if cell in self._viewers and not self._viewers[cell]:
            del self._viewers[cell]
            self._parts.pop(cell, None)
            self._look_away(cell)


def part_text(part: str, data: Any) -> str:
    """Make the text of a message with a part of the state."""
    message = {'part': part, 'data': data}
    try:
        return json.dumps(message, separators=(',', ':'), allow_nan=False)
    except ValueError:
        return json.dumps(_finite(message), separators=(',', ':'))


def _finite(data: Any) -> Any:
    # A number that is not finite has no JSON.
    if isinstance(data, dict):
        return {name: _finite(value) for name, value in data.items()}
    if isinstance(data, list):
        return list(map(_finite, data))
    return None if isinstance(data, float) and not math.isfinite(data) else data
