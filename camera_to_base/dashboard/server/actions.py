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

"""What a page can ask for."""

import json
from typing import Any, Dict

from camera_to_base.dashboard.server.guarded import Guarded, Refused
from camera_to_base.dashboard.server.sockets import checked_cell


class Action(Guarded):
    """A request of a page, answered with JSON."""

    @property
    def cell(self) -> str:
        """The cell that it is about."""
        return checked_cell(self.get_query_argument('cell', '/'))

    @property
    def backend(self) -> Any:
        """What carries it out."""
        return self.settings['backend']

    def body(self) -> Dict[str, Any]:
        """
        Return the request's JSON object.

        :raises Refused: If it is none.
        """
        try:
            body = json.loads(self.request.body or b'{}')
        except ValueError:
            body = None
        if not isinstance(body, dict):
            raise Refused(400, 'expected a JSON object')
        return body

    def answer(self, data: Any) -> None:
        """Answer with JSON."""
        self.set_header('Content-Type', 'application/json')
        self.finish(json.dumps(data))


class Unknown(Action):
    """An address that does not exist."""

    def prepare(self) -> None:
        """Refuse it, after the checks."""
        super().prepare()
        raise Refused(404, f'there is no {self.request.path:.80}')


class SetParameters(Action):
    """Parameters of a node."""

    async def post(self) -> None:
        """Set them, all or none."""
        body = self.body()
        node, values = body.get('node'), body.get('values')
        if node not in ('camera', 'transform') or not isinstance(values, dict) or not values:
            raise Refused(400, 'expected {"node": "camera" or "transform", "values": {…}}')
        self.answer({'values': await self.backend.set_parameters(self.cell, node, values)})


class TakeBackground(Action):
    """The background."""

    async def post(self) -> None:
        """Take it anew."""
        self.answer({'sentence': await self.backend.capture_background(self.cell)})


ACTIONS = [('/api/parameters', SetParameters), ('/api/background', TakeBackground)]
