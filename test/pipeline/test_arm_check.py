# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.


from pathlib import Path
import sys
import time

from camera_to_base.detection import Detection, DetectorSettings, LocatedObject, Pixel
from camera_to_base.detection.detection import Box
from camera_to_base.detection.left_out import Point
from camera_to_base.pipeline import ArmCheck, CameraPipeline, FrameRecord, Limits, Standpoint
from camera_to_base.sources import DEVICE, VIDEO_FILE
from camera_to_base.surface.models import ParallelSurface
import cv2
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / 'benchmarks'))
import attack_scenes as scenes  # noqa: E402, I100

COIN = (200, 150)
SURFACE = ParallelSurface(36.0, 640)
WIDE = np.array([0.5, -0.5, 0.3, -0.3])


class Camera:
    """A pipeline on a table, with a clock of its own."""

    def __init__(self, name='plain', detector=DetectorSettings(), kind=DEVICE, seed=5):
        self.table = scenes.Table(name, np.random.default_rng(seed))
        self.pipeline = CameraPipeline(
            SURFACE, detector, Limits(confirm_jump_px=0.0), kind=kind)
        self._now = time.monotonic() + 3600
        self.sighting = None
        self.see(seconds=0.2)

    def see(self, *draw, seconds=0.1, light=1.0):
        """Take frames for a while; give the centres that the last one publishes."""
        for _ in range(round(seconds * 10)):
            self._now += 0.1
            frame = self.table.shoot(draw=draw, light=light)
            self.sighting = self.pipeline.process(frame, self._now)
        return [] if self.sighting.reason else [
            one.detection.centre for one in self.sighting.objects]

    def coin(self, at=COIN):
        return scenes.coin(at, colour=np.maximum(self.table.colour - 80, 5))

    def arm(self, levels, tip=(400, 300), edge=(560, 560)):
        return scenes.arm(scenes.arm_cover(edge, tip, 70, WIDE), self.table.colour + levels)


def is_coin(centres, at=COIN):
    return len(centres) == 1 and np.hypot(*np.subtract(centres[0], at)) < 1


def island(camera, levels=60):
    # What a detector makes of a hand whose brightness is partly the table's.
    return scenes.coin((400, 300), 30, camera.table.colour + levels)


@pytest.mark.parametrize('levels', [-100, -40, -12, 12, 35, 80])
@pytest.mark.parametrize('name', ['plain', 'wood', 'print'])
def test_hand_of_any_brightness_is_not_published_and_the_coin_beside_it_is(name, levels):
    camera = Camera(name)
    assert is_coin(camera.see(camera.coin()))
    assert is_coin(camera.see(camera.coin(), camera.arm(levels)))
    assert is_coin(camera.see(camera.coin()))


@pytest.mark.parametrize('edge', [(-80, 200), (720, 200), (300, -80), (300, 560)])
def test_island_within_a_faint_hand_is_left_out_from_every_edge(edge):
    camera = Camera()
    faint = camera.arm(9, edge=edge)
    assert is_coin(camera.see(camera.coin(), faint, island(camera)))
    kinds = {left_out.reason.kind for left_out in camera.sighting.left_out}
    assert kinds and kinds <= {'touched', 'cut_off'}


def test_hand_over_an_empty_table_publishes_an_empty_table():
    camera = Camera()
    assert camera.see(camera.arm(9), island(camera)) == []
    assert camera.sighting.left_out


def test_what_a_hand_leaves_behind_is_published_after_a_second():
    camera = Camera()
    camera.see(camera.arm(-80), seconds=0.3)
    assert camera.see(island(camera), seconds=0.5) == []
    assert is_coin(camera.see(island(camera), seconds=1.0), (400, 300))


def test_coin_that_a_hand_has_covered_is_published_as_soon_as_it_is_free():
    camera = Camera()
    camera.see(camera.coin(), seconds=0.3)
    assert camera.see(camera.coin(), camera.arm(-80, tip=COIN), seconds=0.5) == []
    assert is_coin(camera.see(camera.coin()))


def test_known_coin_at_rest_stays_published_in_a_shadow_and_a_new_one_does_not():
    camera = Camera()
    shadow = scenes.shadow(scenes.arm_cover((560, 560), COIN, 90), 0.15)
    camera.see(camera.coin(), seconds=0.3)
    assert is_coin(camera.see(shadow, camera.coin()))
    camera = Camera()
    assert camera.see(shadow, camera.coin()) == []


def beside(at=COIN):
    """Give the cover of a palm whose shadow falls on the coin, and which does not cover it."""
    return scenes.arm_cover((at[0] - 90, -80), np.subtract(at, (62, 50)), 60)


