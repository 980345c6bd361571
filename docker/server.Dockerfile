# The server and the page, without JAX: `docker build -f docker/server.Dockerfile .`

FROM node:22-bookworm-slim AS page
WORKDIR /web
COPY web/package.json web/package-lock.json web/.npmrc ./
RUN npm ci --no-audit --no-fund
COPY web/ ./
COPY docs/glossary.md /docs/
RUN npm run build

FROM python:3.12-slim-bookworm
ENV PYTHONUNBUFFERED=1 PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=/app/engine:/app/server
WORKDIR /app
COPY requirements-server.lock ./
RUN pip install --no-cache-dir --disable-pip-version-check --require-hashes -r requirements-server.lock
COPY engine/microcosmos engine/microcosmos
COPY server server
COPY --from=page /web/dist web/dist
# A new volume has the owner of the folder that it covers.
RUN useradd --uid 10001 --no-create-home microcosmos && install -d -o microcosmos /data
USER microcosmos
ENV MICROCOSMOS_DATA=/data
VOLUME /data
EXPOSE 8000
CMD ["python", "-m", "microcosmos_server.main"]
