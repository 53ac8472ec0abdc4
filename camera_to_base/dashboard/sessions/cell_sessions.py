# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The sessions of each cell: whichever thread acts, and whoever is told."""

import os
import threading
import time
import traceback
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Set, Tuple

from camera_to_base.calibration import (
    lens_of_camera_info, marker_sheet_content, OfferedCorrection)
from camera_to_base.dashboard.sessions.board import BoardSession
from camera_to_base.dashboard.sessions.cell_file import CellFiles
from camera_to_base.dashboard.sessions.kept import KeptSteps, Steps
from camera_to_base.dashboard.sessions.placements import report_part
from camera_to_base.dashboard.sessions.prove import ProveSession
from camera_to_base.dashboard.sessions.record import RecordSession
from camera_to_base.dashboard.sessions.robot import RobotSession
from camera_to_base.dashboard.sessions.save import SaveSession
from camera_to_base.dashboard.sessions.table import (
    area_changes, areas_data, MarkerSession, show, simulated_data, TOOL_TOPIC, touch)
from camera_to_base.dashboard.sessions.values import CellChanges, CellValues, Setup, Worker
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.parameters import Values
import numpy as np

# The edge of a printed marker, in mm; the command `calibrate sheet --markers` has others.
_MARKER_MM = 40.0
PARTS = (
    'board', 'markers', 'robot', 'prove', 'record', 'save', 'areas', 'simulated')
# A session may change several times for one frame.
_PAUSE_S = 0.05
Action = Callable[[Mapping[str, Any]], Optional[CellChanges]]
OnState = Callable[[str, str, Any], None]


