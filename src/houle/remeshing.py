"""When the particles are made anew: every so many steps, with what else is kept per particle."""

from __future__ import annotations

from houle.flow import Flow
from houle.remesh import Remesher
from houle.transfer import Transfer

TRAVEL = 0.5  # cells that some particle must have gone before remeshing is worth it: water at rest is left alone


class Remeshing:
    """Calls a remesher every `every` steps. count, travelled: steps, and cells gone by the fastest, since the last."""

    def __init__(self, remesher: Remesher, every: int) -> None:
        self.remesher, self.every = remesher, every
        self.count, self.travelled = 0, 0.0

    def after_step(self, flow: Flow, transfer: Transfer, courant: float) -> None:
        """courant: cells that the fastest particle has gone in this step."""
        self.count, self.travelled = self.count + 1, self.travelled + courant
        if self.count < self.every or self.travelled < TRAVEL:
            return
        self.count, self.travelled = 0, 0.0
        flow.sample_medium()
        flow.drop_work()
        flow.particles = self.remesher(flow.particles, flow.porosity)
        flow.refresh_particles()
        flow.sample_medium()
        transfer.renew(flow)