@pytest.mark.parametrize('levels', [-60, 60])
@pytest.mark.parametrize('name', ['plain', 'wood', 'print'])
def test_known_coin_stays_published_where_an_arm_beside_it_shades_it(name, levels):
    camera = Camera(name)
    camera.see(camera.coin(), seconds=0.3)
    draw = scenes.shadow(beside()), scenes.arm(beside(), camera.table.colour + levels)
    for _ in range(10):
        assert is_coin(camera.see(camera.coin(), *draw))


@pytest.mark.parametrize('now', [None, (COIN[0] + 7, COIN[1] - 5)])
def test_known_coin_that_is_taken_or_moved_in_a_shadow_is_not_published_where_it_was(now):
    camera = Camera()
    camera.see(camera.coin(), seconds=0.3)
    draw = scenes.shadow(beside()), scenes.arm(beside(), camera.table.colour - 60)
    assert is_coin(camera.see(camera.coin(), *draw))
    coin = [] if now is None else [camera.coin(now)]
    assert camera.see(*coin, *draw) == []


@pytest.mark.parametrize('seed', range(6))
def test_hand_is_not_published_on_a_table_that_shows_hardly_more_than_noise(seed):
    camera = Camera(seed=seed)
    assert camera.see(camera.arm(9), island(camera)) == []
    assert camera.sighting.left_out


def test_object_of_the_background_that_moves_by_half_its_width_gives_no_wrong_position():
    camera = Camera()
    camera.pipeline.capture_background(1)
    camera.see(camera.coin(), seconds=0.2)
    for way in (8, 14, 20, 26, 34):
        for at in camera.see(camera.coin((COIN[0] + way, COIN[1])), seconds=0.2):
            assert np.hypot(*np.subtract(at, (COIN[0] + way, COIN[1]))) < 5


@pytest.mark.parametrize('name', ['print', 'tiles', 'speckle'])
def test_object_on_a_strong_pattern_is_published_everywhere(name):
    camera = Camera(name)
    for at in np.random.default_rng(1).uniform((40, 40), (600, 440), (15, 2)):
        assert is_coin(camera.see(camera.coin(at)), at)


def test_coin_that_is_half_covered_is_left_out():
    camera = Camera()
    camera.see(camera.coin(), seconds=0.3)
    u, v = COIN
    assert camera.see(camera.coin(), camera.arm(12, tip=(u + 52, v), edge=(u + 52, 560))) == []


@pytest.mark.parametrize('light', [0.3, 0.6, 1.3])
def test_step_of_the_light_is_no_hand(light):
    camera = Camera('wood')
    assert is_coin(camera.see(camera.coin(), light=light))


def test_light_from_one_side_is_no_hand():
    camera = Camera()
    ramp = np.linspace(0.85, 1.2, scenes.SHAPE[1], dtype=np.float32)[None, :, None]
    camera.see(camera.coin(), lambda canvas: np.multiply(canvas, ramp, out=canvas))
    assert is_coin([one.detection.centre for one in camera.sighting.objects])


def test_object_at_the_edge_counts_where_cut_off_ones_do():
    camera = Camera(detector=DetectorSettings(publish_cut_off=True))
    assert len(camera.see(camera.coin((5, 200)))) == 1


def test_tutorials_detector_is_left_as_it_is():
    camera = Camera(detector=DetectorSettings(method='tutorial'))
    assert len(camera.see(camera.arm(-130))) == 1


def test_frame_of_a_recording_without_a_time_is_judged_by_itself():
    camera = Camera(kind=VIDEO_FILE)
    assert camera.see(camera.arm(9), island(camera)) == []
    found = camera.pipeline.process(camera.table.shoot(draw=[island(camera)])).objects
    assert is_coin([one.detection.centre for one in found], (400, 300))


def test_known_object_is_asked_anew_when_its_place_looks_different():
    # A disc of the background, then a lighter one on it, then both are gone.
    table = np.random.default_rng(1).normal(150, 1.5, (240, 320, 3)).astype(np.uint8)
    dark, light = (cv2.circle(table.copy(), (160, 120), 20, (level,) * 3, -1)
                   for level in (60, 230))
    inside = cv2.circle(np.zeros(table.shape[:2], np.uint8), (160, 120), 20, 1, -1)
    outline = cv2.findContours(inside, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0][0]
    detection = Detection(Box(*cv2.boundingRect(outline)), Pixel(160, 120),
                          cv2.contourArea(outline), outline[:, 0], False)
    found = [LocatedObject(detection, Point(9.0, 6.75))]
    arms = ArmCheck(dark)

    def judge(frame, now):
        return arms.judge(FrameRecord(
            frame, Standpoint.as_calibrated(SURFACE), now=now, aligned=frame, objects=found))

    for now in 0.0, 0.1, 0.2:
        assert judge(light, now).objects == found
    gone = judge(table, 0.3)
    assert not gone.objects and [one.reason.kind for one in gone.left_out] == ['taken_away']