class CellSessions:
    """
    What people do with a cell on its pages, whichever thread says so.

    It lives as long as the server: a page that is loaded again finds it as it was.

    :param params_file: The file that Save writes; '' if it is not known.
    :param on_change: Called with a part's name when its state has changed, by any thread.
    :param on_picture: Called with each picture of the board as JPEG, by any thread.
    :param owner_of: Returns another cell whose file has a path; None for none.

    `was_running` is whether a node of the cell was ever seen.
    """

    def __init__(
        self, params_file: str = '', on_change: Callable[[str], None] = lambda part: None,
        on_picture: Callable[[bytes], None] = lambda jpeg: None,
        owner_of: Callable[[str], Optional[str]] = lambda path: None,
    ) -> None:
        self._lock = threading.RLock()
        self._on_change = self._kept_before(on_change)
        on_change = self._on_change
        self.was_running = self._is_restored = False
        self._values = CellValues()
        self._worker = Worker(self._lock)
        self._board = BoardSession(
            self._values, self._worker, lambda: on_change('board'), on_picture)
        self._markers = MarkerSession(self._values, lambda: on_change('markers'))
        self._robot = RobotSession(self._values, lambda: on_change('robot'))
        self._prove = ProveSession(
            self._values, self._robot.tool, lambda: on_change('prove'))
        self._save = SaveSession(
            self._values, lambda: (self._robot.accepted_calibration,
                                   self._board.accepted_calibration),
            params_file, lambda: on_change('save'), owner_of)
        self._record = RecordSession(
            self._values, lambda: self._save.beside, self._worker, lambda: on_change('record'))
        self._actions = self._list_actions()
        self._kept = KeptSteps(self._save.path)
        self._restore()

    @property
    def wants_frames(self) -> bool:
        """Whether :meth:`see_frame` is to be called."""
        return self._board.wants_frames or self._markers.wants_frames

    @property
    def wants_recording(self) -> bool:
        """Whether :meth:`see_jpeg` is to be called."""
        return self._record.wants_frames

    @property
    def wants_objects(self) -> bool:
        """Whether :meth:`see_objects` and :meth:`see_background` are to be called."""
        return self._robot.wants_objects or self._prove.wants_objects

    @property
    def file_path(self) -> str:
        """The cell's parameter file; '' if it is not known."""
        return self._save.path

    @property
    def is_running(self) -> bool:
        """Whether a node of the cell runs."""
        return bool(self._values.camera or self._values.transform)

    @property
    def setup(self) -> Setup:
        """How far the cell is set up."""
        with self._lock:
            return Setup(self._values.parts, self._board.sees_board, self._board.new_surface,
                         self._kept.problem)

    @property
    def tool_topic(self) -> str:
        """The topic whose poses go to :meth:`see_tool`, in the cell's namespace; '' for none."""
        with self._lock:
            is_on = self.wants_objects or simulated_data(self._values)['shown']
            return self._robot.tool.topic if is_on else ''

    def see_frame(self, image: np.ndarray) -> None:
        """Take the newest frame, shape (h, w, 3), uint8, BGR."""
        with self._lock:
            self._board.see_frame(image)
            self._markers.see_frame(image)

    def see_jpeg(self, jpeg: bytes) -> None:
        """Take the newest frame as it came."""
        with self._lock:
            self._record.see(jpeg)

    def see_background_png(self, png: bytes) -> None:
        """Take the background as it came."""
        with self._lock:
            self._record.see_background(png)

    def see_camera_info(self, info: Any, is_rectified: bool = False) -> None:
        """
        Take what the driver says of its lens.

        :param info: A sensor_msgs/CameraInfo; None if there is no driver.
        :param is_rectified: Whether its pictures have no distortion any more.
        """
        try:
            lens = None if info is None else lens_of_camera_info(info, is_rectified)
        except InvalidValueError:
            # The board tells the lens then.
            lens = None
        with self._lock:
            self._board.see_lens(lens)

    def see_objects(self, points: Sequence[Tuple[float, float]]) -> None:
        """Take all objects of a frame, x and y, in cm, in the camera frame."""
        with self._lock:
            self._robot.see_objects(points)

    def see_tool(self, x: float, y: float, frame_id: str = '', stamp_s: float = 0.0) -> None:
        """Take a pose of the robot's tool, see :meth:`ToolPlace.see`."""
        with self._lock:
            before = self._robot.tool.data
            self._robot.tool.see(x, y, frame_id, stamp_s)
            if self._robot.tool.data != before:
                self._on_change('robot')
                self._on_change('prove')

    def see_published(self, stamp_s: Optional[float], objects: List[Dict[str, Any]]) -> None:
        """Take the published objects of the newest frame, as the page shows them."""
        with self._lock:
            self._board.see_published(stamp_s)
            self._prove.see_published(stamp_s, objects)

    def see_background(self, mark: Any) -> None:
        """Take something that changes with each background."""
        with self._lock:
            self._robot.see_background(mark)

    def see_parameters(self, node: str, values: Optional[Values]) -> None:
        """Take all parameters of 'camera' or 'transform'; None where it does not run."""
        with self._lock:
            self.was_running |= values is not None
            before = getattr(self._values, node)
            self._values.see(node, values)
            if before == getattr(self._values, node):
                return
            if simulated_data(self._values)['shown']:
                # What is touched may be another object now.
                self._robot.tool.listen(self._robot.tool.topic or TOOL_TOPIC)
                self._robot.tool.forget()
            self._robot.check_again()
            for part in PARTS:
                self._on_change(part)

    def state(self, part: str) -> Dict[str, Any]:
        """Return the state of one of PARTS as JSON."""
        with self._lock:
            if part in ('areas', 'simulated'):
                return (areas_data if part == 'areas' else simulated_data)(self._values)
            return {'board': self._board, 'markers': self._markers, 'robot': self._robot,
                    'prove': self._prove, 'record': self._record, 'save': self._save}[part].state

    def act(self, part: str, name: str, body: Mapping[str, Any]) -> Optional[CellChanges]:
        """
        Carry out what a page asks for.

        :param part: One of PARTS.
        :param name: The action, see `/api/PART/NAME`.
        :returns: What is to be set on the nodes first; then :meth:`done` is called.
        :raises CameraToBaseError: If it cannot be done.
        """
        with self._lock:
            return self._actions[part, name](body)

    def done(self, part: str, name: str, changes: CellChanges) -> None:
        """Take note that the nodes have what an action wanted to be set."""
        with self._lock:
            if part == 'simulated':
                self._robot.tool.forget()
            if part == 'save':
                self._save.set_loaded()
            if part == 'markers':
                self._markers.set_learned()
            if name == 'accept':
                (self._board if part == 'board' else self._robot).set_accepted(changes)
            for changed in PARTS:
                self._on_change(changed)

    def has(self, part: str, name: str) -> bool:
        """Return whether there is such an action."""
        return (part, name) in self._actions

    def sheet(self, body: Mapping[str, Any]) -> bytes:
        """
        Draw the board to print, or the four markers.

        :param body: Options of the board; the others are as they are in its state. With `markers`,
            the markers are drawn.
        :returns: A PDF.
        :raises InvalidValueError: If it does not fit on the paper.
        """
        options = self._board.options.changed(body)
        if body.get('markers'):
            return marker_sheet_content(options.paper, _MARKER_MM)
        return options.sheet()

    def report(self, name: str) -> bytes:
        """
        Return a part of the board's report, see :func:`report_part`.

        :raises InvalidValueError: If there is none.
        """
        return report_part(self._board.calibration, name)

    def file_text(self) -> str:
        """Return the parameter file as it would be saved."""
        with self._lock:
            return self._save.text()

    def keep_correction(self, offer: Mapping[str, Any], body: Mapping[str, Any]) -> CellChanges:
        """
        Write the correction of a nudge into the file, see :meth:`SaveSession.keep`.

        :param offer: The camera node's, see its service `~/corrected_surface`.
        :returns: What is to be set on the nodes.
        """
        offered = OfferedCorrection(**offer)
        with self._lock:
            self._save.keep(offered, body)
        return CellChanges({'camera': dict(offered.values)}, [])

    def close(self) -> None:
        """End the worker; what was measured is kept."""
        self._worker.close()
        self._kept.write()

    def _kept_before(self, on_change: Callable[[str], None]) -> Callable[[str], None]:
        def changed(part: str) -> None:
            self._keep(part)
            on_change(part)
        return changed

    def _keep(self, part: str) -> None:
        if part in ('board', 'robot', 'prove') and self._is_restored:
            board, images = self._board.kept
            if self._kept.see(Steps(board, self._robot.kept, self._prove.kept, images)):
                self._worker.run(self._kept.write, lambda result: None)

    def _restore(self) -> None:
        steps = self._kept.read()
        if steps is not None:
            try:
                self._board.restore(steps.board, steps.images)
                self._robot.restore(steps.robot)
                self._prove.restore(steps.prove)
            except (CameraToBaseError, KeyError, TypeError, ValueError):
                pass  # not of this version
        self._is_restored = True

    def _list_actions(self) -> Dict[Tuple[str, str], Action]:
        board, values = self._board, self._values
        parts = {'markers': self._markers, 'robot': self._robot, 'prove': self._prove,
                 'record': self._record, 'save': self._save}
        return {
            ('board', 'start'): board.start, ('board', 'take'): lambda body: board.take(),
            ('board', 'remove'): board.remove, ('board', 'fit'): lambda body: board.fit(),
            ('board', 'tilt'): board.tilt, ('board', 'undo'): lambda body: board.undo(),
            ('board', 'accept'): lambda body: board.acceptance(),
            ('board', 'cancel'): lambda body: board.cancel(),
            ('areas', 'set'): lambda body: area_changes(values, body),
            ('simulated', 'show'): lambda body: show(values, body),
            ('simulated', 'touch'): lambda body: touch(values, self._robot.object_number(body)),
            **{(part, name): action for part, session in parts.items()
               for name, action in session.actions.items()}}


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
