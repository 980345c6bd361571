"""Emitters: sources of children."""

from . import population as population
from .cma_mae import CmaMae as CmaMae
from .cma_mega import CmaMega as CmaMega
from .elites import Random as Random
from .elites import newcomers as newcomers
from .emitter import NO_PARENT as NO_PARENT
from .emitter import OPERATORS as OPERATORS
from .emitter import Children as Children
from .emitter import Divided as Divided
from .emitter import Emitter as Emitter
from .emitter import Learner as Learner
from .emitter import Outcome as Outcome
from .emitter import emit as emit
from .emitter import outcome as outcome
from .emitter import tell as tell
from .lamarckian import Lamarckian as Lamarckian
from .neat import Neat as Neat
from .vectors import IsoLine as IsoLine
