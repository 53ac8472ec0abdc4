# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.detection import LeftOut
from camera_to_base.errors import Level, Reason
from camera_to_base.pipeline.sighting import Sighting

SMALL = LeftOut(None, Reason('too_small', Level.OK, 'it is smaller than min_area_cm2'))
FAR = LeftOut(None, Reason('beyond_horizon', Level.WARN, 'it is beyond the horizon'))


def test_objects_left_out_without_harm_are_no_warning():
    assert Sighting(objects=(), left_out=(SMALL,)).warning is None


def test_first_object_left_out_with_a_warning_is_the_warning():
    assert Sighting(objects=(), left_out=(SMALL, FAR)).warning is FAR.reason
    assert Sighting(objects=(), reason=SMALL.reason, left_out=(FAR,)).warning is SMALL.reason
