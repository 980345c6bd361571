"""Choices: which creatures, from which generation, in which runs, and that both stay so."""

import pytest
from answers import detail, errors, fields
from deletion import delete_for_good, row_counts
from reports import creature_of

from microcosmos.archive import choices as file
from microcosmos.archive import creature
from microcosmos_server.attempts.attempt import begin_choices, forget_choices
from microcosmos_server.tables import Run


def name(number):
    """The creature that entered a cell in a generation, as reports make it."""
    return creature_of(number)["creature"]


@pytest.fixture
def begun(attempt, record):
    """A run that has recorded two generations and begun neither of those that follow."""
    record(1, {0: 1.0, 1: 2.0})
    record(2, {0: 3.0})
    return attempt


@pytest.fixture
def send(api, run_id):
    def send(*numbers, **more):
        body = {"creatures": [name(number) for number in numbers]}
        return api.post(f"runs/{run_id}/choices", json=body, **more)

    return send


@pytest.fixture
def read(api, run_id):
    """Reads the choices as pairs of generation and creature."""

    def read(answer=None):
        answer = answer or api.get(f"runs/{run_id}/choices")
        assert answer.status_code == 200, answer.text
        return [(one["generation"], one["creature"]) for one in answer.json()["items"]]

    return read


def begins(attempt, generation):
    return [one["sha256"] for one in begin_choices(attempt, generation)]


@pytest.mark.postgresql
def test_choices_count_from_the_next_generation_that_has_not_begun(begun, send, read):
    assert begins(begun, 3) == []
    assert read(send(1000)) == [(None, name(1000))], "also one that was replaced"
    assert begins(begun, 3) == [], "the generation has begun without it"
    assert begins(begun, 4) == [name(1000)]
    assert read() == [(4, name(1000))]
    both = sorted([name(1001), name(2000)])
    assert read(send(2000, 1001)) == [(4, name(1000)), *((None, one) for one in both)]
    assert begins(begun, 5) == both


@pytest.mark.postgresql
def test_a_repeated_generation_reads_the_same_choices_and_no_new_ones(
    begun, send, claim_run, read
):
    begun.save(2, b"state")
    send(1000)
    assert begins(begun, 3) == [name(1000)]
    assert begins(begun, 4) == []
    again = claim_run()  # The worker died: generations 3 and 4 are computed again.
    assert again.generation == 2
    send(1001)
    assert begins(again, 3) == [name(1000)]
    assert begins(again, 4) == []
    assert begins(again, 5) == [name(1001)]
    assert read() == [(3, name(1000)), (5, name(1001))]


def test_a_choice_is_taken_back_until_its_generation_begins(begun, send, read, api, run_id):
    send(1000, 1001, 2000)
    path = f"runs/{run_id}/choices"
    left = read(api.delete(path, params={"creature": name(1000)}))
    assert left == sorted([(None, name(1001)), (None, name(2000))])
    assert begins(begun, 3) == sorted([name(1001), name(2000)])
    assert len(read(api.delete(path))) == 2, "they count"
    send(1000)
    assert read(api.delete(path)) == read()
    assert (None, name(1000)) not in read()


def test_only_creatures_of_the_run_can_be_chosen(begun, send, known, api, run_id, read):
    assert fields(send(1000, 9)) == ["creatures"]
    answer = api.post(f"runs/{run_id}/choices", json={"creatures": [known]})
    assert "creatures that have entered the archive of this run" in detail(answer, 422)
    assert fields(api.post(f"runs/{run_id}/choices", json={"creatures": []})) == ["creatures"]
    assert read() == []


def test_too_many_for_one_generation_are_refused(attempt, record, send, read):
    record(1, {cell: 1.0 for cell in range(65)})
    assert len(read(send(*range(1000, 1064)))) == 64
    (error,) = errors(send(1064))
    assert error["needed"] == "at most 64 chosen creatures for one generation"


def test_a_run_that_begins_no_further_generation_refuses(begun, send, row, update_rows):
    begins(begun, row().generations)
    assert "Cannot breed from creatures of this run: it is" in detail(send(1000), 409)
    update_rows(Run, begun_generation=2)
    begun.finish()
    assert "it is finished" in detail(send(1000), 409)


def test_searches_that_learn_from_all_offspring_refuse_and_say_why(
    begun, send, row, update_rows, api, run_id
):
    assert api.get(f"runs/{run_id}/choices").json()["refusal"] is None
    search = row().spec["search"] | {"emitters": [{"operator": "population"}]}
    update_rows(Run, spec=row().spec | {"search": search})
    (error,) = errors(send(1000), 409)
    assert error["field"] == "search.emitters"
    assert "got 'population', which learns from all of its offspring" in error["reason"]
    refusal = api.get(f"runs/{run_id}/choices").json()["refusal"]
    assert refusal == f"`{error['field']}` {error['reason']}"


def test_the_export_holds_what_counts_with_the_creatures(begun, send, api, run_id):
    send(1000)
    begins(begun, 3)
    send(1001)
    answer = api.get(f"runs/{run_id}/choices.json")
    assert f"choices-{str(run_id)[:8]}.json" in answer.headers["content-disposition"]
    (chosen,) = answer.json()["creatures"]
    assert creature.parse(chosen)["sha256"] == name(1000)
    assert file.parse(answer.content) == {3: [creature.parse(chosen)]}


def test_choices_that_the_run_no_longer_has_are_forgotten(begun, send, read, api, run_id):
    send(1000, 1001)
    begins(begun, 3)
    forget_choices(begun, 3, [name(1000)])
    assert read() == [(3, name(1001))]
    (*_, last) = api.get(f"runs/{run_id}/log").json()["entries"]
    assert last["level"] == "warning"


@pytest.mark.postgresql
def test_a_purged_run_leaves_no_choices_and_no_creatures(begun, send, services, api, run_id):
    send(1000)
    begins(begun, 3)
    api.post(f"runs/{run_id}/cancel")
    begun.cancel()
    assert row_counts(services)["choices"] == 1
    delete_for_good(api, services, run_id)
    counts = row_counts(services)
    assert counts["choices"] == counts["creatures"] == 0
