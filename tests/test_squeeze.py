"""A light object passes on the force of the fingers that squeeze it."""

import gymnasium as gym
import pytest

import maniskill_taskgrasp  # noqa: F401
from maniskill_taskgrasp.tasks.scene import (
    LIGHT,
    MOST_ITERATIONS,
    SOLVER_ITERATIONS,
    solver_iterations,
)


def test_lighter_objects_get_more_solver_iterations_up_to_a_bound():
    assert solver_iterations(10 * LIGHT) == solver_iterations(LIGHT) == SOLVER_ITERATIONS
    assert solver_iterations(LIGHT / 2) == 2 * SOLVER_ITERATIONS
    assert solver_iterations(0.001) == MOST_ITERATIONS


@pytest.mark.parametrize("num_envs", [1, 2])
def test_each_environment_has_the_iterations_of_its_object(num_envs):
    env = gym.make("TaskGrasp-v0", num_envs=num_envs, objects=["screw", "mug"][:num_envs])
    env.reset(seed=0)
    masses = [p.model.mass_kg for p in env.unwrapped.placements]
    own = [body.get_solver_position_iterations() for body in env.unwrapped.obj._bodies]
    assert own == [solver_iterations(mass) for mass in masses]
    env.close()
