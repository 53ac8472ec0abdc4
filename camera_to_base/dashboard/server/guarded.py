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

"""What all requests have in common: the checks before them, and errors as JSON."""

import json
from typing import Any, Dict, Optional

from camera_to_base.dashboard.server.access import Access
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
        return {'error': f'the dashboard cannot do this (HTTP {status}): its terminal says why'}
