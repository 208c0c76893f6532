"""Data that the package ships: the robot, the object library, checkpoints and human statistics."""
