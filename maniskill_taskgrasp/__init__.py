"""Task-oriented dexterous grasping for ManiSkill3: from a sentence to a grasp.

Importing the package registers `TaskGrasp-v0` with gymnasium by name only; ManiSkill itself is
imported when the environment is made.
"""

__version__ = "0.1.0"
