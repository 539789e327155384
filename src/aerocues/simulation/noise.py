"""Value noise in the world's plane, with octaves that fade out before they would alias.

A point has the same value in every view, as far as the view resolves it. Therefore rendered images
can be matched exactly.
"""

from __future__ import annotations

import math

from aerocues.compiled import compiled


@compiled
def hashed(i: int, j: int, k: int) -> float:
    """A pseudo-random number in [0, 1) from three integers."""
    mixed = (i * 374761393 + j * 668265263 + k * 1442695041) & 0xFFFFFFFF
    mixed = ((mixed ^ (mixed >> 13)) * 1274126177) & 0xFFFFFFFF
    mixed = ((mixed ^ (mixed >> 15)) * 1103515245) & 0xFFFFFFFF
    return (mixed ^ (mixed >> 16)) * (1.0 / 4294967296.0)


@compiled
def value_noise(x: float, y: float, seed: int) -> float:
    """Smooth noise in [-1, 1] on a unit lattice."""
    floor_x, floor_y = math.floor(x), math.floor(y)
    i, j = int(floor_x), int(floor_y)
    u, v = x - floor_x, y - floor_y
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    near = hashed(i, j, seed) * (1 - u) + hashed(i + 1, j, seed) * u
    far = hashed(i, j + 1, seed) * (1 - u) + hashed(i + 1, j + 1, seed) * u
    return 2 * (near * (1 - v) + far * v) - 1


@compiled
def resolved(wavelength: float, footprint: float) -> float:
    """Share of a structure that pixels resolve: 0 up to 1.5 footprints, 1 from 4.

    Octaves near the size of a pixel were half aliased with lower limits.
    """
    return min(max(0.4 * (wavelength / footprint - 1.5), 0.0), 1.0)


@compiled
def fractal_noise(
    x: float, y: float, longest: float, shortest: float, gain: float, footprint: float, seed: int
) -> float:
    """Octaves from the longest to the shortest wavelength, in about [-1, 1].

    Parameters
    ----------
    x, y : float
        Position in metres.
    longest, shortest : float
        Wavelengths in metres; each octave has half the wavelength of the previous one.
    gain : float
        Amplitude of an octave relative to the previous one; the first has 1.
    footprint : float
        Side of a pixel on the surface in metres; shorter octaves fade out.
    seed : int
    """
    total, amplitude, wavelength = 0.0, 1.0, longest
    while wavelength >= shortest:
        share = resolved(wavelength, footprint)
        if share <= 0.0:
            break
        total += amplitude * share * value_noise(x / wavelength, y / wavelength, seed)
        # Each octave is rotated: aligned lattices would be visible as a grid.
        x, y = 0.8 * x - 0.6 * y + 17.3, 0.6 * x + 0.8 * y - 9.1
        amplitude *= gain
        wavelength *= 0.5
        seed += 1
    return total


@compiled
def changing_noise(x: float, y: float, u: float, v: float, seed: int) -> float:
    """Smooth noise like `value_noise` that also varies with `u` and `v`, per unit."""
    first, second = math.floor(u), math.floor(v)
    total = 0.0
    for i in range(2):
        for j in range(2):
            weight = (u - first if i else 1 - u + first) * (v - second if j else 1 - v + second)
            own = seed + 7919 * (int(first) + i) + 104729 * (int(second) + j)
            total += weight * value_noise(x, y, own)
    return total
