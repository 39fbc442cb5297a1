#!/bin/bash
# Builds a stage of the Dockerfile without an engine or a registry, and runs it.
#
#   tests/setup/container.sh trixie|bookworm app|test [FOLDER]
#
# As root, with buildah and debootstrap. The image that FROM names is a minimal root of the release,
# which takes its packages from where this machine does. "app" grows five cracks as a user whom the
# image does not know into FOLDER (by default a new one) and shows the rows of fcg.csv; "test" runs
# the checks. CONTAINER_STORAGE is where the images are kept (by default removed at the end).
set -euo pipefail

release=$1 stage=$2
project=$(dirname -- "$(readlink -f -- "$0")")/../..
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export STORAGE_DRIVER=vfs BUILDAH_ISOLATION=chroot
storage=${CONTAINER_STORAGE:-$work/storage}
buildah=(buildah --root "$storage" --runroot "$work/run")
tag=pearlite:$stage-$release

mirror=$(grep -hroE 'https?://[^ ]*/debian/? ' /etc/apt/sources.list /etc/apt/sources.list.d 2>/dev/null |
    head -n 1 | tr -d ' ' || true)
[ -n "$mirror" ] ||
    mirror=$(sed -n 's/^URIs: *\([^ ]*\).*/\1/p' /etc/apt/sources.list.d/*.sources | head -n 1)

if ! "${buildah[@]}" inspect --type image "debian:$release-slim" >/dev/null 2>&1; then
    echo "== a minimal root of $release"
    root=$work/root
    debootstrap --variant=minbase --include=ca-certificates "$release" "$root" "$mirror" >"$work/log" ||
        { tail -n 20 "$work/log"; exit 1; }
    # How this machine reaches its packages: configuration, certificates, and the same mirrors.
    cp -aL /etc/apt/apt.conf.d/. "$root/etc/apt/apt.conf.d/"
    cp -aL /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
    [ ! -e /etc/pip.conf ] || cp -L /etc/pip.conf "$root/etc/pip.conf"
    own=$(. /etc/os-release && echo "$VERSION_CODENAME")
    rm -f "$root/etc/apt/sources.list"
    for list in /etc/apt/sources.list /etc/apt/sources.list.d/debian.*; do
        [ ! -e "$list" ] || sed "s/$own/$release/g" "$list" >"$root/etc/apt/${list#/etc/apt/}"
    done
    rm -rf "$root"/var/cache/apt/archives/*.deb "$root"/var/lib/apt/lists/*
    container=$("${buildah[@]}" from scratch)
    "${buildah[@]}" add --quiet "$container" "$root" / >/dev/null
    "${buildah[@]}" commit --quiet --rm "$container" "docker.io/library/debian:$release-slim" >/dev/null
    rm -rf "$root"
fi

echo "== building $tag"
SECONDS=0
"${buildah[@]}" bud --pull-never --target "$stage" --build-arg DEBIAN="$release" --tag "$tag" \
    "$project" >"$work/log" 2>&1 || { tail -n 40 "$work/log"; exit 1; }
echo "built in $SECONDS s, $("${buildah[@]}" images --format '{{.Size}}' "$tag")"

container=$("${buildah[@]}" from --pull-never "$tag")
SECONDS=0
if [ "$stage" = app ]; then
    folder=${3:-$work/out}
    mkdir -p "$folder"
    chmod 1777 "$folder"
    "${buildah[@]}" run --user 12345:12345 -v "$folder:/work" "$container" -- /opt/pearlite/pearlite.sh \
        run /opt/pearlite/runs/quickstart.toml --output /work/quickstart \
        --set ensemble.meshes=1 --set 'loading.delta_k_mpa_sqrt_m=[18]'
    echo "ran in $SECONDS s, $(sed 1d "$folder/quickstart/fcg.csv" | wc -l) rows in fcg.csv"
else
    "${buildah[@]}" run --user pearlite "$container" -- ./pearlite.sh test "${@:3}"
    echo "checked in $SECONDS s"
fi
