# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The demo's bumps of the simulated camera: what becomes of the positions is printed."""

import time

BUMP = 'camera_publisher/bump_camera'
PERIOD_S = 10.0
# Positions come ten times a second.
SILENT_S = 1.5


class Bumps:
    """
    Bumps the camera every few seconds, and prints the error of the positions in between.

    :param node: The demo's node.
    :param report: Its `errors` are the time and the error of each position, in mm.
    :param terminal: Where it is printed.
    """

    def __init__(self, node, report, terminal):
        from diagnostic_msgs.msg import DiagnosticArray
        from std_srvs.srv import Trigger
        self._report, self._request, self._say = report, Trigger.Request, terminal.say
        self._client = node.create_client(Trigger, BUMP)
        self._state, self._state_at, self._answer = None, 0.0, None
        self._since = self._bumped_at = None
        self._count, self._is_silent = 0, False
        node.create_subscription(DiagnosticArray, '/diagnostics', self._on_diagnostics, 10)
        node.create_timer(0.1, self._on_timer)

    @staticmethod
    def parameters(is_on):
        """Return the camera node's parameters: a table with structure."""
        return {'simulated.table': 'wood'} if is_on else {}

    def close(self):
        """Print what has become of the positions since the last bump."""
        if self._answer is None:
            self._tell_errors()

    def _on_diagnostics(self, message):
        for status in message.status:
            if status.name.endswith('camera_publisher'):
                self._state, self._state_at = status.message, time.monotonic()

    def _on_timer(self):
        now, errors = time.monotonic(), self._report.errors
        if self._answer is not None and self._answer.done():
            self._say(f'==> bump {self._count + 1}: {self._answer.result().message}')
            self._since, self._bumped_at, self._answer = now, now, None
            self._count += 1
        if self._since is None:
            self._since = errors[0][0] if errors else None
        elif now - self._since > PERIOD_S:
            self._bump(now)
        if self._bumped_at is not None:
            self._tell_silence(now, errors)

    def _bump(self, now):
        self._tell_errors()
        self._answer = self._client.call_async(self._request())
        self._since, self._bumped_at, self._is_silent = now, None, False

    def _tell_silence(self, now, errors):
        last = max(self._bumped_at, errors[-1][0])
        is_told = self._state_at > self._bumped_at + 0.5
        if not self._is_silent and is_told and now - last > SILENT_S:
            self._is_silent = True
            self._say(f'==> no position for {now - last:.1f} s: {self._state}')
        elif self._is_silent and now - last < 0.5:
            self._is_silent = False
            self._say(f'==> positions come again, {last - self._bumped_at:.1f} s after the bump: '
                      f'{self._state}')

    def _tell_errors(self):
        if self._since is None:
            return
        seen = [error for at, error in self._report.errors if at >= self._since]
        when = f'since bump {self._count}' if self._count else 'before the bumps'
        if seen:
            self._say(f'==> {when}: error {sum(seen) / len(seen):.2f} mm on average, '
                      f'{max(seen):.2f} mm at most, of {len(seen)} position(s); {self._state}')
        else:
            waited_s = time.monotonic() - self._since
            self._say(f'==> {when}, {waited_s:.1f} s ago: no position, and no wrong one; '
                      f'{self._state}')
