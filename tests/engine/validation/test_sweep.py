"""The sweep's shape, at three viscosities and with shorter strokes."""

import pytest

from microcosmos.spec import Gaits
from validation import sweep

pytestmark = pytest.mark.long


def test_swimmers_stand_to_each_other_as_in_the_paper():
    short = Gaits(forms=("ours",), viscosities=(0.05, 0.5, 2.0), period=600, block=3)
    # With so short a stroke the soft ray is still settling into its shape at ν 2.
    assert not sweep.check(short, rest=0.25).missed
