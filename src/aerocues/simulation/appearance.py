"""Shading: light and air applied to a surface colour."""

from __future__ import annotations

import math

from aerocues.compiled import compiled
from aerocues.simulation.lighting import Light, sky_seen, sunlit
from aerocues.simulation.noise import changing_noise, resolved
from aerocues.simulation.surfaces import Material, Rgb


@compiled
def sky(ray: Rgb, light: Light) -> Rgb:
    """Radiance of the sky in a direction."""
    length = math.sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2])
    up = max(-ray[2] / length, 0.0)
    pale = math.exp(-5.0 * up)
    return (
        light.sky_colour[0] * 0.44 + pale * 0.75,
        light.sky_colour[1] * 0.55 + pale * 0.70,
        light.sky_colour[2] * 0.77 + pale * 0.45,
    )


@compiled
def lit(kind: int, colour: Rgb, at: Rgb, normal: Rgb, light: Light) -> Rgb:
    """Radiance of a point of a colour in sun and sky."""
    facing = normal[0] * light.sun[0] + normal[1] * light.sun[1] + normal[2] * light.sun[2]
    seen = sky_seen(light, at)
    shadow = sunlit(light, at, normal)
    sun = max(facing, 0.0) * shadow
    if kind == Material.LEAF:
        # Leaves point in all directions and transmit light: the sun also reaches their far side.
        sun = (0.30 + 0.55 * max(facing, 0.0) + 0.15 * abs(facing)) * shadow * (0.35 + 0.65 * seen)
    sky = seen * (0.62 + 0.38 * normal[2])
    # Light reflected by the ground reaches walls and the undersides of eaves.
    bounced = 0.10 * (1.0 - 0.8 * normal[2]) * (0.4 + 0.6 * seen)
    red = sun * light.sun_colour[0] + sky * light.sky_colour[0] + 1.1 * bounced
    green = sun * light.sun_colour[1] + sky * light.sky_colour[1] + 1.0 * bounced
    blue = sun * light.sun_colour[2] + sky * light.sky_colour[2] + 0.7 * bounced
    return colour[0] * red, colour[1] * green, colour[2] * blue


@compiled
def through_air(colour: Rgb, distance: float, light: Light) -> Rgb:
    """A colour seen through haze over a distance: attenuated, plus the light of the haze."""
    clear = math.exp(-light.extinction * distance)
    veil = 1.0 - clear
    return (
        colour[0] * clear + veil * 0.78,
        colour[1] * clear + veil * 0.84,
        colour[2] * clear + veil * 0.92,
    )


@compiled
def glint(kind: int, at: Rgb, ray: Rgb, length: float, footprint: float) -> float:
    """Relative change of brightness of a surface that shines towards the camera.

    Tufts and crowns point in all directions: which of them shine changes within a few degrees.
    """
    x, y = at[0] + 0.6 * at[2], at[1] - 0.6 * at[2]
    north, east = 8.0 * ray[0] / length, 8.0 * ray[1] / length
    total, wavelength, seed = 0.0, 2.4, 901
    for _ in range(2):
        share = resolved(wavelength, footprint)
        u, v = x / wavelength, y / wavelength
        total += share * changing_noise(u, v, north, east, seed)
        wavelength, seed = 0.5 * wavelength, seed + 1
    return total * (0.2 if kind in (Material.GROUND, Material.LEAF) else 0.1)
