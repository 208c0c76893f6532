"""Robots: importing this package registers them with ManiSkill."""

from maniskill_taskgrasp.agents.sawyer_ar10.agent import SawyerAR10

__all__ = ["SawyerAR10"]
