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

"""Finds publishers whose quality of service does not match a subscription."""

from typing import Optional, Sequence

from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility
from rclpy.subscription import Subscription


def qos_mismatch(node: Node, subscriptions: Sequence[Subscription]) -> Optional[str]:
    """
    Find a publisher whose quality of service does not match a subscription.

    rclpy's own event for this slows every message of the subscription; a look at the graph does
    not.

    :returns: A sentence about the first mismatch, or None.
    """
    for subscription in subscriptions:
        topic = subscription.topic_name
        for publisher in node.get_publishers_info_by_topic(topic):
            found, _ = qos_check_compatible(publisher.qos_profile, subscription.qos_profile)
            if found == QoSCompatibility.ERROR:
                return (f'cannot receive what {publisher.node_name} publishes on {topic}: set '
                        f'the parameters qos_overrides.{topic}.subscription as the publisher has '
                        f"it, see 'ros2 topic info -v {topic}'")
    return None
