# SPDX-License-Identifier: GPL-3.0-or-later
"""One place that a rule finds: where, and what to write instead."""

from collections import namedtuple

Offence = namedtuple('Offence', 'path line text')


def excerpt(text, length=70):
    return text if len(text) <= length else text[:length - 1].rstrip() + '…'
