# SPDX-License-Identifier: GPL-3.0-or-later
"""What Principled, Glossy and Metallic BSDFs reflect in Cycles 4.2 to 5.2: a model of their layers, by the tables.

Colours are (3,); `cosine` is of the viewer, E its albedo by ggx_albedo, M the mean albedo by ggx_mean_albedo.

A lobe: single scattering with the Fresnel reflectance F(v·h), times the factor 1 + Fms (1 - E) / E of *Multiscatter
GGX*, where Fms = Fss M / (1 - Fss (1 - M)). Where F is 1, the total is E + Fms (1 - E). F and its mean Fss are
  Glossy: F = 1. The lobe is multiplied by the colour, which is also Fss.
  Metal, F82 tint: ggx.fresnel_f82. Fss = F0 + (1 - F0) / 21 - B / 126, where B is the factor of its dip.
  Dielectric: F0 + (1 - F0) s(v·h), s = ggx.dielectric_shape, F0 = Specular Tint × that of the IOR, at most 1. Fss is
  F0 + (1 - F0) s', where s' is such that for a white tint Fss = (IOR - 1) / (4.08567 + 1.00071 IOR), if the IOR is > 1.
  Coat: ggx.fresnel_dielectric, Fss likewise. Its factor is also there with the distribution GGX.

What is below, from top to bottom: sheen, coat, metal, dielectric, diffuse. Each leaves of the weight of those below:
  Sheen: 1 - max over colours of sheen weight × tint × sheen albedo.
  Coat: 1 - coat weight × (F0 + (1 - F0) s) (E + Fms (1 - E)), s = dielectric_s at the coat's roughness and IOR. Then
  its tint darkens: mix(1, tint^(1 / cos t), coat weight), where t is the refracted angle of the viewer alone. Emission
  is below that. Cycles 4.2 has single scattering here, and 1 - coat weight × ggx.fresnel_dielectric(cosine).
  Metal: 1 - metallic. The metal itself is multiplied by metallic.
  Dielectric: 1 - max over colours of (F0 + (1 - F0) s) (E + Fms (1 - E)); with the distribution GGX without the last
  factor, as if nothing were lost: then a rough surface takes more from what is below than it reflects.
Specular IOR Level L: F0 is 2 L times as large, and the IOR is that of this F0, at most .99 (or its inverse, below 1).
"""

from dataclasses import dataclass, field

import numpy as np

from tests.tables import albedo, ggx, lookup

WHITE = np.ones(3)


@dataclass
class Principled:
    """Inputs of Blender's node, as far as they are modelled."""

    base_color: np.ndarray = field(default_factory=lambda: 0.8 * WHITE)
    metallic: float = 0.0
    roughness: float = 0.5
    ior: float = 1.5
    specular_ior_level: float = 0.5
    specular_tint: np.ndarray = field(default_factory=lambda: WHITE)
    sheen_weight: float = 0.0
    sheen_roughness: float = 0.5
    sheen_tint: np.ndarray = field(default_factory=lambda: WHITE)
    coat_weight: float = 0.0
    coat_roughness: float = 0.03
    coat_ior: float = 1.5
    coat_tint: np.ndarray = field(default_factory=lambda: WHITE)
    multiscatter: bool = True


def mean_dielectric(eta: float) -> float:
    """Cosine-weighted mean of a dielectric's reflectance: Kulla & Conty 2017."""
    if eta < 1.0:
        return 0.997118 + eta * (0.1014 - eta * (0.965241 + eta * 0.130607))
    return (eta - 1.0) / (4.08567 + 1.00071 * eta)


def mean_f82(f0: np.ndarray, tint: np.ndarray) -> np.ndarray:
    dip = (f0 + (1.0 - f0) * (6.0 / 7.0) ** 5) * (1.0 - tint) * 7.0 / (6.0 / 7.0) ** 6
    return f0 + (1.0 - f0) / 21.0 - dip / 126.0


def table_albedos(roughness: float, cosine: float) -> tuple[float, float]:
    """E and M."""
    at = np.array([roughness])
    return float(lookup.ggx_albedo(at, np.array([cosine]))[0]), float(lookup.ggx_mean_albedo(at)[0])


def with_multiple_scattering(roughness: float, cosine: float, fss: np.ndarray) -> np.ndarray:
    """(3,) E + Fms (1 - E); over E, the lobe's factor."""
    e, m = table_albedos(roughness, cosine)
    return e + fss * m / (1.0 - fss * (1.0 - m)) * (1.0 - e)


