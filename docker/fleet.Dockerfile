# The image of a Ray cluster's machines. Build: docker build -f docker/fleet.Dockerfile -t joulepath-fleet .
FROM rust:1.95-slim-bookworm AS build
RUN apt-get update -qq && apt-get install -y -qq --no-install-recommends python3-venv && rm -rf /var/lib/apt/lists/*
RUN python3 -m venv /maturin && /maturin/bin/pip install --quiet 'maturin>=1.16,<2'
WORKDIR /source
COPY . .
RUN --mount=type=cache,target=/usr/local/cargo/registry --mount=type=cache,target=/source/target \
    /maturin/bin/maturin build --profile dist --locked --manifest-path crates/python/Cargo.toml --out /wheels

FROM python:3.11-slim-bookworm
# What KubeRay starts Ray and asks for its health with.
RUN apt-get update -qq && apt-get install -y -qq --no-install-recommends wget && rm -rf /var/lib/apt/lists/*
RUN --mount=type=bind,from=build,source=/wheels,target=/wheels \
    --mount=type=bind,source=tests/fleet/requirements.txt,target=/requirements.txt \
    pip install --quiet --no-cache-dir -r /requirements.txt /wheels/*.whl
RUN useradd --uid 65532 --create-home joulepath
USER 65532:65532
WORKDIR /home/joulepath
