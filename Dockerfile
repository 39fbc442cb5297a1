# Stages: base (what ./pearlite.sh setup installs), test (docker build --target test), app.
ARG DEBIAN=trixie
FROM debian:${DEBIAN}-slim AS base
WORKDIR /opt/pearlite
COPY pyproject.toml pearlite.sh ./
RUN ./pearlite.sh setup && rm -rf /var/lib/apt/lists/*

FROM base AS test
RUN ./pearlite.sh setup test && useradd --create-home pearlite && chown pearlite /opt/pearlite
COPY --chown=pearlite . .
USER pearlite
ENTRYPOINT ["./pearlite.sh"]
CMD ["test"]

# Nothing in it depends on who the user is: docker run --user "$(id -u):$(id -g)" -v "$PWD:/work".
FROM base AS app
COPY LICENSE CITATION.cff ./
COPY runs runs
COPY meshes meshes
COPY pearlite_petsc pearlite_petsc
RUN ./pearlite.sh exec python -m compileall -q pearlite_petsc && mkdir -m 1777 /work
WORKDIR /work
USER nobody
ENTRYPOINT ["/opt/pearlite/pearlite.sh"]
CMD ["run", "/opt/pearlite/runs/quickstart.toml", "--output", "/work/quickstart"]
