# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What a demo has for itself: a ROS domain, a port and the file of its picture."""

import fcntl
import os
import socket
import tempfile
from zlib import crc32

# Bytes of the lock file: a domain is its own number, a port as well, a file comes behind both.
DOMAINS, PORTS, FILES = range(1, 102), range(8080, 8180), 100_000


class Claims:
    """
    Claims what no other demo of this user has; it is free again when the process ends.

    The tests claim their ROS domains in the same file.
    """

    def __init__(self):
        path = os.path.join(tempfile.gettempdir(), f'camera_to_base_test_domains_{os.getuid()}')
        try:
            self._locks = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        except OSError:
            self._locks = None

    def domain(self):
        """Return the number of a ROS domain."""
        first = os.getpid() % len(DOMAINS)
        return next(filter(self._claim, [*DOMAINS[first:], *DOMAINS[:first]]), DOMAINS[first])

    def port(self):
        """Return a free port, the usual one if it is free; 0 for any one if there is none."""
        return next((port for port in PORTS if self._claim(port) and is_free(port)), 0)

    def file(self, path):  # noqa: A003
        """Return the path, or one beside it with a number if another demo writes to it."""
        stem, ending = os.path.splitext(os.path.abspath(path))
        paths = (f'{stem}{number}{ending}' for number in ('', *(f'_{n}' for n in range(2, 102))))
        return next((one for one in paths if self._claim(FILES + crc32(one.encode()))), path)

    def _claim(self, number):
        if self._locks is None:
            return True
        try:
            fcntl.lockf(self._locks, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, number)
        except OSError:
            return False
        return True


def is_free(port):
    """Tell whether a port of this machine can be listened on."""
    with socket.socket() as one:
        one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            one.bind(('127.0.0.1', port))
        except OSError:
            return False
    return True
