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

import os
import signal

import pytest

# Before the first ROS import: messages check their fields, and no other robot hears the tests.
os.environ['ROS_PYTHON_CHECK_FIELDS'] = '1'
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
os.environ['ROS_DOMAIN_ID'] = str(1 + os.getpid() % 100)


@pytest.fixture
def ros():
    """Give a ROS context of its own to a test."""
    from ros_helpers import Ros
    ros = Ros()
    yield ros
    ros.close()


@pytest.fixture
def start():
    """Start installed executables, and leave none behind."""
    from ros_helpers import Process
    processes = []

    def start_one(executable, *arguments):
        processes.append(Process(executable, *arguments))
        return processes[-1]

    yield start_one
    for process in processes:
        if process.is_running:
            process.end(signal.SIGTERM, 5.0)


@pytest.fixture(scope='session')
def tell(request):
    """Give a function that prints a line although pytest captures what is printed."""
    def print_uncaptured(text):
        manager = request.config.pluginmanager.getplugin('capturemanager')
        with manager.global_and_fixture_disabled():
            print(f'\n{text}')

    return print_uncaptured


def pytest_configure(config):
    """Know the marker where pytest-rerunfailures, which colcon brings along, is not installed."""
    config.addinivalue_line('markers', 'flaky: run again if it fails')


def pytest_collection_modifyitems(items):
    """
    Run a test that talks to other nodes again where something took too long, twice at most.

    How long discovery takes is up to the middleware and the machine. What was published is not: a
    wrong position fails the test, be it the only one of a thousand.
    """
    for item in items:
        if {'ros', 'start'} & set(getattr(item, 'fixturenames', ())):
            item.add_marker(pytest.mark.flaky(reruns=2, only_rerun=['NotInTime']))
