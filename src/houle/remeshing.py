"""When the particles are made anew: every so many steps, with what else is kept per particle."""

from __future__ import annotations

from houle.flow import Flow
from houle.remesh import Remesher
from houle.transfer import Transfer


class Remeshing:
    """Calls a remesher every `every` steps; `count` is the steps since the last time (part of a checkpoint)."""

    def __init__(self, remesher: Remesher, every: int) -> None:
        self.remesher, self.every, self.count = remesher, every, 0

    def after_step(self, flow: Flow, transfer: Transfer) -> None:
        self.count += 1
        if self.count < self.every:
            return
        self.count = 0
        flow.sample_medium()
        flow.particles = self.remesher(flow.particles, flow.porosity)
        flow.refresh_particles()
        flow.sample_medium()
        transfer.renew(flow)
