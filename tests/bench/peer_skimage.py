#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A foil measured with scikit-image and SciPy: threshold, sub-pixel contours, Nelder-Mead circles."""

import numpy as np
from PIL import Image
from skimage.filters import threshold_otsu
from skimage.measure import find_contours

import peer_foil

Image.MAX_IMAGE_PIXELS = None


def read(path):
    image = np.asarray(Image.open(path))
    return image if image.ndim == 2 else image[..., :3].mean(axis=2)


def half_level(image):
    """Half-way between background and foil. Otsu separates the two; the foil is the smaller one."""
    coarse = image[::4, ::4]
    split = threshold_otsu(coarse)
    foil = coarse > split
    if foil.mean() > 0.5:
        foil = ~foil
    return 0.5 * (np.median(coarse[foil]) + np.median(coarse[~foil]))


def strip_contour(image, level):
    """The longest closed contour as (x, y), without its repeated last point."""
    contours = find_contours(image, level)
    longest = max(contours, key=len)
    return longest[:-1, ::-1]


def outward_normals(contour):
    """From the chord over five points either way; the sign from the polygon's area."""
    chord = np.roll(contour, -5, axis=0) - np.roll(contour, 5, axis=0)
    normals = np.column_stack((chord[:, 1], -chord[:, 0]))
    normals /= np.linalg.norm(normals, axis=1)[:, None] + 1e-300
    x, y = contour[:, 0], contour[:, 1]
    area = np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))
    return normals if area > 0 else -normals


def main():
    options = peer_foil.arguments(__doc__)
    image = read(options.scan)
    contour = strip_contour(image, half_level(image))
    peer_foil.measure(contour, outward_normals(contour), options.nominal, options.dpi)


if __name__ == "__main__":
    main()
