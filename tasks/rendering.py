"""Whether anything can be drawn on this machine, and what to do where nothing can."""

from __future__ import annotations

from functools import lru_cache

from mani_skill import logger

CAMERALESS_OBS_MODES = (None, "none", "state", "state_dict")


@lru_cache(maxsize=1)
def rendering_available() -> bool:
    """Whether SAPIEN finds a Vulkan device. (`sapien.Device.can_render()` denies working ones.)"""
    import sapien.render

    try:
        sapien.render.get_device_summary()
    except RuntimeError:
        return False
    return True


def needs_cameras(obs_mode: str | None) -> bool:
    """Whether an observation mode renders anything."""
    return obs_mode not in CAMERALESS_OBS_MODES


def choose_render_backend(render_backend: str | None, obs_mode: str | None) -> str:
    """The render backend to ask ManiSkill for: as given, or "none" where nothing can render.

    Raises:
        ValueError: the observation mode needs cameras and there is no Vulkan device.
    """
    if render_backend is None:
        return "none"
    if render_backend == "none" or rendering_available():
        return render_backend
    if needs_cameras(obs_mode):
        raise ValueError(
            f"obs_mode={obs_mode!r} needs cameras, and SAPIEN finds no Vulkan device to render "
            "with: install a Vulkan driver (Mesa >= 24.3 has one for CPUs) or use obs_mode='state'"
        )
    logger.warning("Rendering is off: SAPIEN finds no Vulkan device. Physics is not affected.")
    return "none"
