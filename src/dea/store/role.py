"""What the samples of a diagnosed record are used for."""

from enum import IntEnum


class Role(IntEnum):
    """Use of a sample, as ``certificate.nc`` holds it: to fit, to choose by, or to certify on."""

    UNUSED = 0
    FIT = 1
    SELECT = 2
    CERTIFY = 3
