"""Rotations, forward kinematics and Jacobians: closed forms and numerical derivatives."""

import math

import pytest
import torch

from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.robot_model import Joint, Link, Robot
from maniskill_taskgrasp.agents.rotations import (
    axis_angle_matrix,
    pose_error,
    quat_multiply,
    quat_to_matrix,
    rotation_vector,
    yaw_quat,
)
from maniskill_taskgrasp.agents.sawyer_ar10.description import SAWYER_AR10, SIMULATED
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10

ARM = Robot(
    name="planar",
    root="base",
    links=tuple(Link(name=name) for name in ("base", "upper", "fore", "hand")),
    joints=(
        Joint(name="shoulder", parent="base", child="upper", type="revolute", axis=(0, 0, 1)),
        Joint(name="elbow", parent="upper", child="fore", xyz=(2, 0, 0), type="revolute"),
        Joint(name="wrist", parent="fore", child="hand", xyz=(1, 0, 0)),
    ),
)
"""Two hinges about z, arms of 2 and 1 m."""


def random_quats(count, seed=0):
    """(count, 4) unit quaternions, float64."""
    quats = torch.randn(count, 4, generator=torch.Generator().manual_seed(seed)).double()
    return quats / quats.norm(dim=1, keepdim=True)


def random_postures(kinematics, robot, count, seed=0):
    """(count, dof) [rad] postures inside all joint limits, float64."""
    limits = [robot.joint(name) for name in kinematics.joint_names]
    lower = torch.tensor([joint.lower for joint in limits]).double()
    upper = torch.tensor([joint.upper for joint in limits]).double()
    share = torch.rand(count, len(limits), generator=torch.Generator().manual_seed(seed)).double()
    return lower + share * (upper - lower)


# -- rotations ---------------------------------------------------------------------------------


def test_quaternions_become_rotations():
    """Orthogonal, of determinant one, and the product of two is the product of their matrices."""
    first, second = random_quats(50), random_quats(50, seed=1)
    matrix = quat_to_matrix(first)
    eye = torch.eye(3).double().expand_as(matrix)
    torch.testing.assert_close(matrix @ matrix.transpose(1, 2), eye)
    torch.testing.assert_close(torch.linalg.det(matrix), torch.ones(50).double())
    product = quat_to_matrix(quat_multiply(first, second))
    torch.testing.assert_close(product, matrix @ quat_to_matrix(second))


@pytest.mark.parametrize("angle", [0.0, 1e-6, 0.3, -2.0, 3.1])
def test_rotation_vector_undoes_a_turn_about_each_axis(angle):
    """Axis times angle comes back, also for tiny angles and near half a turn."""
    for axis in range(3):
        matrix = axis_angle_matrix(axis, torch.tensor(angle).double())
        expected = torch.zeros(3).double()
        expected[axis] = angle
        torch.testing.assert_close(rotation_vector(matrix), expected, atol=1e-9, rtol=1e-6)


def test_yaw_is_a_turn_about_z():
    """The quaternion and the matrix agree."""
    yaw = torch.linspace(-3, 3, 7).double()
    torch.testing.assert_close(quat_to_matrix(yaw_quat(yaw)), axis_angle_matrix(2, yaw))


def test_pose_error_is_zero_at_the_target_and_leads_to_it():
    """Turning and shifting a pose by its error gives the target."""
    rotation = quat_to_matrix(random_quats(20))
    target = quat_to_matrix(random_quats(20, seed=1))
    pose = torch.eye(4).double().repeat(20, 1, 1)
    pose[:, :3, :3] = rotation
    position = torch.randn(20, 3, generator=torch.Generator().manual_seed(2)).double()
    assert pose_error(pose, pose[:, :3, 3], rotation).abs().max() < 1e-7
    error = pose_error(pose, position, target)
    torch.testing.assert_close(error[:, :3], position)
    turn = torch.linalg.matrix_exp(_cross(error[:, 3:]))
    torch.testing.assert_close(turn @ rotation, target)


def _cross(vector):
    """(n, 3, 3) matrix of the cross product with (n, 3)."""
    x, y, z = vector.unbind(1)
    zero = torch.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return torch.stack([torch.stack(row, 1) for row in rows], 1)


