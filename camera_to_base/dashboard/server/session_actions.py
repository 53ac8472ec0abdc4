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

"""What a page asks of the sessions: steps of a calibration, reports, sheets and the file."""

from typing import Any, Dict

from camera_to_base.dashboard.server.actions import Action

_TYPES = {'png': 'image/png', 'txt': 'text/plain; charset=utf-8'}


class SessionStep(Action):
    """A step of a session."""

    async def post(self, part: str, name: str) -> None:
        """Carry it out, and answer with the session's new state."""
        self.answer(await self.backend.act(self.cell, part, name, self.body()))


class WholePart(SessionStep):
    """The one step of a part: to save the file, or to set the areas."""

    async def post(self, part: str) -> None:
        """Carry it out, and answer with the part's new state."""
        await super().post(part, {'save': 'save', 'areas': 'set'}[part])


class KeepCorrection(Action):
    """The camera node's correction of a nudge."""

    async def post(self) -> None:
        """Keep it, and answer with the new state of the part `save`."""
        self.answer(await self.backend.keep_correction(self.cell, self.body()))


class ReportPart(Action):
    """A picture or the text of the board's report."""

    async def get(self, name: str) -> None:
        """Answer with it."""
        content = await self.backend.ask_sessions(self.cell, lambda one: one.report(name))
        self.set_header('Content-Type', _TYPES[name.rpartition('.')[2]])
        self.finish(content)


class Sheet(Action):
    """The board to print, or the markers."""

    async def get(self) -> None:
        """Answer with a PDF."""
        options = self._options()
        content = await self.backend.ask_sessions(self.cell, lambda one: one.sheet(options))
        self.set_header('Content-Type', 'application/pdf')
        self.set_header('Content-Disposition', 'inline; filename="sheet.pdf"')
        self.finish(content)

    def _options(self) -> Dict[str, Any]:
        kind = self.get_query_argument('kind', 'board')
        wanted: Dict[str, Any] = {'charuco': kind == 'charuco', 'markers': kind == 'markers'}
        for name in ('paper', 'square_mm'):
            if self.get_query_argument(name, None) is not None:
                wanted[name] = self.get_query_argument(name)
        corners = self.get_query_argument('corners', None)
        return wanted if corners is None else {**wanted, 'corners': corners.lower().split('x')}


class SavedFile(Action):
    """The parameter file as it would be saved."""

    async def get(self) -> None:
        """Answer with its text."""
        text = await self.backend.ask_sessions(self.cell, lambda one: one.file_text())
        self.set_header('Content-Type', 'application/yaml; charset=utf-8')
        self.set_header('Content-Disposition', 'attachment; filename="cell.yaml"')
        self.finish(text)


SESSION_ACTIONS = [
    ('/api/(board|markers|robot|simulated)/([a-z_0-9]+)', SessionStep),
    ('/api/(save|areas)', WholePart), ('/api/correction', KeepCorrection),
    ('/api/report/([a-z]+[.](?:png|txt))', ReportPart), ('/api/sheet', Sheet),
    ('/api/file', SavedFile)]
