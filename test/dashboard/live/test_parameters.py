# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Another node's parameters: what it loses is asked once more."""

import threading

from camera_to_base.dashboard.live.parameters import RemoteParameters
import pytest
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParametersAtomically
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


@pytest.fixture
def hears_late():
    """Start a node that answers its first request only when the test has ended."""
    context = rclpy.Context()
    rclpy.init(context=context)
    node = Node('slow', context=context)
    node.destroy_service(next(one for one in node.services if one.srv_name.endswith(
        'set_parameters_atomically')))
    node.declare_parameter('speed', 1)
    ended, seen = threading.Event(), []

    def answer(request, response):
        seen.append(request)
        if len(seen) == 1:
            ended.wait(20.0)
        response.result = SetParametersResult(successful=True)
        return response

    node.create_service(SetParametersAtomically, '~/set_parameters_atomically', answer,
                        callback_group=ReentrantCallbackGroup())
    executor = MultiThreadedExecutor(4, context=context)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    yield seen
    ended.set()
    executor.shutdown()
    rclpy.shutdown(context=context)
    thread.join(10.0)


def test_a_lost_answer_is_asked_for_once_more(ros, hears_late):
    remote = RemoteParameters(ros.node, '/slow', [], lambda: None)
    ros.spin_until(lambda: remote.ask() or remote.is_known, 20.0)
    answer = remote.change({'speed': 2})
    ros.spin_until(lambda: remote.ask() or answer.done(), 10.0)
    assert answer.result() == {'speed': 2} and len(hears_late) == 2
    remote.close()
