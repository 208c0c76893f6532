"""Contact forces between the hand's links and the object, the same on every back end."""

from __future__ import annotations

import numpy as np
import torch
from mani_skill.envs.scene import ManiSkillScene
from mani_skill.utils.structs import Actor
from mani_skill.utils.structs.link import Link
from torch import Tensor


class LinkContacts:
    """Force of the object on each of some links, from one pass over all contacts.

    Forces are sums of normal forces over the contact points of a pair, at the last physics step.
    """

    def __init__(self, scene: ManiSkillScene, links: list[Link], obj: Actor) -> None:
        self._scene = scene
        self._num_links = len(links)
        if scene.gpu_sim_enabled:
            pairs = [
                (link._bodies[env], body) for env, body in enumerate(obj._bodies) for link in links
            ]
            self._query = scene.px.gpu_create_contact_pair_impulse_query(pairs)
        else:
            self._link_ids = {link._objs[0].entity.per_scene_id: i for i, link in enumerate(links)}
            self._obj_id = obj._objs[0].per_scene_id

    def forces(self) -> Tensor:
        """(num_envs, num_links, 3) [N] force of the object on each link, world frame."""
        if self._scene.gpu_sim_enabled:
            self._scene.px.gpu_query_contact_pair_impulses(self._query)
            impulses = self._query.cuda_impulses.torch().view(-1, self._num_links, 3)
        else:
            impulses = self._sum_of_contacts()
        return impulses / self._scene.px.timestep

    def _sum_of_contacts(self) -> Tensor:
        """Sums that do not depend on the order of the contacts, which differs between processes:
        double precision keeps what single precision would round away."""
        impulses = np.zeros((1, self._num_links, 3))
        for contact in self._scene.px.get_contacts():
            first, second = (body.entity.per_scene_id for body in contact.bodies)
            if second == self._obj_id and first in self._link_ids:
                link, sign = self._link_ids[first], 1.0
            elif first == self._obj_id and second in self._link_ids:
                link, sign = self._link_ids[second], -1.0
            else:
                continue
            for point in contact.points:
                impulses[0, link] += sign * point.impulse
        return torch.from_numpy(impulses.astype(np.float32))