# -- kinematics --------------------------------------------------------------------------------


def test_planar_arm_has_its_closed_form():
    """x = 2 cos a + cos(a + b), y likewise with sines; the hand turns by a + b."""
    kinematics = ArticulationKinematics.of_description(ARM)
    a, b = 0.4, -1.1
    pose, jacobian = kinematics.pose_and_jacobian(torch.tensor([[a, b]]).double(), "hand")
    x, y = 2 * math.cos(a) + math.cos(a + b), 2 * math.sin(a) + math.sin(a + b)
    assert pose[0, :3, 3].tolist() == pytest.approx([x, y, 0.0], abs=1e-7)
    assert math.atan2(pose[0, 1, 0], pose[0, 0, 0]) == pytest.approx(a + b, abs=1e-7)
    expected = [[-y, -math.sin(a + b)], [x, math.cos(a + b)], [0, 0], [0, 0], [0, 0], [1, 1]]
    torch.testing.assert_close(jacobian[0], torch.tensor(expected).double(), atol=1e-7, rtol=0)


def test_jacobian_is_the_derivative_of_the_pose():
    """Central differences of position and turn, random postures, arm and fingertip."""
    kinematics = ArticulationKinematics.of_description(SAWYER_AR10)
    qpos = random_postures(kinematics, SAWYER_AR10, 5)
    step = 1e-4
    for link in ("palm_frame", "index_tip", "thumb_tip"):
        jacobian = kinematics.jacobian(qpos, link)
        at = kinematics.link_index(link)
        for column in range(kinematics.dof):
            shift = torch.zeros(kinematics.dof).double()
            shift[column] = step
            after = kinematics.link_matrices(qpos + shift)[:, at]
            before = kinematics.link_matrices(qpos - shift)[:, at]
            change = pose_error(before, after[:, :3, 3], after[:, :3, :3]) / (2 * step)
            torch.testing.assert_close(jacobian[..., column], change, atol=1e-5, rtol=0)


def test_loaded_and_described_robot_agree():
    """SAPIEN's own joint frames and the description give the same poses, link by link."""
    import sapien
    from mani_skill.envs.scene import ManiSkillScene
    from mani_skill.envs.utils.system.backend import parse_sim_and_render_backend

    from maniskill_taskgrasp.agents.sawyer_ar10.build import default_folder

    backend = parse_sim_and_render_backend("physx_cpu", "none")
    stage = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene = ManiSkillScene([stage], device=torch.device("cpu"), backend=backend)
    loader = scene.create_urdf_loader()
    loader.name = "robot"
    robot = loader.load(str(default_folder() / "sawyer_ar10_collision.urdf"))
    loaded = ArticulationKinematics.of(robot)
    described = ArticulationKinematics.of_description(SAWYER_AR10)
    qpos = random_postures(described, SAWYER_AR10, 10).float()
    order = [described.column(name) for name in loaded.joint_names]
    theirs = loaded.link_matrices(qpos[:, order])
    ours = described.link_matrices(qpos)
    for link in described.link_names:
        carrier, at = SIMULATED.frames[link]
        found = theirs[:, loaded.link_index(carrier)] @ torch.tensor(at, dtype=torch.float32)
        expected = ours[:, described.link_index(link)]
        torch.testing.assert_close(found, expected, atol=1e-5, rtol=0)
    robot.set_qpos(qpos[:1, order])
    simulated = robot.links_map["thumb_distal"].pose.p
    found = theirs[:1, loaded.link_index("thumb_distal"), :3, 3]
    torch.testing.assert_close(found, simulated, atol=1e-5, rtol=0)


def test_joint_angles_put_coupled_joints_in_place():
    """dip = 0.49 pip + 0.16, for whatever batch shape."""
    motors = torch.rand(2, 3, len(AR10.actuators), generator=torch.Generator().manual_seed(0))
    angles = AR10.joint_angles(motors)
    assert len(angles) == 14
    for finger in ("index", "middle", "ring", "pinky"):
        expected = 0.49 * angles[f"{finger}_pip"] + 0.16
        torch.testing.assert_close(angles[f"{finger}_dip"], expected)
    torch.testing.assert_close(angles["thumb_flex"], motors[..., 1])
