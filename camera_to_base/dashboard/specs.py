# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The parameters of the dashboard."""

import ipaddress
import secrets
from typing import NamedTuple

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import ParameterSpec, Values

_SHORTEST_TOKEN = 16

DASHBOARD_SPECS = [
    ParameterSpec(
        'host', '127.0.0.1',
        'The address that the dashboard listens on: 127.0.0.1 for this machine alone, 0.0.0.0 for '
        'all networks; then a page needs the token that is printed with the address.',
        fixed=True),
    ParameterSpec(
        'port', 8080, 'The TCP port that the dashboard listens on; 0 for any free one.',
        (0, 65535), fixed=True),
    ParameterSpec(
        'token', '',
        'The token that a page needs, at least 16 characters. If it is empty, a new one is made '
        'at each start, and this machine alone needs none.', fixed=True),
    ParameterSpec(
        'params_file', '',
        'The parameter file that Save writes; empty to ask on the page. Nothing is written '
        'outside of its folder.', fixed=True),
    ParameterSpec(
        'params_files', '',
        'With several cells, the parameter file of each: /cell_1=FILE; /cell_2=FILE.',
        fixed=True),
]


class DashboardSettings(NamedTuple):
    """
    Where the dashboard listens, and who may use it.

    :param token: What a page must know; '' if it needs nothing.
    :param params_file: The file that Save writes; '' for none.
    :param params_files: Those of several cells.
    """

    host: str
    port: int
    token: str
    params_file: str
    params_files: str


def dashboard_settings(values: Values) -> DashboardSettings:
    """
    Make the dashboard's settings from its parameters.

    :raises InvalidValueError: If the token is too short.
    """
    token = values['token']
    if token and len(token) < _SHORTEST_TOKEN:
        raise InvalidValueError(
            f'parameter token must have at least {_SHORTEST_TOKEN} characters, got {len(token)}: '
            'leave it out, and one is made')
    if not token and not is_loopback(values['host']):
        token = secrets.token_urlsafe(24)
    return DashboardSettings(
        values['host'], values['port'], token, values['params_file'], values['params_files'])


def is_loopback(host: str) -> bool:
    """Return whether an address can be reached from this machine alone."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == 'localhost'
