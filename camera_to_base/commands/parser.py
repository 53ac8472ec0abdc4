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

"""The parser of the commands' options, and the numbers in them."""

import argparse
from typing import Any

from camera_to_base.parameters import misspelt_name
from camera_to_base.shell_commands import full_command


def decimal(text: str) -> float:
    """
    Read a decimal number, with a point or a comma.

    :raises ArgumentTypeError: If it is none.
    """
    try:
        return float(text.replace(',', '.'))
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"expected a number such as 25.4, got '{text}'") from None


class CommandParser(argparse.ArgumentParser):
    """Reports a wrong option in one sentence, like any other wrong input, and exits with 1."""

    def error(self, message: str) -> None:
        """Exit with the sentence."""
        command, *subcommand = self.prog.split()
        self.exit(1, f'{command}: {message}: see {full_command(command, *subcommand, "--help")}\n')

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        # argparse's own sentence has no suggestion.
        if action.choices is not None and value not in action.choices:
            near = misspelt_name(str(value), list(map(str, action.choices)))
            cure = f'did you mean {near}?' if near else f'choose {" or ".join(action.choices)}'
            name = None if action.dest == 'command' else action
            raise argparse.ArgumentError(name, f"there is no '{value}', {cure}")
