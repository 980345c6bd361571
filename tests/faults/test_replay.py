"""A replay is made, whatever happens to its renderer."""

import json
import signal

import pytest
from drive import RENDERER, wait_until

pytestmark = pytest.mark.long


def test_a_replay_is_made_though_its_renderer_is_killed(place, undisturbed):
    creature = undisturbed.told["archive"]["creature"][0]
    address = f"/api/v1/creatures/{creature}/replay"
    assert place.http.get(address).status_code == 202
    place.signal(RENDERER, signal.SIGKILL)

    def there():
        answer = place.http.get(address)
        assert answer.status_code in (200, 202), answer.text
        return answer.content if answer.status_code == 200 else None

    replay = wait_until(there, 120, "the replay is there")
    size = int.from_bytes(replay[:4], "little")
    header = json.loads(replay[4 : 4 + size])
    assert header["creature"] == creature
    floats = 2 * header["nodes"] + len(header["joints"]) + len(header["edges"])
    cells = header["size"][0] * header["size"][1]
    planes = 3 * header["frames"] + header["energy"]["frames"]
    assert len(replay) == 4 + size + 4 * header["frames"] * floats + planes * cells
