#!/usr/bin/env bash
# The engine is compiled once per instruction set. A function that these copies share with the rest of the program (a
# weak symbol outside their own namespace) could be kept in its AVX form and crash on a machine without: there must be
# none. Arguments: the engine's object files for wider instruction sets.
set -euo pipefail
(($# > 0)) || { echo "no object files given"; exit 1; }
shared=$(nm -C --defined-only "$@" | grep -E ' [WVu] ' | grep -vE 'sandglass::avx(2|512)::' | grep -vE '(typeinfo|vtable|DW\.ref)' || true)
[[ -z $shared ]] || { printf 'shared by copies for different instruction sets:\n%s\n' "$shared"; exit 1; }
[[ $(nm -C --defined-only "$@" | grep -c 'make_engine_avx') -gt 0 ]] || { echo "these are not the engine's objects"; exit 1; }
