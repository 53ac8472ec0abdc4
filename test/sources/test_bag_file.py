# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Bags, written by the library that reads them, and as `ros2 bag` leaves them."""

import os
from pathlib import Path
import sys

from camera_to_base.commands.locate import main
from camera_to_base.errors import FrameSourceError, InvalidValueError
from camera_to_base.sources.files import BagFile
from camera_to_base.sources.kinds import BAG, kind_of
import cv2
import numpy as np
import pytest
from recordings import disc_frame, SIZE

PATH = [None, *((60 + 8 * k, 60 + 5 * k) for k in range(5))]
BEGIN_NS, STEP_NS = 1_700_000_000_000_000_007, 100_000_000
IMAGE, COMPRESSED = 'sensor_msgs/msg/Image', 'sensor_msgs/msg/CompressedImage'


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def write_bag():
    """Write a bag with pictures on topics, each given with its type; give its name."""
    rosbag2 = pytest.importorskip('rosbags.rosbag2')
    from rosbags.typesys import get_typestore, Stores
    store = get_typestore(Stores.ROS2_JAZZY)

    def message(kind, position, stamp_ns):
        time = store.types['builtin_interfaces/msg/Time'](*divmod(stamp_ns, 10**9))
        header = store.types['std_msgs/msg/Header'](time, 'camera')
        frame = disc_frame(position)
        if kind == COMPRESSED:
            return store.types[kind](header, 'png', cv2.imencode('.png', frame)[1].ravel())
        frame = cv2.cvtColor(frame, cv2.COLOR_BGR2RGB)
        return store.types[kind](header, SIZE[1], SIZE[0], 'rgb8', 0, 3 * SIZE[0], frame.ravel())

    def write(name='bag', storage='SQLITE3', topics=(('/camera', IMAGE),), stamped=True,
              silent=()):
        plugin = rosbag2.StoragePlugin[storage]
        with rosbag2.Writer(name, version=9, storage_plugin=plugin) as writer:
            text = writer.add_connection('/chatter', 'std_msgs/msg/String', typestore=store)
            hello = store.types['std_msgs/msg/String']('hello')
            writer.write(text, BEGIN_NS, store.serialize_cdr(hello, 'std_msgs/msg/String'))
            for topic in silent:
                writer.add_connection(topic, COMPRESSED, typestore=store)
            for topic, kind in topics:
                connection = writer.add_connection(topic, kind, typestore=store)
                for number, position in enumerate(PATH):
                    stamp_ns = BEGIN_NS + number * STEP_NS
                    picture = message(kind, position, stamp_ns if stamped else 0)
                    writer.write(connection, stamp_ns + 5, store.serialize_cdr(picture, kind))
        return name
    return write


def read(bag):
    frames = [(timed.number, timed.stamp_ns, timed.frame) for timed in bag.frames()]
    bag.release()
    return frames


@pytest.mark.parametrize('kind', [IMAGE, COMPRESSED])
@pytest.mark.parametrize('storage, ending', [('SQLITE3', 'db3'), ('MCAP', 'mcap')])
def test_pictures_come_back_with_their_stamps(write_bag, storage, ending, kind):
    name = write_bag(storage=storage, topics=[('/camera', kind)])
    for source in (name, f'bag/bag.{ending}'):
        bag = BagFile(source)
        assert kind_of(source) == BAG and bag.frame_count == 6
        assert bag.kind.frame_rate == pytest.approx(10, rel=0.25)
        for number, (found, position) in enumerate(zip(read(bag), PATH)):
            assert found[:2] == (number, BEGIN_NS + number * STEP_NS)
            np.testing.assert_array_equal(found[2], disc_frame(position))


def test_positions_of_a_bag_have_its_stamps_to_the_nanosecond(write_bag, capsys):
    assert main([write_bag(storage='MCAP'), '--csv', 'out.csv']) == 0
    times = [line.split(',')[1] for line in Path('out.csv').read_text().splitlines()]
    assert times == ['time_s', *(f'1700000000.{k}00000007' for k in range(1, 6))]
    assert len(capsys.readouterr().out.splitlines()) == 6


def test_picture_without_a_stamp_has_the_time_of_its_arrival(write_bag):
    assert read(BagFile(write_bag(stamped=False)))[1][1] == BEGIN_NS + STEP_NS + 5


def test_several_topics_are_named_and_one_can_be_chosen(write_bag):
    name = write_bag(topics=[('/left/image', IMAGE), ('/right/image', COMPRESSED)])
    with pytest.raises(InvalidValueError, match='--topic: /left/image, /right/image'):
        BagFile(name)
    with pytest.raises(InvalidValueError, match='no pictures on the topic /up: there are those'):
        BagFile(name, '/up')
    for topic in ('/right/image', 'right/image'):
        assert len(read(BagFile(name, topic))) == 6


def test_topic_on_which_nothing_came_is_no_choice(write_bag):
    assert len(read(BagFile(write_bag(silent=['/camera/compressed'])))) == 6


def test_bag_without_pictures_is_refused(write_bag):
    with pytest.raises(InvalidValueError, match="bag 'bag' holds no pictures"):
        BagFile(write_bag(topics=[]))


def test_skipped_pictures_are_not_decoded(write_bag, monkeypatch):
    decoded = []
    monkeypatch.setattr('camera_to_base.sources.decoding.decode_image',
                        lambda *picture: decoded.append(picture) or disc_frame(None))
    assert main([write_bag(), '--every', '3']) == 0
    assert len(decoded) == 2


@pytest.mark.parametrize('storage, ending', [('SQLITE3', 'db3'), ('MCAP', 'mcap')])
def test_damaged_bag_is_one_sentence_that_names_it(write_bag, storage, ending, capsys):
    write_bag(storage=storage)
    file = Path(f'bag/bag.{ending}')
    content = file.read_bytes()
    for damaged in (content[:len(content) // 2], b'no bag', b''):
        file.write_bytes(damaged)
        assert main([str(file)]) == 1
        assert capsys.readouterr().err.startswith(f"locate: cannot read bag '{file}': ")


@pytest.mark.parametrize('name', ['.', 'missing.mcap'])
def test_what_is_no_bag_is_refused(write_bag, name):
    with pytest.raises(FrameSourceError, match='cannot read bag'):
        BagFile(name)


def test_without_the_library_the_cure_is_named(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, 'rosbags', None)
    monkeypatch.setitem(sys.modules, 'rosbags.highlevel', None)
    os.mkdir('bag')
    assert main(['bag']) == 1
    assert capsys.readouterr().err == (
        "locate: to read the bag 'bag' the library rosbags is needed: pip install --user "
        '--break-system-packages rosbags (in a venv without the two options)\n')
