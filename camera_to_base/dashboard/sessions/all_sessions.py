# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The sessions of all cells: made when somebody looks, and told to whoever does."""

import os
import threading
import time
import traceback
from typing import Any, Callable, Dict, Optional, Set, Tuple

from camera_to_base.dashboard.sessions.cell_file import CellFiles
from camera_to_base.dashboard.sessions.cell_sessions import CellSessions, PARTS

# A session may change several times for one frame.
_PAUSE_S = 0.05

OnState = Callable[[str, str, Any], None]


class AllSessions:
    """
    Makes a cell's sessions when somebody first looks at it, and keeps them.

    :param files: Which file belongs to which cell.
    :param on_state: Called with a cell, a part and its state, some time after it has changed, by
        a thread of its own.
    :param on_picture: Called with a cell and a JPEG of the board.
    """

    def __init__(
        self, files: CellFiles, on_state: OnState, on_picture: Callable[[str, bytes], None]
    ) -> None:
        self._files = files
        self._on_state, self._on_picture = on_state, on_picture
        self._lock = threading.Lock()
        self._sessions: Dict[str, CellSessions] = {}
        self._changed: Set[Tuple[str, str]] = set()
        self._has_changed = threading.Event()
        self._is_closed = False
        self._thread = threading.Thread(target=self._tell, name='states', daemon=True)
        self._thread.start()

    def of(self, cell: str) -> CellSessions:
        """Return a cell's sessions."""
        with self._lock:
            if cell not in self._sessions:
                self._sessions[cell] = CellSessions(
                    self._files.of(cell), lambda part: self._mark(cell, part),
                    lambda jpeg: self._on_picture(cell, jpeg),
                    lambda path: self._owner_of(path, cell))
            return self._sessions[cell]

    def forget_invented(self, cell: str) -> None:
        """Forget the sessions of a cell whose nodes nobody has ever seen."""
        with self._lock:
            if cell in self._sessions and not self._sessions[cell].was_running:
                self._sessions.pop(cell).close()

    def show(self, cell: str) -> None:
        """Tell all states of a cell."""
        for part in PARTS:
            self._mark(cell, part)

    def close(self) -> None:
        """End all sessions."""
        self._is_closed = True
        self._has_changed.set()
        for sessions in self._sessions.values():
            sessions.close()

    def _owner_of(self, path: str, cell: str) -> Optional[str]:
        others = {name: one for name, one in list(self._sessions.items()) if name != cell}
        return next((name for name, one in others.items() if one.is_running and os.path.realpath(
            one.file_path) == os.path.realpath(path)), None)

    def _mark(self, cell: str, part: str) -> None:
        self._changed.add((cell, part))
        self._has_changed.set()

    def _tell(self) -> None:
        while not self._is_closed:
            self._has_changed.wait()
            self._has_changed.clear()
            while self._changed and not self._is_closed:
                cell, part = self._changed.pop()
                self._tell_one(cell, part)
            time.sleep(_PAUSE_S)

    def _tell_one(self, cell: str, part: str) -> None:
        sessions = self._sessions.get(cell)
        if sessions is None:
            return  # forgotten meanwhile
        try:
            self._on_state(cell, part, sessions.state(part))
        except Exception:
            traceback.print_exc()  # a defect of one state does not stop the others
