# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What new settings change in a running pipeline, and what they leave alone."""

from dataclasses import replace
import time

from camera_to_base.detection import DetectorSettings
from camera_to_base.pipeline import CameraPipeline, Limits
from camera_to_base.sources import DEVICE
from camera_to_base.surface import make_surface, SURFACE_DEFAULTS
import cv2
import numpy as np
import pytest

DETECTOR = DetectorSettings()


def surface(**changed):
    return make_surface({**SURFACE_DEFAULTS, **{
        f'surface.{name}': value for name, value in changed.items()}})


def picture(disc=(300, 200)):
    frame = np.random.default_rng(1).normal(200, 12, (480, 640, 1)).repeat(3, axis=2)
    frame = cv2.GaussianBlur(frame, (0, 0), 2).clip(0, 255).astype(np.uint8)
    return frame if disc is None else cv2.circle(frame, disc, 30, (40, 40, 40), -1)


def see(pipeline, frame):
    """Give the objects that may be published, or None where nothing may."""
    sighting = pipeline.process(frame, time.monotonic())
    return sighting.objects if sighting.reason is None else None


@pytest.fixture
def pipeline():
    """Give a pipeline with a background and a confirmed object."""
    pipeline = CameraPipeline(
        surface(), DETECTOR, Limits(max_frame_age_s=60.0), kind=DEVICE)
    for disc in (None, None, (300, 200), (300, 200)):
        seen = see(pipeline, picture(disc))
    assert len(seen) == 1
    return pipeline


def test_settings_that_are_the_same_hold_no_frame_back_and_keep_the_detector(pipeline):
    locator = pipeline._detection._locator
    pipeline.configure(surface(), replace(DETECTOR), Limits(max_frame_age_s=60.0))
    assert len(see(pipeline, picture())) == 1
    assert pipeline._detection._locator is locator


def test_new_surface_or_detector_takes_effect_and_holds_no_frame_back(pipeline):
    limits = Limits(max_frame_age_s=60.0)
    pipeline.configure(surface(**{'parallel.width_cm': 64.0}), DETECTOR, limits)
    found, = see(pipeline, picture())
    assert found.point == pytest.approx((30.0, 20.0), abs=0.2)
    pipeline.configure(surface(), replace(DETECTOR, max_area_cm2=0.1), limits)
    assert see(pipeline, picture()) is None  # that there is nothing takes two frames
    assert see(pipeline, picture()) == []


@pytest.mark.parametrize('limits', [
    Limits(max_frame_age_s=50.0), Limits(max_frame_age_s=60.0, confirm_jump_px=5.0)])
def test_new_limits_keep_the_detector_and_hold_no_frame_back(pipeline, limits):
    locator = pipeline._detection._locator
    pipeline.configure(surface(), DETECTOR, limits)
    assert len(see(pipeline, picture())) == 1
    assert pipeline._detection._locator is locator
