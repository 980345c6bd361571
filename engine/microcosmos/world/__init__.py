"""One world: a periodic box of viscous fluid with bodies in it, in lattice units."""

from .model import Form as Form
from .model import Limits as Limits
from .model import Measures as Measures
from .model import State as State
from .model import World as World
from .model import at_rest as at_rest
from .model import flow as flow
from .nodes import repel as repel
from .nodes import sense as sense
from .present import centre as centre
from .present import edges_there as edges_there
from .present import grown_rods as grown_rods
from .present import joints_there as joints_there
from .present import mean as mean
from .rolling import follow as follow
from .rolling import keep as keep
from .rolling import rollout as rollout
from .stepping import move as move
from .stepping import step as step
