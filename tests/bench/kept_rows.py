# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows that a benchmark keeps in a CSV: each is appended when its case is done, so that a run that was broken off goes
on where it ended, and other seeds can be added to the same file."""

import csv
import os


def read_rows(path):
    if not os.path.exists(path):
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_rows(path, rows, fields):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fields, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def append_row(path, row, fields):
    """Rows of other columns end the run: the file is of an earlier benchmark."""
    if not os.path.exists(path):
        write_rows(path, [], fields)
    with open(path, newline="", encoding="utf-8") as file:
        if next(csv.reader(file), None) != list(fields):
            raise SystemExit(f"{path}: its columns are not this benchmark's: move the file away, and run all seeds again")
    with open(path, "a", newline="", encoding="utf-8") as file:
        csv.DictWriter(file, fields, lineterminator="\n").writerow(row)


def forget_seeds(path, seeds):
    """--fresh: drops the rows of these seeds, of which a later program makes new ones. Rows of other seeds stay. A file
    without a column of seeds is of one seed, and goes whole."""
    rows = read_rows(path)
    others = [row for row in rows if "seed" in row and int(row["seed"]) not in seeds]
    if others:
        write_rows(path, others, list(others[0]))
    elif os.path.exists(path):
        os.remove(path)
