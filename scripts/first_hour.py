# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Runs the commands of README.md in their order, in a clean clone and an empty environment."""

import os
from pathlib import Path
import pty
import re
import select
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from demo_claims import Claims

ROOT = Path(__file__).resolve().parents[1]
JAZZY = Path('/opt/ros/jazzy/setup.bash')
# What README says to write in the place of a camera, to practise.
CAMERA, PRACTICE = '--camera 0', '--camera simulated'
LARGEST_ERROR_MM, LEAST_POSITIONS = 1.0, 10
LONGEST_S = {'setup': 900.0, 'command': 300.0, 'nodes': 60.0}
CONTROL_CODES = re.compile(r'\x1b\[[0-9;?]*[A-Za-z]')

# Stand-ins for the ros2 command line, with rclpy.
ECHO = """
import importlib, rclpy, sys, time
topic, kind, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
rclpy.init()
node, seen, until = rclpy.create_node('stranger'), [], time.monotonic() + 60
while not kind and time.monotonic() < until:
    rclpy.spin_once(node, timeout_sec=0.1)
    kind = dict(node.get_topic_names_and_types()).get(topic, [''])[0]
package, _, name = kind.replace('/', '.').rpartition('.')
kind = getattr(importlib.import_module(package), name)
node.create_subscription(kind, topic, seen.append, 10)
while len(seen) < count and time.monotonic() < until:
    rclpy.spin_once(node, timeout_sec=0.1)
print(*seen[:count], sep='\\n---\\n')
sys.exit(len(seen) < count)
"""
CALL = """
import rclpy, sys
from std_srvs.srv import Trigger
rclpy.init()
node = rclpy.create_node('stranger')
client = node.create_client(Trigger, sys.argv[1])
assert client.wait_for_service(30.0), 'no such service'
answer = client.call_async(Trigger.Request())
rclpy.spin_until_future_complete(node, answer, timeout_sec=30.0)
print(answer.result())
sys.exit(not answer.result().success)
"""
# The true positions are in the camera frame of the tutorial's numbers.
PROVE = """
import math, rclpy, time
from geometry_msgs.msg import PointStamped, PoseArray
rclpy.init()
node, found, true = rclpy.create_node('stranger'), {}, {}
stamp = lambda message: (message.header.stamp.sec, message.header.stamp.nanosec)
node.create_subscription(PointStamped, 'pos_in_robot_base_frame/point', lambda message: (
    found.update({stamp(message): (100 * message.point.x, 100 * message.point.y)})), 10)
node.create_subscription(PoseArray, 'true_objects_in_cam_frame', lambda message: true.update({
    stamp(message): [(100 * pose.position.x - 17.8, 24.4 - 100 * pose.position.y)
                     for pose in message.poses]}), 10)
until = time.monotonic() + 60
while len(found.keys() & true.keys()) < 40 and time.monotonic() < until:
    rclpy.spin_once(node, timeout_sec=0.1)
errors = [10 * min(math.dist(found[at], point) for point in true[at])
          for at in found.keys() & true.keys()]
print(len(errors), max(errors, default=math.inf))
"""


class Failure(Exception):
    """A command of README does not do what README says."""


