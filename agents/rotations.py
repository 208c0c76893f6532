"""Small batched rotations in torch: quaternions are wxyz, as SAPIEN's."""

from __future__ import annotations

from functools import cache

import torch
from torch import Tensor


def quat_multiply(a: Tensor, b: Tensor) -> Tensor:
    """(..., 4) wxyz product: first b, then a."""
    aw, ax, ay, az = a.unbind(-1)
    bw, bx, by, bz = b.unbind(-1)
    return torch.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        -1,
    )


def quat_to_matrix(quat: Tensor) -> Tensor:
    """(..., 3, 3) rotation of a unit quaternion (..., 4) wxyz."""
    # Entries are sums of products of two components: two calls instead of forty.
    products = (quat[..., :, None] * quat[..., None, :]).view(-1, 16)
    return (products @ _entries(quat.dtype, quat.device)).view(*quat.shape[:-1], 3, 3)


def pose_to_frame(pose: Tensor) -> Tensor:
    """(..., 3, 4) rotation and, as last column, position [m] of a pose (..., 7) [m, wxyz]."""
    return torch.cat([quat_to_matrix(pose[..., 3:]), pose[..., :3, None]], -1)


@cache
def _entries(dtype: torch.dtype, device: torch.device) -> Tensor:
    """(16, 9) what each product of components adds to each entry of the rotation."""
    w, x, y, z = range(4)
    rows = (
        ((1, w, w), (1, x, x), (-1, y, y), (-1, z, z)),
        ((2, x, y), (-2, w, z)),
        ((2, x, z), (2, w, y)),
        ((2, x, y), (2, w, z)),
        ((1, w, w), (-1, x, x), (1, y, y), (-1, z, z)),
        ((2, y, z), (-2, w, x)),
        ((2, x, z), (-2, w, y)),
        ((2, y, z), (2, w, x)),
        ((1, w, w), (-1, x, x), (-1, y, y), (1, z, z)),
    )
    table = torch.zeros(4, 4, 9, dtype=dtype, device=device)
    for entry, terms in enumerate(rows):
        for factor, i, j in terms:
            table[i, j, entry] = factor
    return table.view(16, 9)


def axis_angle_matrix(axis: int, angle: Tensor) -> Tensor:
    """(..., 3, 3) rotation by `angle` (...) [rad] about a coordinate axis (0, 1 or 2)."""
    cos, sin = angle.cos(), angle.sin()
    matrix = torch.zeros(*angle.shape, 3, 3, dtype=angle.dtype, device=angle.device)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[..., axis, axis] = 1.0
    matrix[..., i, i] = cos
    matrix[..., j, j] = cos
    matrix[..., i, j] = -sin
    matrix[..., j, i] = sin
    return matrix


def yaw_quat(yaw: Tensor) -> Tensor:
    """(..., 4) wxyz rotation by `yaw` (...) [rad] about z."""
    zero = torch.zeros_like(yaw)
    return torch.stack([(yaw / 2).cos(), zero, zero, (yaw / 2).sin()], -1)


def rotation_vector(matrix: Tensor) -> Tensor:
    """(..., 3) [rad] axis times angle of a rotation matrix (..., 3, 3); angles below pi."""
    skew = torch.stack(
        [
            matrix[..., 2, 1] - matrix[..., 1, 2],
            matrix[..., 0, 2] - matrix[..., 2, 0],
            matrix[..., 1, 0] - matrix[..., 0, 1],
        ],
        -1,
    )
    sine = skew.norm(dim=-1) / 2
    cosine = (matrix.diagonal(dim1=-2, dim2=-1).sum(-1) - 1) / 2
    angle = torch.atan2(sine, cosine)
    scale = torch.where(
        sine > 1e-7, angle / (2 * sine).clamp(min=1e-12), torch.full_like(sine, 0.5)
    )
    return skew * scale[..., None]


def pose_error(pose: Tensor, position: Tensor, rotation: Tensor) -> Tensor:
    """Twist that takes a pose to a wanted one.

    Args:
        pose: (n, 4, 4) homogeneous transform.
        position: (n, 3) [m] wanted.
        rotation: (n, 3, 3) wanted.

    Returns:
        (n, 6) [m, rad] displacement, then axis times angle, in the frame of the pose.
    """
    turn = rotation @ pose[:, :3, :3].transpose(1, 2)
    return torch.cat([position - pose[:, :3, 3], rotation_vector(turn)], 1)
