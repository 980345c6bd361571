"""The archive file of a run, which is also its checkpoint.

The layout is described in `docs/formats.md`. It holds no clock, host, run or attempt: the
same run gives the same bytes, however often it was interrupted.
"""

import json

from .. import search
from ..archive import file
from ..invalid import InvalidField
from ..search import state_file
from ..search.loop import ENDS, Plan, State
from ..search.parts.records import RunFacts
from ..version import VERSION
from .resume_check import devices_of


def save(plan: Plan, facts: RunFacts, state: State) -> bytes:
    """Return the file of a state; only occupied cells are written."""
    end = None
    if state.ended or state.generation >= plan.generations:
        end = {"reason": ENDS[state.ended] or "generations", "generation": state.generation}
    attributes = {
        "format": file.FORMAT,
        "version": VERSION,
        "device": json.dumps(state.devices),
        "spec": facts.spec,
        "measures": json.dumps(plan.measures),
        "force_free": json.dumps(facts.force_free),
        "operators": json.dumps(facts.operators),
        "statuses": json.dumps(search.STATUSES),
        "ended": json.dumps(end),
    }
    return file.dump(state_file.to_tree(plan, state), attributes)


def restore(plan: Plan, facts: RunFacts, data: bytes, *, other_device: bool) -> State:
    """Return the state that `save` wrote; see `devices_of` for what it raises.

    Raises `InvalidField` where the plan has more generations and `search.stop` ended the run.
    """
    tree, attributes = file.load(data)
    devices = devices_of(facts.spec, facts.device, attributes, other_device)
    state = state_file.from_tree(plan, tree, attributes, devices)
    asked = json.loads(attributes["spec"])["search"]["generations"]
    if state.ended and plan.generations > asked:
        raise InvalidField(
            "search.generations",
            f"must stay {asked}, since `search.stop.{ENDS[state.ended]}` ended the run after "
            f"generation {state.generation}; got {plan.generations}",
            most=asked,
        )
    return state