def single_scattering(roughness: float, cosine: float, fresnel) -> np.ndarray:  # type: ignore[no-untyped-def]
    """(3,) albedo of a lobe with the reflectance `fresnel`, of (N,1) cosines v·h, by integration."""
    wo, cos_h, wi = albedo.reflections(max(roughness, albedo.SMALLEST), np.array([cosine]))
    alpha = np.array(max(roughness, albedo.SMALLEST) ** 2)
    weights = ggx.evaluate(wi, wo, alpha) / ggx.density(wi, wo, alpha)
    return (weights[0, :, None] * fresnel(cos_h[0, :, None])).mean(0)


def lobe(roughness, cosine, fresnel, fss, multiscatter: bool) -> np.ndarray:  # type: ignore[no-untyped-def]
    """(3,) light of a white environment that a lobe reflects."""
    factor = with_multiple_scattering(roughness, cosine, fss) / table_albedos(roughness, cosine)[0]
    return single_scattering(roughness, cosine, fresnel) * (factor if multiscatter else 1.0)


def glossy(color: np.ndarray, roughness: float, cosine: float, multiscatter: bool) -> np.ndarray:
    return color * lobe(roughness, cosine, lambda cos_h: WHITE, color, multiscatter)


def metal(f0: np.ndarray, tint: np.ndarray, roughness: float, cosine: float, multiscatter: bool) -> np.ndarray:
    return lobe(roughness, cosine, lambda c: ggx.fresnel_f82(c, f0, tint), mean_f82(f0, tint), multiscatter)


def table_reflectance(f0: np.ndarray, roughness: float, cosine: float, eta: float) -> np.ndarray:
    at = (np.array([each]) for each in (roughness, cosine, eta))
    return f0 + (1.0 - f0) * lookup.dielectric_s(*at)


def principled(inputs: Principled, cosine: float) -> np.ndarray:
    """(3,) light of a white environment that is reflected."""
    weight, total = WHITE, np.zeros(3)
    roughness, multiscatter = inputs.roughness, inputs.multiscatter
    if inputs.sheen_weight:
        at = np.array([inputs.sheen_roughness]), np.array([cosine])
        reflected = inputs.sheen_weight * inputs.sheen_tint * lookup.sheen_ltc(*at)[0, 2]
        total = total + reflected
        weight = weight * (1.0 - reflected.max())
    if inputs.coat_weight:
        eta, fss = inputs.coat_ior, mean_dielectric(inputs.coat_ior) * WHITE
        fresnel = lambda c: ggx.fresnel_dielectric(c, eta) * WHITE  # noqa: E731
        total = total + inputs.coat_weight * weight * lobe(inputs.coat_roughness, cosine, fresnel, fss, True)
        reflected = table_reflectance(ggx.f0_from_ior(eta) * WHITE, inputs.coat_roughness, cosine, eta)
        reflected = reflected * with_multiple_scattering(inputs.coat_roughness, cosine, fss)
        refracted = np.sqrt(1.0 - (1.0 - cosine**2) / eta**2)
        darkened = 1.0 + (inputs.coat_tint ** (1.0 / refracted) - 1.0) * inputs.coat_weight
        weight = weight * (1.0 - inputs.coat_weight * reflected.max()) * darkened
    if inputs.metallic:
        f0, tint = np.minimum(inputs.base_color, 1.0), np.minimum(inputs.specular_tint, 1.0)
        total = total + inputs.metallic * weight * metal(f0, tint, roughness, cosine, multiscatter)
        weight = weight * (1.0 - inputs.metallic)
    eta, real_f0 = inputs.ior, ggx.f0_from_ior(inputs.ior)
    if inputs.specular_ior_level != 0.5:
        real_f0 = 2.0 * inputs.specular_ior_level * real_f0
        root = np.sqrt(min(real_f0, 0.99))
        eta = (1.0 + root) / (1.0 - root)
        eta = 1.0 / eta if inputs.ior < 1.0 else eta
    if eta != 1.0:
        f0, at_normal = np.minimum(real_f0 * inputs.specular_tint, 1.0), ggx.f0_from_ior(eta)
        s = np.clip((mean_dielectric(eta) - at_normal) / (1.0 - at_normal), 0.0, 1.0)
        fss = f0 + (1.0 - f0) * s
        fresnel = lambda c: f0 + (1.0 - f0) * ggx.dielectric_shape(c, eta)  # noqa: E731
        total = total + weight * lobe(roughness, cosine, fresnel, fss, multiscatter)
        reflected = table_reflectance(f0, roughness, cosine, eta)
        reflected = reflected * (with_multiple_scattering(roughness, cosine, fss) if multiscatter else 1.0)
        weight = weight * (1.0 - reflected.max())
    return total + weight * inputs.base_color
