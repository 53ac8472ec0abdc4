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

"""The service that tells with which parameters a correction is kept."""

from datetime import datetime
import json
from typing import Any, Callable, Dict

from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.parameters import changed_record
from camera_to_base.settings import CameraSettings
from camera_to_base.surface import SURFACE_SPECS
from camera_to_base.trust import CameraPipeline, kept_values, view_thumbnail
from camera_to_base.uncertainty import SURFACE_COVARIANCE
from rclpy.node import Node
from std_srvs.srv import Trigger

_RECORD, _THUMBNAIL = 'calibration.surface', 'calibration.thumbnail'
_HOW = {'view_corrected': 'corrected for a nudge of the camera'}


class CorrectionService:
    """
    Offers `~/corrected_surface`: the surface in force as parameters, in the message as JSON.

    The node itself goes on without a correction once these parameters are set. `sentence` says
    what is corrected, `values` holds the parameters by full name, and `before` those of the
    surface as they are now.

    :param node: The node that offers it.
    :param pipeline: The pipeline that corrects.
    :param settings: Returns the node's settings.
    """

    def __init__(
        self, node: Node, pipeline: CameraPipeline, settings: Callable[[], CameraSettings]
    ) -> None:
        self._node, self._pipeline, self._settings = node, pipeline, settings
        node.create_service(Trigger, '~/corrected_surface', self._on_call)

    def _on_call(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        try:
            response.message = json.dumps(self._offer())
            response.success = True
        except CameraToBaseError as error:
            response.message = str(error)
        return response

    def _offer(self) -> Dict[str, Any]:
        in_force = self._pipeline.standpoint.surface
        if in_force.reason is None:
            raise InvalidValueError(
                'the camera stands where it was calibrated: there is no correction to keep')
        if self._pipeline.reason is not None:
            raise InvalidValueError(
                f'nothing is published now, so nothing is kept: {self._pipeline.reason.sentence}')
        names = [SURFACE_COVARIANCE, *(spec.name for spec in SURFACE_SPECS)]
        return {'sentence': in_force.reason.sentence, 'values': self._values(),
                'before': {name: self._parameter(name) for name in names}}

    def _values(self) -> Dict[str, Any]:
        settings, standpoint = self._settings(), self._pipeline.standpoint
        picture = standpoint.background.picture
        how = _HOW.get(standpoint.surface.reason.kind, 'computed anew from markers')
        values = kept_values(
            standpoint.surface, settings.surface, settings.uncertainty, settings.hull,
            picture.shape[1::-1])
        values[_RECORD] = changed_record(
            self._parameter(_RECORD), how, datetime.now().astimezone())
        if self._parameter(_THUMBNAIL):
            values[_THUMBNAIL] = view_thumbnail(picture)
        return values

    def _parameter(self, name: str) -> Any:
        value = self._node.get_parameter(name).value
        return list(value) if hasattr(value, 'tolist') else value
