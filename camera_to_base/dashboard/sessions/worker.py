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

"""One thread for what takes longer than a moment."""

from concurrent.futures import ThreadPoolExecutor
import threading
from typing import Any, Callable, Optional

from camera_to_base.errors import CameraToBaseError


class Worker:
    """
    Runs one function after the other, in a thread that starts with the first one.

    :param lock: Held while results are taken over; see :meth:`run`.
    """

    def __init__(self, lock: Any) -> None:
        self._lock = lock
        self._thread: Optional[ThreadPoolExecutor] = None

    def run(self, function: Callable[[], Any], then: Callable[[Any], None]) -> None:
        """
        Run a function, and take its result over with the lock held.

        :param function: Runs without the lock.
        :param then: Called with its result, or with the exception that it raised.
        """
        if self._thread is None:
            self._thread = ThreadPoolExecutor(1, thread_name_prefix='session')
        self._thread.submit(self._run, function, then)

    def later(self, seconds: float, function: Callable[[], None]) -> None:
        """Call a function with the lock held, after some time."""
        def call() -> None:
            with self._lock:
                function()
        timer = threading.Timer(seconds, call)
        timer.daemon = True
        timer.start()

    def close(self) -> None:
        """Run nothing more."""
        if self._thread is not None:
            self._thread.shutdown(wait=False, cancel_futures=True)

    def _run(self, function: Callable[[], Any], then: Callable[[Any], None]) -> None:
        try:
            result = function()
        except Exception as error:
            result = error
        with self._lock:
            then(result)


def sentence_of(error: Exception) -> str:
    """Say what went wrong; a defect is called one."""
    if isinstance(error, CameraToBaseError):
        return str(error)
    return f'the dashboard has a defect: {type(error).__name__}: {error}'
