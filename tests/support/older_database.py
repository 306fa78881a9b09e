# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a station's database one of an earlier version, as a station of then left it: FILE VERSION (1 or 2)."""

import sqlite3
import sys

database = sqlite3.connect(sys.argv[1])
version = int(sys.argv[2])
for index in 'foils_not_passed', 'foils_by_order':
    database.execute('DROP INDEX ' + index)
for table in 'trail', 'events', 'destinations', 'identity', 'dispositions', 'orders', 'cause_points', 'causes', 'check_values':
    database.execute('DROP TABLE ' + table)
for column in 'coil', 'oven', 'scanner', 'order_id':
    database.execute('ALTER TABLE foils DROP COLUMN ' + column)
for column in 'dpi', 'findings', 'baseline', 'changes':
    database.execute('ALTER TABLE checks DROP COLUMN ' + column)
if version < 2:  # names were whatever bytes a file's name had
    for table in 'scans', 'files', 'arrivals':
        database.execute(f"UPDATE {table} SET path = CAST(x'6279746573FFC32E706E67' AS TEXT) WHERE path = 'bytes/FF/C3.png'")
database.execute(f'PRAGMA user_version = {version}')
database.commit()
