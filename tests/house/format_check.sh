#!/usr/bin/env bash
# Every source file is as clang-format leaves it. Exit 77 (skipped) without clang-format.
set -eu
command -v clang-format >/dev/null || { echo "clang-format is not installed"; exit 77; }
find core server client tests proto \( -name '*.h' -o -name '*.cc' \) -print0 |
  xargs -0 clang-format --dry-run --Werror
