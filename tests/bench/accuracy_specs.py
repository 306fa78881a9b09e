# SPDX-License-Identifier: GPL-3.0-or-later
"""The foils that the accuracy tables are made of: seeded specs for `foilgauge render`, per tier."""

import math
from dataclasses import dataclass
from typing import Callable

SINUSOIDAL = {
    "form": "sinusoidal",
    "bump_count": 9,
    "bump_radius_mm": 3.2,
    "bump_angle_deg": 60.0,
    "overall_radius_mm": 20.73,
    "fillet_radius_mm": 1.1,
    "thickness_mm": 0.1,
}


@dataclass
class Tier:
    title: str
    text: str
    count: int
    make: Callable  # (random generator, index) -> (spec, what the tables need to know of it)


def log_uniform(rng, low, high):
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def foil_spec(rng, index):
    """Springback opens the foil by up to 3 % and each bump by its own amount. Hands alternate."""
    foil = {
        "overall_radius_mm": float(20.73 * (1 + rng.uniform(0, 0.03))),
        "radius_springback": {"mean": float(rng.uniform(-0.01, 0.06)), "sd": float(rng.uniform(0, 0.015))},
        "rotate_deg": float(rng.uniform(0, 360)),
        "mirror": bool((index // 4) % 2),
        "first_land_mm": float(rng.uniform(1.4, 2.2)),
        "last_land_mm": float(rng.uniform(0.9, 1.7)),
    }
    return foil


def levels(rng, light_on_dark):
    """Background and contrast in units of an 8-bit scale, clear of its ends."""
    if light_on_dark:
        return {"background": float(rng.uniform(25, 45)), "contrast": float(rng.uniform(150, 180))}
    return {"background": float(rng.uniform(200, 225)), "contrast": float(rng.uniform(-170, -140))}


def spec_of(rng, foil, scanner):
    seed = int(rng.integers(1, 2**31))
    return {"schema": "foilgauge/render/1", "seed": seed, "foils": [foil], "scanner": scanner}


def record_of(foil, scanner):
    rough = scanner.get("rough", {})
    return {
        # The pixel's own square blurs as well; the renderer does not count it in blur_px.
        "blur_px": math.sqrt(scanner["blur_px"] ** 2 + 1 / 12),
        "noise": scanner["noise"],
        "contrast": scanner["contrast"],
        "bits": scanner["bits"],
        "gamma": scanner["gamma"],
        "rotate_deg": foil["rotate_deg"],
        "mirror": foil["mirror"],
        "end_lands_mm": [foil["first_land_mm"], foil["last_land_mm"]],
        "side_wall": "side_wall" in rough,
        "jpeg": "jpeg" in rough,
        "clipped": "clip_white" in scanner,
    }


def clean_scanner(rng, index):
    """Bits and polarity alternate, so that every combination comes equally often."""
    scanner = {
        "bits": 16 if index % 2 else 8,
        "gamma": log_uniform(rng, 0.45, 2.2),
        "blur_px": float(rng.uniform(0.7, 3.0)),
        "noise": log_uniform(rng, 0.3, 3.0),
    }
    scanner.update(levels(rng, light_on_dark=(index // 2) % 2 == 0))
    return scanner


def clean(rng, index):
    foil, scanner = foil_spec(rng, index), clean_scanner(rng, index)
    return spec_of(rng, foil, scanner), record_of(foil, scanner)


def sinusoidal(rng, index):
    foil, scanner = foil_spec(rng, index), clean_scanner(rng, index)
    foil.update(design=SINUSOIDAL, lip=None)
    return spec_of(rng, foil, scanner), record_of(foil, scanner)


def rough(rng, index):
    """As real flatbed scans are: blur on one side, edges that scatter by about 0.3 px and stay
    together over 5 to 15 px, correlated noise, halo, dust; half with the part's wall beside one
    edge, half with clipped white, a quarter with JPEG blocks."""
    foil = foil_spec(rng, index)
    effects = {
        "one_sided_blur_px": float(rng.uniform(0.5, 1.9)),
        "edge_roughness_um": float(rng.uniform(1.0, 2.0)),
        "edge_common_um": float(rng.uniform(0.3, 1.0)),
        "correlation_um": float(rng.uniform(26, 80)),
        "halo": {"fraction": float(rng.uniform(0.1, 0.2)), "length_px": float(rng.uniform(10, 30))},
    }
    if (index // 4) % 2:
        effects["side_wall"] = {
            "amplitude": float(rng.uniform(0.15, 0.4)),
            "direction_deg": float(rng.uniform(-180, 180)),
            "length_px": float(rng.uniform(8, 20)),
        }
    bits = 16 if index % 2 else 8
    if bits == 8 and (index // 8) % 2:
        effects["jpeg"] = {"quality": int(rng.integers(85, 96))}
    foil["mirror"] = bool(rng.integers(0, 2))
    scanner = {
        "bits": bits,
        "gamma": log_uniform(rng, 0.45, 2.2),
        "blur_px": float(rng.uniform(1.8, 2.2)),
        "noise": float(rng.uniform(0.8, 2.5)),
        "noise_correlation": float(rng.uniform(0.5, 0.7)),
        "dust": {"count": int(rng.integers(0, 60))},
        "scratches": {"count": int(rng.integers(0, 4))},
        "shading": {axis: float(rng.uniform(-0.04, 0.04)) for axis in ("x", "y", "quadratic")},
        "rough": effects,
    }
    scanner.update(levels(rng, light_on_dark=(index // 2) % 2 == 0))
    if (index // 16) % 2:  # white at the end of the scale, as a scanner's own exposure leaves it
        white = max(scanner["background"], scanner["background"] + scanner["contrast"])
        scanner["clip_white"] = float(white * rng.uniform(0.99, 1.02))
    return spec_of(rng, foil, scanner), record_of(foil, scanner)


TIERS = {
    "clean": Tier(
        "Clean",
        "Any rotation, both hands, light on dark and dark on light, 8 and 16 bit, blur 0.7 to 3 px, noise 0.3\n"
        "to 3, gamma 0.45 to 2.2, overall radius opened by 0 to 3 %, bump radius by -1 to 6 %.",
        240,
        clean,
    ),
    "sinusoidal": Tier(
        "Sinusoidal form, no lip",
        "The same scanner; long fillets and short lands. Without a lip the order of the bumps is a\n"
        "convention: the one that fits the truth counts.",
        48,
        sinusoidal,
    ),
    "rough": Tier(
        "Rough, as real scans are",
        "Blur 1.8 to 2.2 px, on one side up to 2.9, edges scattered by 1 to 2 µm with a correlation of 26 to\n"
        "80 µm, correlated noise, halo of 10 to 20 %, dust, scratches, shading; half with a side wall, half with\n"
        "clipped white, some with JPEG blocks.\n"
        "The bound knows white noise only; here it is a scale, not a mark.",
        64,
        rough,
    ),
}
