#!/usr/bin/env bash
# Proves commands on a really bare system: makes a minimal Debian 12 in a folder, copies this tree into it and runs the
# commands there, each timed. Needs root, debootstrap and the network; not part of ctest.
#   tests/bare/prove.sh ./quickstart ./check
# The packages come from where this machine's own apt gets them. Everything is removed at the end.
set -euo pipefail
(($#)) || { printf 'usage: %s COMMAND...   for example: %s ./quickstart ./check\n' "$0" "$0" >&2; exit 2; }
((EUID == 0)) || { printf 'error: making a system in a folder needs root\n' >&2; exit 2; }
command -v debootstrap >/dev/null || { printf 'error: apt-get install debootstrap first\n' >&2; exit 2; }

source_tree=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
system=$(mktemp -d "${TMPDIR:-/tmp}/bare.XXXXXX")
trap 'rm -rf --one-file-system "$system"' EXIT
chmod 755 "$system"

# Where apt gets Debian 12 from here: "URI suite component", one a line; the first is the main archive.
sources=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
  awk '$2 ~ /^bookworm/ && $3 == "main"' | sort -u -k2,2)
mirror=$(awk '$2 == "bookworm" {print $1}' <<<"$sources")
[[ $mirror ]] || { printf 'error: apt of this machine has no source for Debian 12 (bookworm)\n' >&2; exit 1; }

printf '== Making a bare Debian 12\n'
debootstrap --variant=minbase bookworm "$system" "$mirror" >"$system.log" 2>&1 ||
  { tail -20 "$system.log" >&2; rm -f "$system.log"; exit 1; }
rm -f "$system.log"
sed 's/^/deb /' <<<"$sources" >"$system/etc/apt/sources.list"
apt-config dump | grep -E '^Acquire::(http|https|Check-Valid-Until|Check-Date|Retries)' \
  >"$system/etc/apt/apt.conf.d/90host" || true
cp -a /etc/apt/auth.conf.d/. "$system/etc/apt/auth.conf.d/" 2>/dev/null || true
cp -L /etc/resolv.conf /etc/hosts "$system/etc/"

mkdir "$system/root/sandglass"
(cd "$source_tree" && find . \( -path ./.git -o -path ./build -o -path ./runs \) -prune -o -type f -print0 |
  tar --null -T - -c) | tar -C "$system/root/sandglass" -x

# A mount and process namespace of its own: whatever happens, nothing stays mounted or running.
cat >"$system/root/prove" <<'END'
set -euo pipefail
root=$1; shift
mount -t proc proc "$root/proc"
mount -t tmpfs tmpfs "$root/dev/shm" 2>/dev/null || { mkdir -p "$root/dev/shm"; mount -t tmpfs tmpfs "$root/dev/shm"; }
for command in "$@"; do
  printf '\n== bare$ %s\n' "$command"
  start=$SECONDS
  chroot "$root" env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 \
    bash -c "cd /root/sandglass && $command" </dev/null || { printf '== failed: %s\n' "$command"; exit 1; }
  printf '== proved in %d s: %s\n' $((SECONDS - start)) "$command"
done
END
unshare --mount --pid --fork --kill-child bash "$system/root/prove" "$system" "$@"
