# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import fcntl
import os
import signal
import tempfile

import pytest


def claim_domain():
    """
    Choose a ROS domain that no other test process of this user has.

    The lock is held until the process ends: the workers of pytest-xdist and the test runs in other
    checkouts get domains of their own.

    :returns: The number, 1 to 101, and the file descriptor that holds its lock.
    """
    path = os.path.join(tempfile.gettempdir(), f'camera_to_base_test_domains_{os.getuid()}')
    locks = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    for offset in range(101):
        domain = 1 + (os.getpid() + offset) % 101
        try:
            fcntl.lockf(locks, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, domain)
        except OSError:
            continue
        return domain, locks
    raise RuntimeError(f'101 test processes hold all ROS domains, see {path}')


# Before numpy is imported: as in the executables, fits start no threads. With two workers on two
# cores they cost twelve times as much.
os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
# Before the first ROS import: messages check their fields, and no other robot hears the tests.
os.environ['ROS_PYTHON_CHECK_FIELDS'] = '1'
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
DOMAIN, DOMAIN_LOCK = claim_domain()
os.environ['ROS_DOMAIN_ID'] = str(DOMAIN)

# How long the short set takes on one core, by the processor time of its tests.
ONE_CORE_MIN = 6
# What the tests measured and how many were left out, for the summary; a worker sends it.
TOLD = pytest.StashKey[list]()
LEFT_OUT = pytest.StashKey[int]()


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
    running = [process for process in processes if process.is_running]
    try:
        for process in running:
            process.end(signal.SIGTERM, 5.0)
    finally:
        # One that hangs must not leave the others to the tests that follow in this domain.
        for process in running:
            if process.is_running:
                process.kill()


@pytest.fixture(scope='session')
def tell(pytestconfig):
    """Give a function that adds a line to the summary at the end of the run."""
    return pytestconfig.stash[TOLD].append


def pytest_addoption(parser):
    """Add --all."""
    parser.addoption('--all', action='store_true', help='run the tests marked slow, too')


def pytest_report_header(config):
    """Say first how long it will take."""
    if config.getoption('all') or config.args != config.getini('testpaths'):
        return None
    workers = getattr(config.option, 'numprocesses', None) or 1
    minutes = ONE_CORE_MIN / min(workers, 2)
    return f'the short set takes about {minutes:.0f} minutes with {workers} worker(s)'


def pytest_configure(config):
    """Prepare what the summary prints."""
    config.stash[TOLD] = []
    config.stash[LEFT_OUT] = 0


def pytest_collection_modifyitems(config, items):
    """
    Leave the slow tests out; run a test that talks to other nodes again where it took too long.

    How long discovery takes is up to the middleware and the machine: such a test is run three
    times at most. What was published is not: a wrong position fails the test, be it the only one
    of a thousand.
    """
    for item in items:
        if {'ros', 'start'} & set(getattr(item, 'fixturenames', ())):
            item.add_marker(pytest.mark.flaky(reruns=2, only_rerun=['NotInTime']))
    if not config.getoption('all') and 'slow' not in config.getoption('markexpr'):
        slow = [item for item in items if item.get_closest_marker('slow')]
        items[:] = [item for item in items if not item.get_closest_marker('slow')]
        config.stash[LEFT_OUT] = len(slow)
        config.hook.pytest_deselected(items=slow)


def pytest_sessionfinish(session):
    """Send from a worker what the summary prints."""
    if hasattr(session.config, 'workeroutput'):
        session.config.workeroutput['told'] = session.config.stash[TOLD]
        session.config.workeroutput['left out'] = session.config.stash[LEFT_OUT]


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    """Receive from a worker what the summary prints; all workers collect the same tests."""
    output = getattr(node, 'workeroutput', {})
    node.config.stash[TOLD].extend(output.get('told', []))
    node.config.stash[LEFT_OUT] = output.get('left out', 0)


def pytest_terminal_summary(terminalreporter, config):
    """Print what was measured, how many tests were run again, and how many were left out."""
    for line in config.stash[TOLD]:
        terminalreporter.write_line(line)
    again = [report.nodeid for report in terminalreporter.stats.get('rerun', [])]
    terminalreporter.write_line(' '.join([f'run again: {len(again)}', *again]))
    if config.stash[LEFT_OUT]:
        terminalreporter.write_line(
            f'left out: {config.stash[LEFT_OUT]} slow tests; scripts/test --all runs them, too')