class Stranger:
    """
    Somebody who has a clone and an empty home folder, and types what README says.

    :param home: The home folder; the clone is in it.
    :param with_tests: Whether to run the tests, too.
    """

    def __init__(self, home, with_tests):
        self._home, self._with_tests = home, with_tests
        self._clone = self._folder = home / 'camera_to_base'
        self._environment = {
            'PATH': '/usr/bin:/bin', 'HOME': str(home), 'PYTHON': sys.executable,
            'LANG': 'C.UTF-8', 'TERM': 'xterm', 'PYTHONUNBUFFERED': '1',
            # Nobody else hears the nodes.
            'ROS_DOMAIN_ID': str(Claims().domain()), 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
        self._sourced = 'true'
        self._has_ros2 = False
        self._background = []
        self.not_run = []

    def demo(self, command):
        """Run the demo for 10 s, and end it with Ctrl-C."""
        began = time.monotonic()
        # Without its domain, it chooses one of its own.
        demo = self._start(f'unset ROS_DOMAIN_ID; exec {command}', cwd=self._clone)
        first_at, is_told = None, False
        while demo.poll() is None:
            demo.read(0.2)
            if first_at is None and 'error' in demo.printed and ' mm' in demo.printed:
                first_at = time.monotonic()
                tell(f'the first position came after {first_at - began:.0f} s')
            if first_at and time.monotonic() - first_at > 10.0 and not is_told:
                is_told = True
                os.killpg(demo.pid, signal.SIGINT)
            if time.monotonic() - began > LONGEST_S['setup']:
                demo.end()
                raise Failure(f'no position came, or it does not end:\n{demo.printed[-3000:]}')
        demo.read(0.2)
        summary = re.search(r'(\d+) positions, largest error ([\d.]+) mm', demo.printed)
        if demo.returncode or not summary:
            raise Failure(f'exit code {demo.returncode}:\n{demo.printed[-3000:]}')
        judge(int(summary[1]), float(summary[2]))
        if not re.search(r'\| http://\S+', demo.printed):
            raise Failure(f'no address of a page:\n{demo.printed[-3000:]}')
        if not (self._clone / 'demo.png').exists():
            raise Failure('there is no demo.png')
        self._use_wheels()

    def test(self, command):
        """Run the tests, if it is asked for."""
        if not self._with_tests:
            self._leave_out(command, 'the tests are run by others; --tests runs them here, too')
            return
        self._do(command, LONGEST_S['setup'], cwd=self._clone)

    def shell(self, command):
        """Run a command that needs nothing but a shell; a `cd` holds for those that follow."""
        self._do(command, LONGEST_S['setup'])
        if command.startswith('cd '):
            self._folder = Path(os.path.expanduser(
                command[3:].strip().replace('~', str(self._home))))

    def clone(self, command):
        """Clone into the workspace, from the folder that contains the checkout."""
        self._folder = self._clone.parent
        self._do(command, LONGEST_S['command'])

    def source(self, command):
        """Source ROS 2, or what colcon has built."""
        if str(JAZZY) in command and not JAZZY.exists():
            self._leave_out(command, 'ROS 2 from PyPI is used: there is no such file')
            return
        path = command.split(maxsplit=1)[1]
        path = path if path.startswith('/') else f'{self._folder}/{path}'
        self._sourced += f' && set +u && . {shlex.quote(path)}'
        self._do('true', LONGEST_S['command'])
        self._has_ros2 = self._do('command -v ros2 || true', 10.0).strip() != ''

    def rosdep(self, command):
        """Install what is missing, where rosdep is."""
        if not JAZZY.exists() or not shutil.which('rosdep', path='/usr/bin:/bin'):
            self._leave_out(command, 'rosdep is not installed')
            return
        self._do(command, LONGEST_S['setup'])

    def launch(self, command):
        """Start both nodes, and leave them running."""
        self.end_nodes()
        if self._has_ros2:
            self._background = [self._start(f'exec {command}')]
            return
        tell(f'stand-in for: {command}')
        given = dict(word.split(':=', 1) for word in shlex.split(command) if ':=' in word)
        file = given.pop('params_file', None)
        arguments = ['--ros-args', *(['--params-file', file] if file else [])]
        arguments += [word for name, value in given.items() for word in ('-p', f'{name}:={value}')]
        for node in ('robot_base_publisher', 'camera_publisher'):
            mine = arguments if node == 'camera_publisher' or file else ['--ros-args']
            self._background.append(self._start(
                f'exec {self._executable(node)} {shlex.join(mine)}'))

    def echo(self, command):
        """Read a message of a topic, and tell whether positions are right."""
        words = [word for word in shlex.split(command)[3:] if not word.startswith('-')]
        if self._has_ros2:
            once = command if '--once' in command else f'{command} --once'
            printed = self._do(f'timeout 60 {once}', LONGEST_S['nodes'] + 10)
        else:
            tell(f'stand-in for: {command}')
            printed = self._python(ECHO, words[0], words[1] if len(words) > 1 else '', '1')
        if not printed.strip():
            raise Failure('no message came')
        if 'params_file' in ' '.join(one.command for one in self._background) or (
                '--params-file' in ' '.join(one.command for one in self._background)):
            self.prove()

    def prove(self):
        """Compare published positions with the true ones."""
        count, largest = self._python(PROVE).split()[-2:]
        judge(int(count), float(largest))

    def service(self, command):
        """Call a service that triggers something."""
        if self._has_ros2:
            printed = self._do(f'timeout 60 {command}', LONGEST_S['nodes'] + 10)
            if 'success=True' not in printed:
                raise Failure(printed)
            return
        tell(f'stand-in for: {command}')
        self._python(CALL, shlex.split(command)[3])

    def calibrate(self, command):
        """Run `calibrate` in a terminal, and type what the simulated robot's display shows."""
        self.end_nodes()
        command = command.replace(CAMERA, PRACTICE)
        if not self._has_ros2:
            tell(f'stand-in for: {command}')
            command = command.replace(
                'ros2 run camera_to_base calibrate', self._executable('calibrate'))
        process = self._start(f'exec {command}')
        printed, line, until = '', '', time.monotonic() + LONGEST_S['command']
        while process.poll() is None:
            new = CONTROL_CODES.sub('', process.read(0.2))
            printed, line = printed + new, (line + new)[-4000:]
            if line.rstrip(' ').endswith((':', '?')) and not new:
                shown = re.findall(r'shows:? x (\S+), y (\S+) cm', printed)
                is_touch = 'Touch' in line
                process.write('{} {}\n'.format(*shown[-1]) if is_touch and shown else '\n')
                line = ''
            if time.monotonic() > until:
                process.end()
                raise Failure(f'it does not end:\n{printed[-3000:]}')
        printed += CONTROL_CODES.sub('', process.read(0.2))
        written = re.search(r' -o (\S+)', command)
        if process.returncode or written and not (self._folder / written[1]).exists():
            raise Failure(f'exit code {process.returncode}:\n{printed[-3000:]}')

    def end_nodes(self):
        """End what runs with Ctrl-C."""
        ended, self._background = self._background, []
        codes = [process.end() for process in ended]
        if any(codes):
            raise Failure(f'the nodes ended with {codes}:\n'
                          + '\n'.join(process.printed[-3000:] for process in ended))

    def close(self):
        """End everything."""
        for process in self._background:
            process.end()

    def _use_wheels(self):
        if not JAZZY.exists():
            venv = self._clone / '.venv'
            self._environment.update(
                PATH=f'{venv}/bin:/usr/bin:/bin', AMENT_PREFIX_PATH=str(venv))

    def _leave_out(self, command, why):
        self.not_run.append(f'{command}: {why}')

    def _executable(self, name):
        prefix = self._do('echo "$AMENT_PREFIX_PATH"', 10.0).strip().split(':')
        paths = (Path(one) / 'lib/camera_to_base' / name for one in prefix)
        return next(str(path) for path in paths if path.exists())

    def _python(self, program, *arguments):
        words = shlex.join(['-c', program, *arguments])
        return self._do(f'python3 {words}', LONGEST_S['nodes'] + 40, shown='python3')

    def _do(self, command, longest_s, cwd=None, shown=None):
        process = subprocess.run(
            ['bash', '-c', f'{self._sourced} && {command}'], cwd=cwd or self._folder,
            env=self._environment, text=True, capture_output=True, timeout=longest_s)
        if process.returncode:
            raise Failure(f'{shown or command} ended with {process.returncode}:\n'
                          f'{process.stdout[-1500:]}{process.stderr[-1500:]}')
        return process.stdout

    def _start(self, command, cwd=None):
        return Terminal(command, ['bash', '-c', f'{self._sourced} && {command}'],
                        cwd or self._folder, self._environment)


class Terminal(subprocess.Popen):
    """A process in a terminal of its own."""

    def __init__(self, command, arguments, cwd, environment):
        self.command, self.printed = command, ''
        self._ours, theirs = pty.openpty()
        super().__init__(arguments, cwd=cwd, env=environment, stdin=theirs, stdout=theirs,
                         stderr=theirs, start_new_session=True)
        os.close(theirs)

    def read(self, longest_s):
        """Return what was printed; wait for it for a time at most."""
        printed = b''
        while select.select([self._ours], [], [], longest_s if not printed else 0.0)[0]:
            try:
                new = os.read(self._ours, 65536)
            except OSError:  # the process has ended
                new = b''
            if not new:
                time.sleep(longest_s)
                break
            printed += new
        text = printed.decode(errors='replace')
        self.printed += text
        return text

    def write(self, text):
        """Type a text."""
        os.write(self._ours, text.encode())

    def end(self):
        """Press Ctrl-C, and return the exit code; what it has printed is in `printed`."""
        if self.poll() is None:
            os.killpg(self.pid, signal.SIGINT)
        until = time.monotonic() + 20.0
        while self.poll() is None and time.monotonic() < until:
            self.read(0.1)
        if self.poll() is None:
            os.killpg(self.pid, signal.SIGKILL)
        code = self.wait()
        self.read(0.1)
        return code


def judge(count, largest_mm):
    """Refuse too few positions, and wrong ones."""
    tell(f'{count} positions, largest error {largest_mm:.2f} mm')
    if count < LEAST_POSITIONS or not largest_mm < LARGEST_ERROR_MM:
        raise Failure(f'expected {LEAST_POSITIONS} positions or more, and less than '
                      f'{LARGEST_ERROR_MM:g} mm')


def tell(line):
    """Print a line."""
    print(f'    {line}', flush=True)


# What a command of README begins with, and what the stranger does; each must be there.
STEPS = [
    ('scripts/demo', Stranger.demo), ('scripts/test', Stranger.test),
    ('mkdir', Stranger.shell), ('git clone', Stranger.clone), ('cd ~/ros2_ws', Stranger.shell),
    ('source ', Stranger.source), ('rosdep install', Stranger.rosdep),
    ('colcon build', Stranger.shell),
    ('ros2 launch camera_to_base camera_to_base.launch.py source:=simulated', Stranger.launch),
    ('ros2 service call', Stranger.service),
    ('ros2 run camera_to_base calibrate sheet', Stranger.calibrate),
    ('ros2 run camera_to_base calibrate board', Stranger.calibrate),
    ('ros2 run camera_to_base calibrate base', Stranger.calibrate),
    ('ros2 launch camera_to_base camera_to_base.launch.py params_file:=cell.yaml',
     Stranger.launch),
    ('ros2 topic echo', Stranger.echo)]


def commands_of(page):
    """Give the commands of a page's indented blocks, in their order."""
    starts = tuple(start for start, _ in STEPS) + ('ros2 ', 'colcon ')
    lines = re.findall(r'^ {4,}(\S.*)$', page, re.MULTILINE)
    return [line.split('  #')[0].strip() for line in lines if line.startswith(starts)]


def main(arguments):
    """Do all that README says; return the exit code."""
    page = (ROOT / 'README.md').read_text()
    commands = commands_of(page)
    gone = [start for start, _ in STEPS if not any(one.startswith(start) for one in commands)]
    if gone or f'`{PRACTICE}` instead of `{CAMERA}`' not in page:
        print('error: README.md has no command any more that begins with '
              + ', '.join(gone or [PRACTICE]), file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory(prefix='first_hour_') as home:
        stranger = Stranger(Path(home), '--tests' in arguments)
        try:
            subprocess.run(['git', 'clone', '--quiet', str(ROOT), f'{home}/camera_to_base'],
                           check=True)
            for command in commands:
                follow(stranger, command)
            stranger.end_nodes()
        except (Failure, subprocess.SubprocessError) as error:
            print(f'error: {error}', file=sys.stderr)
            return 1
        finally:
            stranger.close()
    print(f'README.md does what it says: {len(commands)} commands, {len(stranger.not_run)} of '
          'them not run:')
    for line in stranger.not_run:
        tell(line)
    return 0


def follow(stranger, command):
    """Do one command."""
    print(f'$ {command}', flush=True)
    began = time.monotonic()
    step = next((step for start, step in STEPS if command.startswith(start)), None)
    if step is None:
        stranger.not_run.append(f'{command}: not known here')
        return
    try:
        step(stranger, command)
    except Failure as error:
        raise Failure(f'{command}: {error}') from error
    tell(f'{time.monotonic() - began:.0f} s')


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
