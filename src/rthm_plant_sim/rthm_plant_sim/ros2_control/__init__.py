"""A rig under ros2_control as the plant of tests: joint states in, commands of a controller out."""

from __future__ import annotations
