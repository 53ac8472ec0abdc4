# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A slow network: passes on what comes to a port, with so many bytes in a second."""

import asyncio
import threading

CHUNK = 1000


class SlowLine:
    """
    Passes connections on to another port of this machine, with a limit for all together.

    :param target: The other port.
    :param bytes_per_s: In the direction to the client, may be changed; the other one is fast.
    """

    def __init__(self, target, bytes_per_s):
        self._target, self.bytes_per_s = target, bytes_per_s
        self._loop = asyncio.new_event_loop()
        self._turn = asyncio.Lock()
        threading.Thread(target=self._loop.run_forever, daemon=True).start()
        self._server = asyncio.run_coroutine_threadsafe(
            asyncio.start_server(self._on_client, 'localhost', 0), self._loop).result()
        self.port = self._server.sockets[0].getsockname()[1]

    def close(self):
        """End all connections."""
        asyncio.run_coroutine_threadsafe(self._end(), self._loop).result()
        self._loop.call_soon_threadsafe(self._loop.stop)

    async def _end(self):
        self._server.close()
        tasks = asyncio.all_tasks() - {asyncio.current_task()}
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _on_client(self, reader, writer):
        # Small buffers: what waits, waits at the server.
        far_reader, far_writer = await asyncio.open_connection(
            'localhost', self._target, limit=4 * CHUNK)
        try:
            await asyncio.gather(self._pass(reader, far_writer, False),
                                 self._pass(far_reader, writer, True),
                                 return_exceptions=True)
        except asyncio.CancelledError:
            pass  # The line is closed.

    async def _pass(self, reader, writer, is_slow):
        while content := await reader.read(CHUNK):
            if is_slow:
                async with self._turn:
                    await asyncio.sleep(len(content) / self.bytes_per_s)
            writer.write(content)
            await writer.drain()
        writer.close()
