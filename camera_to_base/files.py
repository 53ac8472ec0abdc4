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


"""Writes files as a whole: whoever looks sees the old ones or the new ones, never a part."""

import os
from typing import Iterable, Mapping, Optional

from camera_to_base.errors import InvalidValueError


def write_files(contents: Mapping[str, bytes]) -> None:
    """
    Write all files, or none if one cannot be written.

    :param contents: By path.
    :raises InvalidValueError: If one cannot be written.
    """
    unfinished = {path: f'{path}.part' for path in contents}
    try:
        for path, content in contents.items():
            with open(unfinished[path], 'wb') as file:
                file.write(content)
        for path in contents:
            os.replace(unfinished[path], path)
    except OSError as error:
        raise InvalidValueError(f"cannot write '{path}': {error.strerror}") from error
    finally:
        for part in unfinished.values():
            if os.path.exists(part):
                os.remove(part)


def refuse_same_file(paths: Iterable[Optional[str]]) -> None:
    """
    Refuse to read and to write, or to write twice, the same file.

    :param paths: None where there is no such file.
    :raises InvalidValueError: If two are the same.
    """
    files = [path for path in paths if path]
    if len({os.path.realpath(path) for path in files}) < len(files):
        raise InvalidValueError('expected different files to read and to write, got '
                                + ', '.join(f"'{path}'" for path in files))


def check_folder(path: str, kind: str) -> None:
    """
    Check that the folder is there in which a file is to be written.

    :param kind: What the error calls the file.
    :raises InvalidValueError: If there is no such folder.
    """
    folder = os.path.dirname(path) or '.'
    if not os.path.isdir(folder):
        raise InvalidValueError(f"cannot write {kind} '{path}': there is no folder '{folder}'")


def refuse_existing(paths: Iterable[str]) -> None:
    """
    Refuse to overwrite files.

    :raises InvalidValueError: If one is there already.
    """
    for path in paths:
        if os.path.lexists(path):
            raise InvalidValueError(
                f"'{path}' exists already: name another file, or overwrite it with --force")
