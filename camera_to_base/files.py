# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What every process needs: files written as a whole, signals, and shared memory."""

from contextlib import contextmanager
import os
import signal
import stat
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Optional

from camera_to_base.errors import InvalidValueError

# A process's own streams: replacing a file that one leads to would cut the stream off.
_STREAMS = ('/dev/std', '/dev/fd/', '/proc/')

_PROFILES = 'FASTRTPS_DEFAULT_PROFILES_FILE'
# With one of these, users choose profiles or transports of their own.
_CHOICES = {_PROFILES, 'FASTDDS_DEFAULT_PROFILES_FILE', 'FASTDDS_BUILTIN_TRANSPORTS'}


def write_files(contents: Mapping[str, bytes], *, keep_old: bool = False) -> List[str]:
    """
    Write all files, or none if one cannot be written.

    For a link, the target is written. An existing file keeps its permissions and, if the process
    may set it, its owner.

    :param contents: The contents by path.
    :param keep_old: Keep an overwritten file as PATH.bak.
    :returns: The .bak files that were written.
    :raises InvalidValueError: If one cannot be written, or exists and is not a regular file.
    """
    path = ''
    try:
        targets = {regular_target(path): content for path, content in contents.items()}
        old = [target for target in targets if keep_old and os.path.exists(target)]
        with _parts() as unfinished:
            for path in old:
                _write_part(regular_target(f'{path}.bak'), _content(path), path, unfinished)
            for path, content in targets.items():
                _write_part(path, content, path, unfinished)
            for path, part in unfinished.items():
                os.replace(part, path)
    except OSError as error:
        raise InvalidValueError(f"cannot write '{path}': {error.strerror}") from error
    return [f'{target}.bak' for target in old]


def write_with_history(path: str, content: bytes, most: int = 5) -> Optional[str]:
    """
    Write a file; the last ones that it replaces are kept as PATH.bak.1, the newest, and up.

    A file that is the same already is not written.

    :param most: How many are kept.
    :returns: Where the file is kept that was there; None if there was none, or it was the same.
    :raises InvalidValueError: If it cannot be written; then everything is as it was.
    """
    target = regular_target(path)
    try:
        is_there = os.path.exists(target)
        if is_there and _content(target) == content:
            return None
        newest = f'{target}.bak.1'
        with _parts() as unfinished:
            _write_part(target, content, target, unfinished)
            if is_there:
                _write_part(regular_target(newest), _content(target), target, unfinished)
                _make_room(target, most)
                os.replace(unfinished[newest], newest)
            os.replace(unfinished[target], target)
    except OSError as error:
        raise InvalidValueError(f"cannot write '{path}': {error.strerror}") from error
    return newest if is_there else None


def history_of(path: str) -> List[str]:
    """List the kept former files of a file, the newest first."""
    target = os.path.realpath(path)
    kept = (f'{target}.bak.{number}' for number in range(1, 100))
    return [one for one in kept if os.path.isfile(one)]


def _make_room(target: str, most: int) -> None:
    """Give each kept file the next number, up to the first number that is free."""
    free = next((number for number in range(1, most)
                 if not os.path.lexists(f'{target}.bak.{number}')), most)
    for number in range(free - 1, 0, -1):
        os.replace(f'{target}.bak.{number}', f'{target}.bak.{number + 1}')


def regular_target(path: str) -> str:
    """
    Follow a path's links to the file to write.

    :returns: The file's path, which is no link; the file need not exist.
    :raises InvalidValueError: If the path exists and is not a file: a device, a pipe, a folder.
    """
    target = os.path.realpath(path)
    is_stream = os.path.abspath(path).startswith(_STREAMS)
    if is_stream or os.path.lexists(target) and not os.path.isfile(target):
        kind = 'a stream' if is_stream else _kind(target)
        raise InvalidValueError(
            f"cannot write '{path}': {kind} is there, not a file: name another")
    return target


def refuse_same_file(paths: Iterable[Optional[str]]) -> None:
    """
    Refuse to read and write the same file, or to write it twice.

    :param paths: The paths; None for a file that is not used.
    :raises InvalidValueError: If two are the same.
    """
    files = [path for path in paths if path]
    if len({os.path.realpath(path) for path in files}) < len(files):
        raise InvalidValueError('expected different files to read and to write, got '
                                + ', '.join(f"'{path}'" for path in files))


