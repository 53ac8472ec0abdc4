# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What all requests have in common: who may use the page, errors as JSON, and the page itself."""

import hmac
import http.client
import ipaddress
import json
from pathlib import Path
import socket
from typing import Any, Dict, Optional, Set, Tuple
from urllib.parse import urlsplit

from camera_to_base.dashboard.specs import is_loopback
from camera_to_base.errors import CameraToBaseError
import tornado.web

# No page of another site may frame this one, and no script or picture comes from elsewhere.
_HEADERS = {
    'Content-Security-Policy': (
        "default-src 'self'; img-src 'self' blob: data:; connect-src 'self'; style-src 'self'; "
        "frame-ancestors 'none'; base-uri 'none'; form-action 'self'"),
    'X-Content-Type-Options': 'nosniff', 'X-Frame-Options': 'DENY',
    'Referrer-Policy': 'no-referrer', 'Cross-Origin-Resource-Policy': 'same-origin',
    'Cache-Control': 'no-store'}
NEEDS_TOKEN = (
    'this page needs the token: open the address that the dashboard has printed at its start, '
    'with ?token=… at its end')


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
        scheme, _, netloc = origin.partition('://')
        if scheme in ('http', 'https') and '/' not in netloc \
                and _split(netloc) == _split(host_header) != _NOWHERE:
            return None
        return f"the page '{origin:.80}' is not the dashboard: open the dashboard's own page"

    def knows_token(self, *given: Optional[str]) -> bool:
        """Return whether one of the given texts is the token, or none is needed."""
        wanted = self._token.encode()
        return not wanted or any(
            hmac.compare_digest(one.encode(), wanted) for one in given if one)


_NOWHERE = '', None


def _split(netloc: Optional[str]) -> Tuple[str, Optional[int]]:
    try:
        parts = urlsplit(f'//{netloc or ""}')
        return (parts.hostname or '').rstrip('.'), parts.port
    except ValueError:
        return _NOWHERE


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


class Refused(tornado.web.HTTPError):
    """A request that is answered with a sentence."""

    def __init__(self, status: int, sentence: str, **more: Any) -> None:
        super().__init__(status)
        self.data = {'error': sentence, **more}


class Guarded(tornado.web.RequestHandler):
    """A request that is checked before it is served."""

    @property
    def access(self) -> Access:
        """The checks."""
        return self.settings['access']

    @property
    def cookie_name(self) -> str:
        """Name of the cookie with the token: browsers share cookies between ports."""
        return f'camera_to_base_{self.settings["port"]}'

    def set_default_headers(self) -> None:
        """Send the headers of every answer."""
        for name, value in _HEADERS.items():
            self.set_header(name, value)
        self.clear_header('Server')

    def prepare(self) -> None:
        """Check host, origin and token."""
        headers = self.request.headers
        refusal = self.access.host_refusal(headers.get('Host'))
        if refusal is None and self._changes_something():
            refusal = self.access.origin_refusal(headers.get('Origin'), headers.get('Host'))
        if refusal is not None:
            raise Refused(403, refusal)
        if not self.access.knows_token(
                self.get_cookie(self.cookie_name), headers.get('X-Token'), self._query_token()):
            self.refuse_token()

    def refuse_token(self) -> None:
        """
        Refuse a request without the token.

        :raises Refused: Always.
        """
        raise Refused(403, NEEDS_TOKEN)

    def write_error(self, status_code: int, **details: Any) -> None:
        """Answer with the error as JSON: one sentence."""
        self.finish(json.dumps(self._error(status_code, details.get('exc_info'))))

    def log_exception(self, typ: Any, value: Any, tb: Any) -> None:
        """Log defects alone: a refused request is the page's matter."""
        if not isinstance(value, (tornado.web.HTTPError, CameraToBaseError)):
            super().log_exception(typ, value, tb)

    def _changes_something(self) -> bool:
        is_socket = self.request.headers.get('Upgrade', '').lower() == 'websocket'
        return is_socket or self.request.method not in ('GET', 'HEAD')

    def _query_token(self) -> Optional[str]:
        # In the address of the page alone: other addresses are not typed.
        return self.get_query_argument('token', None) if self.request.path == '/' else None

    def _error(self, status: int, exc_info: Any) -> Dict[str, Any]:
        self.set_header('Content-Type', 'application/json')
        error = exc_info[1] if exc_info else None
        if isinstance(error, Refused):
            return error.data
        if status == 404:
            return {'error': f'there is no {self.request.path:.80}'}
        if status < 500:
            name = http.client.responses.get(status, 'refused').lower()
            return {'error': f'the dashboard does not serve this request: {name} (HTTP {status})'}
        return {'error': f'the dashboard has a defect (HTTP {status}): its terminal says which'}


WEB = Path(__file__).parents[1] / 'web'


class Page(Guarded):
    """The page itself; a token in its address becomes a cookie."""

    def get(self) -> None:
        """Answer with the page."""
        token = self.get_query_argument('token', None)
        if token is not None:
            if self.access.needs_token:
                self.set_cookie(self.cookie_name, token, httponly=True, samesite='Strict')
            self.redirect('/')
            return
        self.set_header('Content-Type', 'text/html; charset=UTF-8')
        self.finish((WEB / 'index.html').read_bytes())


class WebFile(Guarded, tornado.web.StaticFileHandler):
    """A file of the page."""

    def parse_url_path(self, url_path: str) -> str:
        """Return the path below the page's folder; one that no file can have is not found."""
        if '\0' in url_path or not url_path.isprintable():
            raise Refused(404, 'there is no such file')
        return super().parse_url_path(url_path)

    def set_extra_headers(self, path: str) -> None:
        """Let the browser ask whether a file has changed."""
        self.set_header('Cache-Control', 'no-cache')

    def get_content_type(self) -> str:
        """Return a file's type, whatever this machine's tables say."""
        return _TYPES.get(Path(self.absolute_path).suffix) or super().get_content_type()


_TYPES = {'.js': 'text/javascript; charset=UTF-8', '.css': 'text/css; charset=UTF-8',
          '.svg': 'image/svg+xml', '.png': 'image/png', '.html': 'text/html; charset=UTF-8'}
