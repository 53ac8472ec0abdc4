# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from glob import glob
import os
import sys

from setuptools import find_packages, setup

package_name = 'camera_to_base'
# Signals are blocked while Python starts; `interrupt.serve_signals` then handles them.
interpreter = f'/usr/bin/env -S --block-signal=INT,TERM {sys.executable}'

setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(include=[package_name, f'{package_name}.*']),
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{package_name}']),
        (f'share/{package_name}', ['package.xml']),
        (f'share/{package_name}/config', [*glob('config/*.yaml'), *glob('config/*.rviz')]),
        (f'share/{package_name}/config/sros2', glob('config/sros2/*.xml')),
        (f'share/{package_name}/config/fastdds', glob('config/fastdds/*.xml')),
        (f'share/{package_name}/examples', glob('examples/*.py')),
        (f'share/{package_name}/launch', glob('launch/*.launch.py')),
    ],
    package_data={f'{package_name}.dashboard': [
        os.path.relpath(path, f'{package_name}/dashboard')
        for path in glob(f'{package_name}/dashboard/web/**', recursive=True)
        if os.path.isfile(path)]},
    python_requires='>=3.10',
    install_requires=[
        'matplotlib', 'numpy', 'opencv-python-headless', 'PyYAML', 'scipy', 'tornado', 'tqdm'],
    zip_safe=False,
    options={'build_scripts': {'executable': interpreter}},
    maintainer='The camera_to_base authors',
    maintainer_email='maintainer@todo.todo',
    description="Objects that a camera sees on a surface, as points in the robot's base frame.",
    license='Apache-2.0',
    extras_require={
        'bags': ['rosbags'],
        'ros': ['ros-jazzy-rclpy[fastrtps]', 'ros-jazzy-common-interfaces'],
        'test': ['hypothesis', 'pytest'],
    },
    entry_points={
        'console_scripts': [
            'calibrate = camera_to_base.executables:calibrate',
            'camera_fusion = camera_to_base.executables:camera_fusion',
            'camera_publisher = camera_to_base.executables:camera_publisher',
            'dashboard = camera_to_base.executables:dashboard',
            'locate = camera_to_base.executables:locate',
            'robot_base_publisher = camera_to_base.executables:robot_base_publisher',
            'robotic_arm_publishing_subscriber = '
            'camera_to_base.executables:robot_base_publisher',
        ],
    },
)
