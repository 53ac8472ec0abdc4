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

"""The newest picture of each kind, and the pages that wait for the next one."""

from typing import Callable, Dict, NamedTuple, Protocol, Set, Tuple

Key = Tuple[str, str]


class Picture(NamedTuple):
    """
    A picture file in memory.

    :param number: Counts the pictures of a kind.
    """

    number: int
    content: bytes


class Watcher(Protocol):
    """
    A page that looks at a kind of picture.

    `wants` is whether it waits for a picture, `last` the number of the last one that it got.
    """

    wants: bool
    last: int

    def show(self, picture: Picture) -> None:
        """Send a picture."""


class PictureHub:
    """
    Passes each picture on to the pages that wait for one; no page has more than one on its way.

    :param look_at: Called with a cell and a kind when the first page looks.
    :param look_away: Called likewise when the last one has gone.
    """

    def __init__(
        self, look_at: Callable[[str, str], None], look_away: Callable[[str, str], None]
    ) -> None:
        self._look_at, self._look_away = look_at, look_away
        self._newest: Dict[Key, Picture] = {}
        self._watchers: Dict[Key, Set[Watcher]] = {}

    def add(self, key: Key, watcher: Watcher) -> None:
        """Let a page look at a kind of picture."""
        if key not in self._watchers:
            self._watchers[key] = set()
            self._look_at(*key)
        self._watchers[key].add(watcher)

    def remove(self, key: Key, watcher: Watcher) -> None:
        """End that."""
        watchers = self._watchers.get(key, set())
        watchers.discard(watcher)
        if not watchers and self._watchers.pop(key, None) is not None:
            self._newest.pop(key, None)
            self._look_away(*key)

    def want(self, key: Key, watcher: Watcher) -> None:
        """Send the page the newest picture that it does not have, now or when it comes."""
        watcher.wants = True
        self._serve(key, watcher)

    def put(self, key: Key, content: bytes) -> None:
        """Keep a new picture, and send it to those who wait."""
        if key in self._watchers:
            before = self._newest.get(key)
            self._newest[key] = Picture(before.number + 1 if before else 1, content)
            for watcher in self._watchers[key]:
                self._serve(key, watcher)

    def _serve(self, key: Key, watcher: Watcher) -> None:
        newest = self._newest.get(key)
        if watcher.wants and newest is not None and newest.number != watcher.last:
            watcher.wants, watcher.last = False, newest.number
            watcher.show(newest)
