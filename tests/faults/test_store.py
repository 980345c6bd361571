"""A run whose files are in S3, and whose server fails for a while, ends with the same bytes."""

import pytest
from drive import kill_job, wait_until
from object_store import CREDENTIALS, new_prefix, own_object_store

pytestmark = pytest.mark.long


def test_a_run_in_s3_survives_an_outage_of_the_store(start_product, spec, undisturbed):
    with own_object_store() as store:
        there = {"MICROCOSMOS_ARTIFACTS_URL": new_prefix(), "AWS_ENDPOINT_URL": store.url}
        product = start_product(**CREDENTIALS, **there)
        run = product.submit(spec)
        product.reach(run, 10)
        archive = f"/api/v1/runs/{run}/archive.h5"
        with product.slowed():
            wait_until(lambda: product.http.get(archive).status_code == 200, 60, "it is saved")
            store.failing = "/runs/"  # A worker takes the run, and cannot read its checkpoint.
            kill_job(product, run)
        wait_until(lambda: product.read(run)["attempt"] == 2, 60, "it is claimed again")
        failed = store.failed
        wait_until(lambda: store.failed > failed + 3, 60, "reading fails")
        store.failing = None
        found = product.wait(run, "finished", seconds=300)
        assert (found["attempt"], found["error"]) == (2, None)
        assert product.results(run) == undisturbed
        assert product.http.get("/readyz").json()["store"] == "ok"
        product.http.delete(f"/api/v1/runs/{run}").raise_for_status()
