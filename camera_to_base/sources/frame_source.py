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

"""The interface of frame sources."""

from typing import Optional, Protocol

from camera_to_base.sources.source_kind import SourceKind
import numpy as np


class FrameSource(Protocol):
    """
    A source of frames.

    `kind` is the kind of source. If its frame rate is 0, `read` waits for the next frame.
    """

    kind: SourceKind

    def read(self) -> Optional[np.ndarray]:
        """
        Return the next frame.

        :returns: Shape (h, w, 3), uint8, BGR; None at the end of a recording.
        :raises FrameSourceError: If a frame should follow but cannot be read.
        """

    def release(self) -> None:
        """Release the device or file; no frame can be read afterwards."""
