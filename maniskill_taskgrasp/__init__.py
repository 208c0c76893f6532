"""Task-oriented dexterous grasping for ManiSkill3: from a sentence to a grasp.

Importing the package registers `TaskGrasp-v0` with gymnasium by name only; ManiSkill itself is
imported when the environment is made.
"""

from gymnasium.envs.registration import WrapperSpec, register, registry

from maniskill_taskgrasp.episode import MAX_EPISODE_STEPS

__version__ = "0.1.0"
ENV_ID = "TaskGrasp-v0"

if ENV_ID in registry:
    raise RuntimeError(f"an environment named {ENV_ID!r} is registered already; names are unique")
register(
    ENV_ID,
    entry_point="maniskill_taskgrasp.tasks.making:make",
    vector_entry_point="maniskill_taskgrasp.tasks.making:make_vec",
    max_episode_steps=MAX_EPISODE_STEPS,
    disable_env_checker=True,  # Its observations are torch tensors with a batch axis.
    additional_wrappers=(
        WrapperSpec(
            "MSTimeLimit",
            entry_point="mani_skill.utils.registration:TimeLimitWrapper",
            kwargs={"max_episode_steps": MAX_EPISODE_STEPS},
        ),
    ),
)
