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

"""Who may use the dashboard: the checks of each request, without tornado."""

import hmac
import ipaddress
import socket
from typing import Optional, Set, Tuple
from urllib.parse import urlsplit

from camera_to_base.dashboard.specs import is_loopback


class Access:
    """
    Checks hosts, origins and tokens.

    :param host: The address that the server listens on.
    :param token: What a page must know; '' if it needs nothing.
    """

    def __init__(self, host: str, token: str) -> None:
        self._token = token
        self._is_local = is_loopback(host)
        self._names = {'localhost'} if self._is_local else _own_names()

    @property
    def needs_token(self) -> bool:
        """Whether a page must know the token."""
        return bool(self._token)

    def host_refusal(self, host_header: Optional[str]) -> Optional[str]:
        """
        Say why a request's Host header is refused; None if it is accepted.

        A page of another site whose name is made to lead here (DNS rebinding) sends that name.
        """
        name = _split(host_header)[0]
        if name in self._names or _is_address(name) and (
                not self._is_local or is_loopback(name)):
            return None
        return (f"the dashboard is not '{name:.80}': open it by the address that it has printed "
                'at its start')

    def origin_refusal(
        self, origin: Optional[str], host_header: Optional[str]
    ) -> Optional[str]:
        """
        Say why a request that changes something, or a WebSocket, is refused; None if it is not.

        Browsers name the page that a request comes from; it must be the dashboard's own.
        """
        if origin is None:
            return 'a request that changes something needs the header Origin, as browsers send it'
        parts = urlsplit(origin)
        if parts.scheme in ('http', 'https') and _split(parts.netloc) == _split(host_header):
            return None
        return f"the page '{origin:.80}' is not the dashboard: open the dashboard's own page"

    def knows_token(self, *given: Optional[str]) -> bool:
        """Return whether one of the given texts is the token, or none is needed."""
        wanted = self._token.encode()
        return not wanted or any(
            hmac.compare_digest(one.encode(), wanted) for one in given if one)


def _split(netloc: Optional[str]) -> Tuple[str, Optional[int]]:
    try:
        parts = urlsplit(f'//{netloc or ""}')
        return (parts.hostname or '').rstrip('.'), parts.port
    except ValueError:
        return '', None


def _is_address(name: str) -> bool:
    # An address is no name that somebody could make to lead elsewhere.
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _own_names() -> Set[str]:
    name = socket.gethostname().lower()
    return {'localhost', name, f'{name}.local', socket.getfqdn().lower()}
