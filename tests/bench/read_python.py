#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a scan as a script would: `read_python.py opencv|skimage SCAN.png` prints the seconds that the call alone took,
without the start of Python and its modules."""

import sys
import time


def reader(name):
    if name == "opencv":
        import cv2

        return lambda path: cv2.imread(path, cv2.IMREAD_UNCHANGED)
    import skimage.io

    return skimage.io.imread


def main():
    read = reader(sys.argv[1])
    began = time.perf_counter()
    picture = read(sys.argv[2])
    seconds = time.perf_counter() - began
    if picture is None or picture.size == 0:
        sys.exit(f"read_python.py: {sys.argv[2]} was not read")
    print(f"{seconds:.6f}")


if __name__ == "__main__":
    main()
