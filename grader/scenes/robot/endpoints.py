"""What the scene's node publishes and listens to, by name and type."""

from __future__ import annotations

from grader.scenes.robot.trace import DESCRIPTION, JOINT_STATES, TF, TF_STATIC, TOPICS
from grader.scenes.scene import Endpoint

ENDPOINTS = (
    *(Endpoint("subscription", topic, TOPICS[topic]) for topic in (JOINT_STATES, TF, TF_STATIC)),
    *(Endpoint("publisher", topic, TOPICS[topic]) for topic in (DESCRIPTION, TF, TF_STATIC)),
)
