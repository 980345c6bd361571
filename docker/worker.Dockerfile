# A worker, a renderer or an auditor: `docker build -f docker/worker.Dockerfile .`
# For NVIDIA GPUs: `--build-arg LOCK=requirements-cuda.lock`, whose packages include CUDA;
# the machine needs the driver and the NVIDIA container toolkit.

FROM python:3.12-bookworm AS kernel
ARG LOCK=requirements.lock
COPY ${LOCK} ./
RUN pip install --no-cache-dir --disable-pip-version-check --require-hashes -r ${LOCK}
COPY engine/kernels kernels
RUN pip wheel --no-cache-dir --disable-pip-version-check --no-build-isolation --no-deps -w /wheels ./kernels

FROM python:3.12-slim-bookworm
ARG LOCK=requirements.lock
ENV PYTHONUNBUFFERED=1 PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=/app/engine:/app/server:/app/worker
WORKDIR /app
COPY ${LOCK} ./
RUN pip install --no-cache-dir --disable-pip-version-check --require-hashes -r ${LOCK}
COPY --from=kernel /wheels /wheels
RUN pip install --no-cache-dir --disable-pip-version-check --no-index --no-deps /wheels/*.whl
COPY engine/microcosmos engine/microcosmos
COPY server server
COPY worker worker
RUN useradd --uid 10001 --no-create-home microcosmos && install -d -o microcosmos /data
USER microcosmos
ENV MICROCOSMOS_DATA=/data JAX_COMPILATION_CACHE_DIR=/data/jax-cache
VOLUME /data
CMD ["python", "-m", "microcosmos_worker.supervisor"]
