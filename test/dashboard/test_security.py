# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Who may open the page, and who may change something."""

from contextlib import suppress
import socket

from camera_to_base.dashboard.server.guarded import Access
from dashboard_client import DashboardClient
import pytest
from tornado.httpclient import HTTPClientError

TOKEN = 'a-token-of-enough-characters'
OPEN = ('-p', 'host:=0.0.0.0', '-p', f'token:={TOKEN}')
ACTION = ('/api/background?cell=/', {})


def refusal(page, **headers):
    """Return the sentence with which an action is refused with status 403."""
    status, answer = page.post(*ACTION, **headers)
    assert status == 403
    return answer['error']


def test_this_machine_alone_is_served_without_a_token(dashboard):
    page = dashboard()
    assert page.origin.startswith('http://localhost:') and 'token' not in page.headers
    port = int(page.origin.rpartition(':')[2])
    assert page.fetch('/')[0] == 200
    others = {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None)}
    for address in others - {'127.0.0.1', '::1'}:
        with pytest.raises(OSError):
            socket.create_connection((address, port), timeout=2.0)


@pytest.mark.parametrize('host', ['evil.example', 'evil.example:8080', '192.0.2.7', '', 'a:b:c'])
def test_another_host_name_is_refused_on_this_machine(dashboard, host):
    page = dashboard()
    assert page.fetch('/', Host=host)[0] in (400, 403)
    assert page.fetch('/web/main.js', Host=host)[0] in (400, 403)
    with pytest.raises(HTTPClientError):
        page.socket('/ws/state?cell=/', Host=host)


@pytest.mark.parametrize('host', ['localhost', '127.0.0.1', '[::1]', 'LOCALHOST'])
def test_this_machines_own_names_are_accepted(host):
    assert Access('127.0.0.1', '').host_refusal(f'{host}:8080') is None


def test_other_names_are_refused_on_an_open_address_but_no_addresses():
    access = Access('0.0.0.0', TOKEN)
    assert access.host_refusal('evil.example:8080')
    assert access.host_refusal('192.0.2.7:8080') is None
    assert access.host_refusal(f'{socket.gethostname()}:8080') is None


@pytest.mark.parametrize('origin', [
    'http://evil.example', 'null', None, 'http://localhost:1', 'file://', 'https://localhost'])
def test_a_page_of_another_site_changes_nothing(dashboard, origin):
    page = dashboard()
    assert refusal(page, Origin=origin)
    with pytest.raises(HTTPClientError):
        page.socket('/ws/state?cell=/', Origin=origin)
    with pytest.raises(HTTPClientError):
        page.socket('/ws/picture?cell=/&kind=frame', Origin=origin)


@pytest.mark.parametrize('path', ['/', '/web/main.js', '/api/file', '/nothing'])
def test_nothing_is_read_without_the_token(ros, dashboard, path):
    opened = dashboard(*OPEN)
    page = DashboardClient(ros, opened.origin)
    for headers in ({}, {'X_Token': 'a-token-of-enough-character'}, {'X_Token': 'ü'}):
        status, _, answer = page.fetch(path, **headers)
        assert status == 403 and 'needs the token' in answer['error']
    page.close()


def test_nothing_is_changed_without_the_token(ros, dashboard):
    opened = dashboard(*OPEN)
    page = DashboardClient(ros, opened.origin)
    assert 'needs the token' in refusal(page)
    assert 'needs the token' in refusal(page, X_Token='another-token-that-is-wrong')
    assert opened.post(*ACTION)[0] == 409  # nobody looks at this cell
    socket = page.socket('/ws/state?cell=/')
    assert page.read(socket) is None
    assert socket.close_code == 1008 and 'token' in socket.close_reason
    page.close()


def test_the_token_of_the_address_becomes_a_cookie_that_scripts_cannot_read(ros, dashboard):
    opened = dashboard(*OPEN)
    page = DashboardClient(ros, opened.origin)
    status, headers, _ = page.fetch(f'/?token={TOKEN}')
    assert (status, headers['Location']) == (302, '/')
    cookie = headers['Set-Cookie']
    assert 'HttpOnly' in cookie and 'SameSite=Strict' in cookie
    assert page.fetch('/', Cookie=cookie.partition(';')[0])[0] == 200
    assert page.post(*ACTION, Cookie=cookie.partition(';')[0])[0] == 409
    # A cookie is sent with requests of other sites' pages in some browsers: the origin counts.
    assert 'evil' in refusal(
        page, Cookie=cookie.partition(';')[0], Origin='http://evil.example')
    page.close()


def test_a_token_is_made_anew_at_each_start_where_none_is_given(dashboard):
    tokens = {dashboard('-p', 'host:=0.0.0.0', '-r', f'__node:=one_{number}').headers['X-Token']
              for number in range(2)}
    assert len(tokens) == 2 and min(map(len, tokens)) >= 32


def test_a_request_that_is_too_large_is_refused(dashboard):
    page = dashboard()
    with suppress(OSError):  # the server may close the connection before all is sent
        status, _, _ = page.fetch('/api/parameters?cell=/', b' ' * 1_100_000)
        assert status in (400, 413)
    socket = page.socket('/ws/state?cell=/')
    page.send(socket, 'x' * 20_000)
    while page.read(socket) is not None:
        pass
    assert socket.close_code in (1006, 1009, None)
    assert page.fetch('/')[0] == 200


def test_files_beside_the_page_are_not_served(dashboard):
    page = dashboard()
    for path in ('/web/../dashboard.py', '/web/%2e%2e/dashboard.py', '/web//etc/passwd', '/web/'):
        assert page.fetch(path)[0] in (403, 404)


def test_the_page_may_load_nothing_from_elsewhere_and_not_be_framed(dashboard):
    _, headers, _ = dashboard().fetch('/')
    policy = headers['Content-Security-Policy']
    assert "default-src 'self'" in policy and "frame-ancestors 'none'" in policy
    assert 'unsafe' not in policy and 'http' not in policy
    assert headers['X-Content-Type-Options'] == 'nosniff'
    assert headers['Cache-Control'] == 'no-store' and 'Server' not in headers