def check_folder(path: str, kind: str) -> None:
    """
    Check that the folder of a file to write exists.

    :param kind: The error's word for the file.
    :raises InvalidValueError: If it does not exist.
    """
    folder = os.path.dirname(path) or '.'
    if not os.path.isdir(folder):
        raise InvalidValueError(f"cannot write {kind} '{path}': there is no folder '{folder}'")


def check_background_path(path: str) -> str:
    """
    Check that a file keeps a background without loss.

    :returns: The path, with the home folder for a `~` at its beginning.
    :raises InvalidValueError: If it is not an ordinary .png file, or its folder does not exist.
    """
    path = os.path.expanduser(path)
    if path:
        if not path.lower().endswith('.png'):
            raise InvalidValueError(f"background_file must end in .png, got '{path}'")
        check_folder(path, 'background_file')
        refuse_no_file(path)
    return path


def refuse_no_file(path: str) -> None:
    """
    Refuse what a background cannot be read from.

    :raises InvalidValueError: If the path is that of a pipe or a device.
    """
    # Reading a pipe, or a device, would never end.
    if os.path.exists(path) and not (os.path.isfile(path) or os.path.isdir(path)):
        raise InvalidValueError(f"background_file '{path}' is no ordinary file: name another")


def refuse_existing(paths: Iterable[str]) -> None:
    """
    Refuse to overwrite files.

    :raises InvalidValueError: If one exists already.
    """
    for path in paths:
        if os.path.lexists(path):
            raise InvalidValueError(
                f"'{path}' exists already: name another file, or overwrite it with --force")


def _content(path: str) -> bytes:
    with open(path, 'rb') as file:
        return file.read()


@contextmanager
def _parts() -> Iterator[Dict[str, str]]:
    """Give the temporary files by their targets; those that are left are removed."""
    unfinished: Dict[str, str] = {}
    try:
        yield unfinished
    finally:
        for part in filter(os.path.exists, unfinished.values()):
            os.remove(part)


def _write_part(target: str, content: bytes, model: str, unfinished: Dict[str, str]) -> None:
    """Write a temporary file beside the target; add it to `unfinished`."""
    # A unique name, so that two processes that write the same file do not share a temporary file.
    part = unfinished[target] = f'{target}.{os.getpid()}.part'
    with open(part, 'wb') as file:
        file.write(content)
        file.flush()
        # Without fsync, a power cut after the renaming can leave an empty file.
        os.fsync(file.fileno())
    if os.path.exists(model):
        _copy_permissions(model, part)


def _copy_permissions(model: str, path: str) -> None:
    like = os.stat(model)
    try:
        os.chown(path, like.st_uid, like.st_gid)
    except PermissionError:
        pass  # Only root may change the owner; a failure does not matter.
    os.chmod(path, stat.S_IMODE(like.st_mode))


def _kind(path: str) -> str:
    if os.path.islink(path):
        return 'a link that leads back to itself'
    if os.path.isdir(path):
        return 'a folder'
    return 'a device or a pipe'


def serve_signals() -> None:
    """
    Handle SIGINT and SIGTERM from now on, and those that arrived while Python started.

    The installed executables start with both blocked, see setup.py. Python needs 0.1 s to reach
    the first line of a module; a signal before that would end it with a traceback or with the
    signal's exit code.
    """
    signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT, signal.SIGTERM))


class Interrupt:
    """
    Records a Ctrl-C within a `with` block; a second one raises KeyboardInterrupt as usual.

    `came` is whether there was one.
    """

    came = False

    def __enter__(self) -> 'Interrupt':
        self._previous = signal.signal(signal.SIGINT, self._on_signal)
        return self

    def __exit__(self, *_: Any) -> None:
        signal.signal(signal.SIGINT, self._previous)

    def _on_signal(self, *_: Any) -> None:
        self.came = True
        signal.signal(signal.SIGINT, signal.default_int_handler)


def shared_memory_environment(
    profiles_file: str, environment: Mapping[str, str]
) -> Dict[str, str]:
    """
    Give a process the shared memory of a profile; other middleware ignores the variable.

    :param profiles_file: Path of the profile for Fast DDS.
    :param environment: The environment of the process.
    :returns: The variables to add; none where the user has chosen.
    """
    return {} if _CHOICES & set(environment) else {_PROFILES: profiles_file}
