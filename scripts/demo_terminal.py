# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the demo prints: whole lines, and one line that is printed over itself."""

import shutil
import sys
import threading
import time

# Without a terminal, a line that would be printed over itself is printed this often.
PERIOD_S = 1.0


class Terminal:
    """Prints lines from several threads, above one line that is updated."""

    def __init__(self, out=None):
        self._out = out or sys.stdout
        self._lock = threading.Lock()
        self._is_terminal = self._out.isatty()
        self._updated, self._updated_at = '', float('-inf')

    def say(self, line):
        """Print a line that stays."""
        with self._lock:
            self._write(line + '\n', self._updated)

    def update(self, parts):
        """
        Print a line over the last one; without a terminal, one a second.

        :param parts: Those that have no room on the terminal are left out, the first ones first.
        """
        with self._lock:
            if self._is_terminal:
                self._updated = fitting(parts, shutil.get_terminal_size().columns - 1)
                self._write('', self._updated)
            elif time.monotonic() - self._updated_at >= PERIOD_S:
                self._updated_at = time.monotonic()
                self._write('  '.join(parts) + '\n', '')

    def settle(self):
        """Keep the updated line as it is, and go on below it."""
        with self._lock:
            if self._updated:
                self._write(self._updated + '\n', '')
            self._updated = ''

    def frame(self, lines):
        """Print lines in a box."""
        width = max(map(len, lines))
        edge = '+' + '-' * (width + 2) + '+'
        self.say('\n'.join([edge, *(f'| {line:{width}} |' for line in lines), edge]))

    def follow(self, stream):
        """Print each line of a process's output as it comes; return the thread that does it."""
        def copy():
            for line in stream:
                self.say(line.rstrip('\n'))

        thread = threading.Thread(target=copy, daemon=True)
        thread.start()
        return thread

    def _write(self, text, updated):
        clear = '\r\x1b[K' if self._is_terminal else ''
        self._out.write(clear + text + updated)
        self._out.flush()


def fitting(parts, width):
    """Join the last parts of a line, as many as fit into a width."""
    parts = list(parts)
    while len(parts) > 1 and len('  '.join(parts)) > width:
        del parts[0]
    return '  '.join(parts)[:width]
