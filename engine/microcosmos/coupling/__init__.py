"""The immersed boundary: how bodies and the fluid act on each other."""

from .delta import HAT as HAT
from .delta import PESKIN as PESKIN
from .delta import ROMA as ROMA
from .delta import Kernel as Kernel
from .delta import Windows as Windows
from .delta import divided as divided
from .delta import interpolate as interpolate
from .delta import only as only
from .delta import peskin as peskin
from .delta import roma as roma
from .delta import spread as spread
from .delta import windows as windows
from .forcing import Forced as Forced
from .forcing import force_free as force_free
from .forcing import multi_direct_forcing as multi_direct_forcing
from .forcing import torque_free as torque_free
from .forcing import unprojected as unprojected
from .layers import at_nodes as at_nodes
from .layers import at_points as at_points
from .layers import points as points
