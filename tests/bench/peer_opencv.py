#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A foil measured with OpenCV and SciPy: Otsu, findContours, gradient sub-pixel edges, Nelder-Mead
circles."""

import cv2
import numpy as np

import peer_foil

REACH_PX = 5.0
STEP_PX = 0.5


def read(path):
    image = cv2.imread(path, cv2.IMREAD_ANYDEPTH | cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise SystemExit(f"{path}: cannot be read")
    return image


def foil_mask(image):
    """Otsu; the foil is the class with fewer pixels, so the polarity need not be known."""
    mask = cv2.threshold(image, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)[1]
    mask = mask if mask.dtype == np.uint8 else (mask > 0).astype(np.uint8) * 255
    if cv2.countNonZero(mask) * 2 > mask.size:
        mask = cv2.bitwise_not(mask)
    return mask


def strip_contour(mask):
    contours = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0]
    return max(contours, key=len)[:, 0, :].astype(np.float64)


def outward_normals(contour):
    """The pixel chain is a staircase: smoothed over 21 points before it gives a direction."""
    kernel = np.ones(21) / 21

    def smooth(values):
        padded = np.concatenate((values[-10:], values, values[:10]))
        return np.convolve(padded, kernel, "valid")

    x, y = smooth(contour[:, 0]), smooth(contour[:, 1])
    tx, ty = np.roll(x, -3) - np.roll(x, 3), np.roll(y, -3) - np.roll(y, 3)
    normals = np.column_stack((ty, -tx))
    normals /= np.linalg.norm(normals, axis=1)[:, None] + 1e-300
    area = np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))
    return normals if area > 0 else -normals


def profiles(image, contour, normals, t):
    x = (contour[:, 0:1] + normals[:, 0:1] * t).astype(np.float32)
    y = (contour[:, 1:2] + normals[:, 1:2] * t).astype(np.float32)
    source = image if image.dtype == np.uint8 else image.astype(np.float32)
    rows = 16384  # remap takes at most 32767 rows
    parts = [
        cv2.remap(source, x[k : k + rows], y[k : k + rows], cv2.INTER_LINEAR, None, cv2.BORDER_REPLICATE)
        for k in range(0, len(x), rows)
    ]
    return np.concatenate(parts).astype(np.float32)


def refine(image, contour, normals):
    """Along each normal: where the gradient's magnitude has its centroid near its peak."""
    t = np.arange(-REACH_PX, REACH_PX + STEP_PX / 2, STEP_PX)
    values = profiles(image, contour, normals, t)
    gradient = np.abs(np.diff(values, axis=1))
    at = (t[:-1] + t[1:]) / 2
    gradient[gradient < 0.15 * gradient.max(axis=1, keepdims=True)] = 0
    offset = gradient @ at / np.maximum(gradient.sum(axis=1), 1e-30)
    good = np.abs(offset) < 3
    return contour[good] + normals[good] * offset[good, None], normals[good]


def main():
    options = peer_foil.arguments(__doc__)
    image = read(options.scan)
    contour = strip_contour(foil_mask(image))
    normals = outward_normals(contour)
    points, normals = refine(image, contour, normals)
    peer_foil.measure(points, normals, options.nominal, options.dpi)


if __name__ == "__main__":
    main()
