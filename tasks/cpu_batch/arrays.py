"""The batched buffers, in memory that forked processes share."""

from __future__ import annotations

import mmap
from dataclasses import dataclass, fields

import numpy as np


@dataclass
class Arrays:
    """State of all environments, or rows of it. Bodies are rigid dynamic bodies and links.

    ManiSkill reads and writes the first nine through the names of the GPU buffers; `sim_*` is what
    the simulation was last seen to hold and `sent_*` what it was last told.
    """

    body: np.ndarray  # (bodies, 13) position, quaternion wxyz, velocity, angular velocity.
    qpos: np.ndarray  # (articulations, dof), as are all the others but force and torque.
    qvel: np.ndarray
    qacc: np.ndarray
    qf: np.ndarray
    target: np.ndarray
    target_velocity: np.ndarray
    force: np.ndarray  # (bodies, 4): x, y, z and a pad, as on the GPU.
    torque: np.ndarray
    sim_body: np.ndarray
    sim_qpos: np.ndarray
    sim_qvel: np.ndarray
    sent_target: np.ndarray
    sent_target_velocity: np.ndarray

    @classmethod
    def zeros(cls, bodies: int, articulations: int, dof: int) -> Arrays:
        """Buffers for that many rows and, padded to the longest, joints."""
        columns = {"body": 13, "sim_body": 13, "force": 4, "torque": 4}
        shapes = {
            f.name: (bodies, columns[f.name]) if f.name in columns else (articulations, dof)
            for f in fields(cls)
        }
        return cls(**{name: shared_zeros(shape) for name, shape in shapes.items()})

    def rows(self, bodies: slice, articulations: slice) -> Arrays:
        """Views of some rows."""
        of_bodies = {"body", "sim_body", "force", "torque"}
        return Arrays(
            **{
                f.name: getattr(self, f.name)[bodies if f.name in of_bodies else articulations]
                for f in fields(self)
            }
        )


def shared_zeros(shape: tuple[int, ...]) -> np.ndarray:
    """A float32 array that processes forked later read and write in common."""
    size = int(np.prod(shape))
    memory = mmap.mmap(-1, max(4 * size, 1))
    return np.frombuffer(memory, dtype=np.float32, count=size).reshape(shape)
