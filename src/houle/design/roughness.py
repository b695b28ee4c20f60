"""Roughness factors gamma_f of armour layers, by which run-up and overtopping are less on rough slopes."""

from __future__ import annotations

from types import MappingProxyType

#: Roughness factor gamma_f [-] by kind of armour (EurOtop 2018, table 6.2), before it fades in long waves. That of
#: Accropode and X-bloc is 0.44 to 0.46.
ROUGHNESS = MappingProxyType(
    {
        "smooth": 1.00,
        "rock, two layers, permeable core": 0.40,
        "rock, two layers, impermeable core": 0.55,
        "rock, one layer, permeable core": 0.45,
        "rock, one layer, impermeable core": 0.60,
        "Accropode": 0.46,
        "X-bloc": 0.44,
        "cubes": 0.47,
        "tetrapod": 0.38,
    }
)
