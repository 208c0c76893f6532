"""The hand under load and the joints' speeds: torque, force, coupling and speed limits."""

import numpy as np
import pytest
from robot_stage import CLOSED, CONTROL_TIME, joint, make, qpos_of, rest_action

from maniskill_taskgrasp.agents.controllers.coupled_hand import drive_torques
from maniskill_taskgrasp.agents.sawyer_ar10.description import ARM_JOINT_NAMES, SAWYER_AR10
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10

COUPLING_TOLERANCE = 0.03  # [rad]
ROUNDING = 1.002  # Single precision, where the torque is the difference of larger ones.
SHORTEST_LEVER = 0.05  # [m] of a fingertip about its knuckle, finger curled.


def coupling_errors(env):
    """(4,) [rad] how far the distal joints are from where their link rods put them."""
    qpos = qpos_of(env)
    return np.array(
        [
            qpos[joint(env, c.joint)] - (c.ratio * qpos[joint(env, c.source)] + c.offset)
            for c in AR10.couplings
        ]
    )


def torques_given(env):
    """Joint -> torque [Nm] that its drive gives, friction and all.

    It is what the joint passes on about its own axis, and what the drive's own inertia takes.
    """
    robot = env.agent.robot
    wrenches = robot._objs[0].get_link_incoming_joint_forces()  # Joints turn about their x.
    by_link = dict(zip([link.name for link in robot.links], wrenches[:, 3], strict=True))
    found = {}
    for own, qacc in zip(robot.active_joints, robot._objs[0].get_qacc(), strict=True):
        inertia = float(own._objs[0].armature[0])
        found[own.name] = abs(float(by_link[own.child_link.name] + inertia * qacc))
    return found


def tip_forces(env):
    """Finger or thumb -> normal force [N] of the obstacle on its last link."""
    names = {env.agent.robot.links_map[tip]._objs[0]: p for p, tip in AR10.tip_links.items()}
    impulses = {part: np.zeros(3) for part in names.values()}
    for contact in env.scene.px.get_contacts():
        for body, sign in zip(contact.bodies, (1.0, -1.0), strict=True):
            if body in names:
                impulses[names[body]] += sign * sum(point.impulse for point in contact.points)
    return {part: np.linalg.norm(i) / env.scene.px.timestep for part, i in impulses.items()}


@pytest.fixture(scope="module", params=[(0.0, 0.035, 0.03), (0.0, 0.06, 0.03)])
def squeeze(request):
    """Closing with all the hand has on a fixed cylinder, at two places.

    Every step's torques; coupling errors and forces of the half second after two seconds.
    """
    env = make("pd_joint_pos", cylinder=request.param)
    action = rest_action(env, CLOSED)
    torques, held = [], []
    for step in range(50):
        env.step(action)
        torques.append(torques_given(env))
        if step >= 40:
            held.append((coupling_errors(env), tip_forces(env)))
    env.close()
    return torques, held


def test_coupled_joints_follow_under_full_load(squeeze):
    """dip = 0.49 pip + 0.16 within 0.03 rad while all four fingers press."""
    for errors, forces in squeeze[1]:
        assert np.abs(errors).max() <= COUPLING_TOLERANCE
        assert min(forces[finger] for finger in ("index", "middle", "ring", "little")) > 5.0


def test_no_motor_exceeds_its_torque(squeeze):
    """tau <= 0.6 Nm, and tau_pip + 0.49 tau_dip <= 0.6 Nm where one motor moves both."""
    limit = AR10.torque_limit * ROUNDING
    ratio = {c.source: (c.joint, c.ratio) for c in AR10.couplings}
    for torques in squeeze[0]:
        for name in AR10.actuators:
            coupled, share = ratio.get(name, (name, 0.0))
            assert torques[name] + share * torques[coupled] <= limit, name
    assert max(squeeze[0][-1][f"{f}_mcp"] for f in ("index", "middle", "ring")) > 0.5


def test_fingertips_press_no_harder_than_the_torque_allows(squeeze):
    """A curled finger reaches 5 cm beyond its knuckle: 0.6 Nm are at most 12 N there."""
    for _, forces in squeeze[1]:
        for finger in ("index", "middle", "ring", "little"):
            assert forces[finger] <= AR10.torque_limit / SHORTEST_LEVER


@pytest.fixture(scope="module")
def still():
    """A stage that nobody steps."""
    env = make("pd_joint_pos")
    yield env
    env.close()


def test_drives_share_out_a_motors_torque():
    """By construction: a pip drive and 0.49 of its dip drive add up to the motor's 0.6 Nm."""
    torques = drive_torques(AR10)
    for coupling in AR10.couplings:
        torques[coupling.source] += coupling.ratio * torques.pop(coupling.joint)
    assert list(torques) == list(AR10.actuators)
    assert list(torques.values()) == pytest.approx([AR10.torque_limit] * len(AR10.actuators))


def test_loaded_drives_have_the_stated_limits(still):
    """SAPIEN's joints hold the hand's shares and the manufacturer's efforts of the arm."""
    expected = drive_torques(AR10)
    expected |= {name: SAWYER_AR10.joint(name).effort for name in ARM_JOINT_NAMES}
    found = {j.name: float(j._objs[0].force_limit) for j in still.agent.robot.active_joints}
    assert found == pytest.approx(expected)


def test_armature_reaches_every_joint_of_the_hand(still):
    """Without it the fingers jitter and press with a tenth of their torque."""
    for j in still.agent.robot.active_joints:
        expected = 0.0 if j.name in ARM_JOINT_NAMES else AR10.armature
        assert [float(own.armature[0]) for own in j._objs] == pytest.approx([expected])


def test_free_fingers_move_no_faster_than_their_motors():
    """Closing and opening in full steps: 1.1 rad/s over every control step, 1 % for the solver."""
    env = make("pd_joint_pos")
    columns = [joint(env, name) for name in AR10.actuators]
    open_hand = env.agent.keyframes["rest"].qpos[columns]
    before, fastest = qpos_of(env)[columns], 0.0
    for step in range(80):
        env.step(rest_action(env, CLOSED if step < 40 else open_hand))
        now = qpos_of(env)[columns]
        fastest, before = max(fastest, np.abs(now - before).max() / CONTROL_TIME), now
    env.close()
    assert 0.9 * AR10.speed_limit < fastest <= 1.01 * AR10.speed_limit


def test_arm_moves_no_faster_than_its_joints_can():
    """An absolute posture far away is approached at the joints' speed limits."""
    env = make("pd_joint_pos")
    columns = [joint(env, name) for name in ARM_JOINT_NAMES]
    limits = np.array([SAWYER_AR10.joint(name).velocity for name in ARM_JOINT_NAMES])
    action = rest_action(env, CLOSED)
    action[:7] = -action[:7]
    before, fastest = qpos_of(env)[columns], np.zeros(7)
    for _ in range(40):
        env.step(action)
        now = qpos_of(env)[columns]
        fastest, before = np.maximum(fastest, np.abs(now - before) / CONTROL_TIME), now
    env.close()
    assert (fastest <= 1.01 * limits).all()
    np.testing.assert_allclose(now, action[:7], atol=0.02)
