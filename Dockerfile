# Stages: base (what ./pearlite.sh setup installs), test (docker build --target test), app.
ARG DEBIAN=trixie
FROM debian:${DEBIAN}-slim AS base
WORKDIR /opt/pearlite
COPY pyproject.toml pearlite.sh ./
# Half a gigabyte that nothing here loads: documentation, the compiler and headers on which
# Debian 12's PETSc depends, and a runtime for graphics processors on which the network layer of Debian 13's MPI does.
RUN printf 'path-exclude=%s\n' '/usr/share/doc/*' '/usr/share/man/*' '/usr/share/info/*' \
        '/usr/share/locale/*' '/usr/share/unicode/*' '/usr/lib/*.a' \
        '/usr/include/*' '/usr/lib/gcc/*/cc1*' \
        '/usr/lib/gcc/*/lto*' '/usr/bin/*-lto-dump-*' '/usr/lib/*/libLLVM*' \
        '/usr/lib/*/libamd_comgr*' '/usr/lib/*/libamdhip64*' '/usr/lib/*/libz3.so*' \
        >/etc/dpkg/dpkg.cfg.d/smaller \
    && echo 'path-include=/usr/share/doc/*/copyright' >>/etc/dpkg/dpkg.cfg.d/smaller \
    && ./pearlite.sh setup && apt-get clean && rm -rf /var/lib/apt/lists/*

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
