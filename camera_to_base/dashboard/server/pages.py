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

"""The page and its files."""

from pathlib import Path

from camera_to_base.dashboard.server.guarded import Guarded
import tornado.web

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

    def set_extra_headers(self, path: str) -> None:
        """Let the browser ask whether a file has changed."""
        self.set_header('Cache-Control', 'no-cache')

    def get_content_type(self) -> str:
        """Return a file's type, whatever this machine's tables say."""
        return _TYPES.get(Path(self.absolute_path).suffix) or super().get_content_type()


_TYPES = {'.js': 'text/javascript; charset=UTF-8', '.css': 'text/css; charset=UTF-8',
          '.svg': 'image/svg+xml', '.png': 'image/png', '.html': 'text/html; charset=UTF-8'}
