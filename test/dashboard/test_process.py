# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""The dashboard as a process: start, port, signals and exit codes."""

import re
import signal
import socket
import time
import urllib.request

import pytest
from ros_helpers import assert_in_time


def address_of(process):
    """Wait for the line with the address, and return it."""
    for line in process._process.stdout:
        found = re.search(r'the dashboard is at (http://\S+)', line)
        if found:
            return found[1]
    raise AssertionError('no address was printed')


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_it_serves_its_page_and_ends_in_a_second_with_0(start, number):
    process = start('dashboard', '-p', 'port:=0')
    url = address_of(process)
    with urllib.request.urlopen(url) as answer:
        assert b'<title>' in answer.read()
    begin = time.monotonic()
    assert process.end(number) == 0
    assert_in_time(time.monotonic() - begin, 1.0)
    assert 'Traceback' not in process.output and 'ERROR' not in process.output


def test_a_taken_port_is_one_clear_sentence_and_exit_code_1(start):
    with socket.socket() as taken:
        taken.bind(('127.0.0.1', 0))
        taken.listen()
        port = taken.getsockname()[1]
        process = start('dashboard', '-p', f'port:={port}')
        assert process.wait() == 1
    assert len(process.output.splitlines()) == 1
    assert f'cannot listen on 127.0.0.1, port {port}' in process.output


@pytest.mark.slow
@pytest.mark.parametrize('arguments, sentence', [
    (('-p', 'host:=no.such.host.invalid'), 'host must be 127.0.0.1 for this machine alone'),
    (('-p', 'port:=70000'), 'port must be 0 to 65535'),
    (('-p', 'token:=short'), 'token must have at least 16 characters')])
def test_an_impossible_parameter_is_one_clear_sentence_and_exit_code_1(
        start, arguments, sentence):
    process = start('dashboard', *arguments)
    assert process.wait() == 1
    assert sentence in process.output and 'Traceback' not in process.output


def test_an_open_address_is_printed_with_its_token(start):
    process = start('dashboard', '-p', 'port:=0', '-p', 'host:=0.0.0.0')
    url = address_of(process)
    assert re.fullmatch(rf'http://{socket.gethostname()}:\d+/\?token=[\w-]{{32}}', url)
