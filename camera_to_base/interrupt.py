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

"""Signal handling: from the first line of a command, and without an exception."""

import signal
from typing import Any


def serve_signals() -> None:
    """
    Handle SIGINT and SIGTERM from now on, and those that arrived while Python started.

    The installed executables start with both blocked, see setup.py. Python needs 0.1 s to reach
    the first line of a module; a signal before that would end it with a traceback or with the
    signal's exit code.
    """
    signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT, signal.SIGTERM))


class Interrupt:
    """
    Records a Ctrl-C within a `with` block; a second one raises KeyboardInterrupt as usual.

    `came` is whether there was one.
    """

    came = False

    def __enter__(self) -> 'Interrupt':
        self._previous = signal.signal(signal.SIGINT, self._on_signal)
        return self

    def __exit__(self, *_: Any) -> None:
        signal.signal(signal.SIGINT, self._previous)

    def _on_signal(self, *_: Any) -> None:
        self.came = True
        signal.signal(signal.SIGINT, signal.default_int_handler)
