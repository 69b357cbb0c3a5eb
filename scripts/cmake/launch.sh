#!/usr/bin/env bash
# The compiler launcher: ccache, with what it needs to know of precompiled headers.
# Usage: launch.sh CCACHE SOURCE_FOLDER COMPILER ARGUMENT...
# ccache takes a precompiled header (.gch) for a part of what is compiled with it. GCC writes a hundred megabytes that are
# never the same twice, so reading them is most of a hit's time, and all that uses a header misses when the header did.
# A file .gch.sum beside it, which ccache reads in its place, says what the header was made of: the command and the
# contents of all files that it includes.
# Without the first sloppiness, ccache keeps nothing that is compiled with precompiled headers. With BASEDIR and
# NOHASHDIR, a second checkout in another folder finds what the first one has compiled; debug information then names the
# first one's sources.
set -euo pipefail
ccache=$1 source=$2
shift 2
export CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_PCH_EXTSUM=1 CCACHE_BASEDIR=$source CCACHE_NOHASHDIR=1
case " $* " in
  *.gch\ *) ;;
  *) exec "$ccache" "$@" ;;
esac
"$ccache" "$@"
header='' dependencies='' last=''
for argument in "$@"; do
  case $last in
    -o) header=$argument ;;
    -MF) dependencies=$argument ;;
  esac
  last=$argument
done
# A blank in a name is written as a backslash and a blank.
mapfile -t files < <(sed -e '1s/^[^:]*://' -e 's/\\$//' -e 's/\\ /\x01/g' "$dependencies" |
  tr -s ' ' '\n' | tr '\001' ' ' | grep .)
{
  echo "${*//"$source"/}"
  cat "${files[@]}"
} | sha256sum >"$header.sum"
