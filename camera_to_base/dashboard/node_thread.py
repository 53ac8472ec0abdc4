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

"""Runs functions of other threads in the thread of the node's executor."""

from collections import deque
from concurrent.futures import Future
from typing import Any, Callable, Deque, Tuple

from rclpy.node import Node
from rclpy.task import Future as RosFuture


class NodeThread:
    """
    The only way from the web server's thread to the node.

    :param node: The node whose executor runs the functions.
    """

    def __init__(self, node: Node) -> None:
        self._tasks: Deque[Tuple[Future, Callable[[], Any]]] = deque()
        self._guard = node.create_guard_condition(self._run)

    def call(self, function: Callable[[], Any]) -> Future:
        """
        Run a function in the executor's thread.

        :param function: It may return an rclpy future, whose result is waited for.
        :returns: A future of the function's result.
        """
        result: Future = Future()
        self._tasks.append((result, function))
        self._guard.trigger()
        return result

    def _run(self) -> None:
        while self._tasks:
            result, function = self._tasks.popleft()
            if result.set_running_or_notify_cancel():
                _fulfil(result, function)


def _fulfil(result: Future, function: Callable[[], Any]) -> None:
    try:
        value = function()
    except Exception as error:
        result.set_exception(error)
        return
    if isinstance(value, RosFuture):
        value.add_done_callback(lambda done: _copy(done, result))
    else:
        result.set_result(value)


def _copy(done: RosFuture, result: Future) -> None:
    if done.exception() is not None:
        result.set_exception(done.exception())
    else:
        result.set_result(done.result())
