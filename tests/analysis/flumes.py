"""Synthetic flumes: gauges under waves whose every amplitude is known."""

import numpy as np

from houle.waves.dispersion import wave_number

DEPTH = 0.25
FACE = 4.0  # where irregular waves are reflected [m]


def regular(x, time, period, parts, depth=DEPTH):
    """eta (G, T): parts are (order, "bound" or "free", complex incident, complex reflected)."""
    x, omega = np.asarray(x, dtype=float)[:, None], 2 * np.pi / period
    primary, eta = float(wave_number(omega, depth)), 0.0
    for order, kind, incident, reflected in parts:
        k = order * primary if kind == "bound" else float(wave_number(order * omega, depth))
        amplitude = incident * np.exp(1j * k * x) + reflected * np.exp(-1j * k * x)
        eta = eta + (amplitude * np.exp(-1j * order * omega * time)).real
    return eta


def irregular(x, time, peak, reflect, rng, depth=DEPTH, height=0.05, on_lines=False, transmit=0.0):
    """eta (G, T) of 400 random components of 0.5 to 2 f_p in front; with transmit the wave that goes through
    instead.
    """
    record = (time[1] - time[0]) * len(time)
    if on_lines:
        number = np.arange(np.ceil(0.55 * record / peak), np.floor(1.9 * record / peak))
        f = number / record
    else:
        f = rng.uniform(0.5, 2.0, 400) / peak
    density = (f * peak) ** -5 * np.exp(-1.25 * (f * peak) ** -4)
    a = np.sqrt(density / density.sum()) * np.sqrt(2) * height / 4
    phase, k, eta = np.exp(2j * np.pi * rng.random(len(f))), wave_number(2 * np.pi * f, depth), []
    back = np.exp(2j * k * FACE)
    for place in x:
        forward, reflected = np.exp(1j * k * place), reflect * back * np.exp(-1j * k * place)
        F = a * phase * (transmit * forward if transmit else forward + reflected)
        eta.append((np.exp(-2j * np.pi * np.outer(time, f)) @ F).real)
    return np.array(eta)
