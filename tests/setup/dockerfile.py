"""Carry out the Dockerfile in a bare root folder, for machines without a container engine.

    debootstrap --variant=minbase trixie ROOT
    python -m tests.setup.dockerfile [--user 12345] [--mount FOLDER:/work] ROOT app [ARGS]

As root. It reads the stages that lead to the one named, executes their instructions with chroot,
and then ENTRYPOINT with ARGS or CMD. Each stage is done once a root folder.
"""

import argparse
import json
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
# proc, sys and dev live in a mount namespace of their own and disappear with it.
ENTER = """mount --make-rprivate / && mount -t proc proc "$1/proc" &&
mount -t sysfs -o ro sysfs "$1/sys" && mount --rbind /dev "$1/dev" &&
[ -z "$2" ] || { mkdir -p "$1$3" && mount --bind "$2" "$1$3"; } || exit
root=$1 user=$4; shift 4; exec chroot ${user:+--userspec="$user"} "$root" "$@" """


@dataclass
class Stage:
    """One stage: the image or stage it starts from and its instructions in order."""

    name: str
    start: str
    instructions: list[tuple[str, str]] = field(default_factory=list)


def stages(text: str) -> dict[str, Stage]:
    """Return the stages of a Dockerfile by name."""
    found: dict[str, Stage] = {}
    lines = re.sub(r"\\\n", " ", re.sub(r"(?m)^\s*#.*\n", "", text)).splitlines()
    stage: Stage | None = None
    for line in filter(str.strip, lines):
        word, rest = line.split(None, 1)
        if word == "FROM":
            start, _, name = rest.split()
            stage = found[name] = Stage(name, start)
        elif stage is not None:
            stage.instructions.append((word, rest))
    return found


def chain(found: dict[str, Stage], name: str) -> list[Stage]:
    """Return the stages that lead to the one named, first the one that starts from an image."""
    stage = found[name]
    return [*(chain(found, stage.start) if stage.start in found else []), stage]


def copied(source: str, ignored: Sequence[str]) -> Iterator[Path]:
    """Yield the files (relative to the project) that COPY takes, without those of .dockerignore."""
    patterns = [pattern.rstrip("/") for pattern in ignored]
    start = PROJECT / source
    for path in sorted(start.rglob("*")) if start.is_dir() else [start]:
        name = path.relative_to(PROJECT)
        parts = [name, *name.parents]
        if path.is_file() and not any(
            fnmatch(str(part), p) or (p.startswith("**/") and fnmatch(part.name, p[3:]))
            for part in parts
            for p in patterns
        ):
            yield name


class Root:
    """A root folder in which instructions are executed."""

    def __init__(self, folder: Path, keep: dict[str, str]) -> None:
        self.folder, self.keep = folder, keep
        self.directory, self.user = "/", ""
        self.entry: list[str] = []
        self.command: list[str] = []

    def execute(self, command: list[str], user: str = "", mount: tuple[str, str] = ("", "")) -> int:
        where = ["/usr/bin/env", "-i", f"PATH={PATH}", *(f"{k}={v}" for k, v in self.keep.items())]
        change = ["/bin/sh", "-c", 'cd "$0" && exec "$@"', self.directory]
        enter = ["unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-c", ENTER, "sh"]
        line = [*enter, str(self.folder), *mount, user, *where, *change, *command]
        return subprocess.run(line, check=False).returncode

    def copy(self, arguments: list[str]) -> None:
        owner = [a.partition("=")[2] for a in arguments if a.startswith("--chown=")]
        *sources, target = [a for a in arguments if not a.startswith("--")]
        base = self.folder / Path(self.directory, target).relative_to("/")
        ignored = (PROJECT / ".dockerignore").read_text().split()
        made: dict[Path, None] = {}
        for source in sources:
            top = PROJECT / source
            for name in copied(source, ignored):
                place = base / (name.relative_to(source) if top.is_dir() else name.name)
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(PROJECT / name, place)
                made |= {p: None for p in [place, *place.parents] if base in p.parents}
        if owner:
            inside = [f"/{path.relative_to(self.folder)}" for path in made]
            self.execute(["chown", owner[0], *inside])

    def do(self, word: str, rest: str, dry: bool) -> None:
        match word:
            case "WORKDIR":
                self.directory = str(Path(self.directory, rest))
                (self.folder / self.directory.lstrip("/")).mkdir(parents=True, exist_ok=True)
            case "USER":
                self.user = rest
            case "ENTRYPOINT":
                self.entry = json.loads(rest)
            case "CMD":
                self.command = json.loads(rest)
            case "COPY" if not dry:
                self.copy(shlex.split(rest))
            case "RUN" if not dry:
                status = self.execute(["/bin/sh", "-c", rest], self.user)
                if status != 0:
                    raise SystemExit(f"{word} {rest}: exit status {status}")
            case "COPY" | "RUN":
                pass
            case _:
                raise SystemExit(f"{word} is not known here")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", type=Path)
    parser.add_argument("stage")
    parser.add_argument("--user", default="", help="as docker run --user")
    parser.add_argument("--mount", default=":", help="FOLDER:INSIDE, as docker run --volume")
    parser.add_argument("--env", action="append", default=[], help="NAME=VALUE in every command")
    parser.add_argument("arguments", nargs=argparse.REMAINDER, help="instead of CMD")
    options = parser.parse_args()
    root = Root(options.root.resolve(), dict(pair.split("=", 1) for pair in options.env))
    for stage in chain(stages((PROJECT / "Dockerfile").read_text()), options.stage):
        mark = root.folder / f".stage-{stage.name}"
        done = mark.exists()
        for word, rest in stage.instructions:
            root.do(word, rest, dry=done)
        mark.touch()
    folder, _, inside = options.mount.partition(":")
    command = [*root.entry, *(options.arguments or root.command)]
    return root.execute(command, options.user or root.user, (folder, inside))


if __name__ == "__main__":
    sys.exit(main())
