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
        command = self.prog.split()[0]  # after the first word follows the subcommand
        self.exit(1, f'{command}: {message}: see {self.prog} --help\n')
