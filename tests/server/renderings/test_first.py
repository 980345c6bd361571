"""A first creature of a spec that may never be queued."""

import pytest
from answers import detail
from reports import DEMO as SPEC

NAME = "/first-creature"
DEMO = SPEC.model_dump(mode="json")


def test_it_is_made_once_and_kept_for_a_while(api, services):
    for _ in range(2):
        assert api.post(NAME, json=DEMO).status_code == 202
    (job_id,) = services.jobs.renderings.get_job_ids()
    name, spec, number = services.jobs.find(job_id).args
    assert (spec["experiment"], number) == (DEMO["experiment"], 0)
    services.jobs.keep_first(name, b"inputs")
    answer = api.post(NAME, json=DEMO)
    assert (answer.status_code, answer.content) == (200, b"inputs")
    assert 0 < services.jobs.redis.ttl(services.jobs._first_key(name)) <= 600


def test_numbers_count_within_the_generation(api, services):
    batch = 8
    spec = DEMO | {"search": DEMO["search"] | {"batch": batch}}
    for number in (3, batch + 3):
        assert api.post(NAME, json=spec, params={"number": number}).status_code == 202
    (job_id,) = services.jobs.renderings.get_job_ids()
    assert services.jobs.find(job_id).args[2] == 3


def test_the_renderers_reason_is_told(api, services):
    api.post(NAME, json=DEMO)
    (job_id,) = services.jobs.renderings.get_job_ids()
    services.jobs.give_up(services.jobs.find(job_id), "ValueError: too many nodes")
    refused = detail(api.post(NAME, json=DEMO), 500)
    assert refused.startswith("The first creature failed: ValueError: too many nodes")


@pytest.mark.parametrize(
    "spec",
    [{"experiment": "gaits"}, DEMO | {"search": DEMO["search"] | {"initial": ["ab" * 32]}}],
)
def test_only_searches_begin_with_random_creatures(api, spec):
    assert "random creatures" in detail(api.post(NAME, json=spec), 422)
