"""How training spreads over processes: torchrun's ranks, gradient averaging, shared sums."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import torch
import torch.distributed as dist
from torch import nn


@dataclass(frozen=True)
class Processes:
    """This process among those that `torchrun` started; one alone where it did not."""

    rank: int = 0
    world_size: int = 1
    local_rank: int = 0

    @property
    def is_main(self) -> bool:
        """Whether this process writes the logs and checkpoints."""
        return self.rank == 0

    def wrap(self, network: nn.Module) -> nn.Module:
        """The network, with gradients averaged over processes where there are several."""
        if self.world_size == 1:
            return network
        return nn.parallel.DistributedDataParallel(network)

    def gather(self, value: Any) -> list[Any]:
        """Every process's value, in the order of ranks, in every process."""
        if self.world_size == 1:
            return [value]
        values: list[Any] = [None] * self.world_size
        dist.all_gather_object(values, value)
        return values

    def mean_dict(self, scalars: dict[str, float]) -> dict[str, float]:
        """Means over processes of scalars that all of them have."""
        if self.world_size == 1:
            return scalars
        total = torch.tensor(list(scalars.values()), dtype=torch.float64, device=self._device())
        dist.all_reduce(total)
        means = (total / self.world_size).tolist()
        return dict(zip(scalars, means, strict=True))

    def _device(self) -> torch.device:
        if dist.get_backend() == "nccl":
            return torch.device("cuda", self.local_rank)
        return torch.device("cpu")

    def close(self) -> None:
        """Leave the group of processes."""
        if self.world_size > 1:
            dist.destroy_process_group()


def join_processes(use_cuda: bool) -> Processes:
    """Join the group that torchrun describes in the environment, with nccl on CUDA, else gloo."""
    world_size = int(os.environ.get("WORLD_SIZE", "1"))
    if world_size == 1:
        return Processes()
    local_rank = int(os.environ["LOCAL_RANK"])
    if use_cuda:
        torch.cuda.set_device(local_rank)
    dist.init_process_group("nccl" if use_cuda else "gloo")
    return Processes(dist.get_rank(), world_size, local_rank)
