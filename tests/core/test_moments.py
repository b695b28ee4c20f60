"""Edges are cut at the lines of a lattice alike one by one and all at once."""

from __future__ import annotations

import numpy as np
import pytest

from houle.medium.integrals import cut_all


@pytest.mark.parametrize("seed", range(8))
def test_pieces_of_edges_end_on_the_lines_of_the_lattice(seed):
    """They follow each other from the one end to the other, none crosses a line, and each knows its edge."""
    rng = np.random.default_rng(seed)
    edge = rng.uniform(-1.0, 9.0, (30, 2, 2))
    on_line = rng.random(edge.shape) < 0.4
    edge[on_line] = np.round(edge[on_line])
    piece, number = cut_all(edge)
    for n, whole in enumerate(edge):
        own = piece[number == n]
        np.testing.assert_array_equal(own[[0, -1], [0, 1]], whole)
        np.testing.assert_array_equal(own[1:, 0], own[:-1, 1])
        inner, cell = own[:-1, 1], np.floor(own.mean(axis=1))
        assert (np.abs(inner - np.round(inner)).min(axis=1) < 1e-12).all()
        assert (np.abs(own - cell[:, None] - 0.5) < 0.5 + 1e-12).all()
    assert len(cut_all(np.empty((0, 2, 2)))[0]) == 0
