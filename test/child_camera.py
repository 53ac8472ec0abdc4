# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A stream server in a process of its own: what can be killed by -9 and stopped for real."""

import argparse
import os
import signal
import subprocess
import sys
import time

import scenes


class ChildCamera:
    """
    A server's script, running; `freeze` stops the whole process, as a camera that hangs.

    :param script: 'mjpeg_server' or 'rtsp_server'.
    :param scene: A name of `scenes.SCENES`.
    """

    def __init__(self, script, scene='coin', rate=20.0, port=0):
        self._command = [sys.executable, os.path.join(os.path.dirname(__file__), f'{script}.py'),
                         '--scene', scene, '--rate', str(rate)]
        self.port = port
        self._has_disc = False
        self.start()

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.kill()

    def start(self):
        """Start it, on the same port as before; a disc that was there is there again at once."""
        self._process = subprocess.Popen(
            [*self._command, '--port', str(self.port), *(['--disc'] if self._has_disc else [])],
            stdout=subprocess.PIPE, text=True)
        self.url = self._process.stdout.readline().strip()
        self.port = int(self.url.split(':')[2].split('/')[0])

    def show_disc(self):
        """Put the clock's disc on its table, which is empty until then."""
        self._has_disc = True
        self._process.send_signal(signal.SIGUSR1)

    def kill(self):
        """End it as `kill -9` does."""
        self._process.kill()
        self._process.wait()
        self._process.stdout.close()

    def freeze(self):
        """Stop the process; the kernel keeps its connections open."""
        self._process.send_signal(signal.SIGSTOP)

    def thaw(self):
        """Go on."""
        self._process.send_signal(signal.SIGCONT)


def main(server_class):
    """Serve a scene until killed; the URL is printed first."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--scene', default='coin', choices=sorted(scenes.SCENES))
    parser.add_argument('--rate', type=float, default=20.0)
    parser.add_argument('--port', type=int, default=0)
    parser.add_argument('--disc', action='store_true', help='at once, not from SIGUSR1 on')
    arguments = parser.parse_args()
    take_frame = scenes.SCENES[arguments.scene](arguments.rate)
    if arguments.disc:
        take_frame.has_disc = True
    signal.signal(signal.SIGUSR1, lambda *_: setattr(take_frame, 'has_disc', True))
    with server_class(take_frame, arguments.rate, arguments.port) as server:
        print(server.url, flush=True)
        while True:
            time.sleep(1.0)
