# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A cell without ROS: its parameters, the camera's frames, and a person at the page."""

import time

from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.dashboard.sessions.cell_sessions import CellSessions
from camera_to_base.parameters import default_values, TRANSFORM_SPECS
from camera_to_base.settings import camera_settings, CAMERA_SPECS
from camera_to_base.simulation import SimulatedChessboard
import numpy as np

TRUTH = CameraToRobotBaseConversion.from_roll_pitch_yaw((180.0, 0.0, 30.0), (-17.8, 24.4, 0.0))


class Cell:
    """
    Two nodes that take what they are told, and a camera above a chessboard.

    :param given: Parameters of the camera node that differ from their defaults.
    """

    def __init__(self, params_file='', **given):
        self.parts, self.pictures = [], []
        self.sessions = CellSessions(str(params_file), self.parts.append, self.pictures.append)
        self.values = {'camera': {**default_values(CAMERA_SPECS), 'source': 'simulated', **given},
                       'transform': default_values(TRANSFORM_SPECS)}
        self.board = SimulatedChessboard(9, 6, 2.5)
        self.tell()

    def tell(self):
        for node, values in self.values.items():
            self.sessions.see_parameters(node, values)

    def do(self, part, name, **body):
        """Act as the server does: what is to be set is set first."""
        changes = self.sessions.act(part, name, body)
        if changes is not None:
            for node, values in changes.values.items():
                self.values[node] = {**self.values[node], **values}
            self.tell()
            self.sessions.done(part, name, changes)
        return self.sessions.state(part)

    def state(self, part):
        return self.sessions.state(part)

    def show_frames(self, until, picture=None, seconds=30):
        """Show frames until a condition on the board's state holds."""
        end = time.monotonic() + seconds
        while not until(self.state('board')):
            assert time.monotonic() < end, self.state('board')
            self.sessions.see_frame(self.board.read() if picture is None else picture)
            time.sleep(0.02)
        return self.state('board')

    def take(self, picture=None):
        self.do('board', 'take')
        return self.show_frames(lambda state: not state['busy'], picture)

    def fit(self):
        self.do('board', 'fit')
        return self.show_frames(lambda state: not state['busy'])

    def calibrate_board(self, placements=1):
        """Calibrate the surface as a person does."""
        self.do('board', 'start')
        for number in range(placements):
            if number:
                self.board.lay(*self.board.free_place(number))
            assert self.take()['error'] is None
        assert self.fit()['error'] is None
        return self.do('board', 'accept')

    def clicked_point(self):
        """Return the point of the surface that the open pair's pixel shows, in cm."""
        surface = camera_settings(self.values['camera']).surface
        return tuple(surface.locate([self.state('robot')['open']['pixel']])[0].tolist())

    def measure_pair(self, camera_point, error=(0.0, 0.0), noise=0.005, **touch):
        """Put an object down, click it, and touch it."""
        (u, v), = camera_settings(self.values['camera']).surface.pixels([camera_point])
        self.do('robot', 'see', u=u + 4, v=v - 4)
        random = np.random.default_rng(1)
        for _ in range(20):
            self.sessions.see_objects([tuple(camera_point + random.normal(0, noise, 2)),
                                       (camera_point[0] + 9.0, camera_point[1])])
        if self.state('robot')['error']:
            return self.state('robot')
        x, y, _ = TRUTH.convert_point(*camera_point)
        return self.do('robot', 'touch', **(touch or {
            'text': f'{x + error[0]:.3f} {y + error[1]:.3f}'}))

    def measure_pairs(self, count=5, wrong=None):
        """Measure pairs at the suggested places; the one with the number `wrong` is wrong."""
        self.do('robot', 'start')
        for number in range(1, count + 1):
            place = self.state('robot')['suggestion']['camera']
            self.measure_pair(np.array([place['x'], place['y']]),
                              (1.5, 0.0) if number == wrong else (0.02, -0.01))
        return self.state('robot')
