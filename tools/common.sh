# shellcheck shell=bash
# Sourced by the tools: where things are, and which python to use.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${FSI_BUILD_DIR:-$root/build}
export FSI_BUILD_DIR=$build
# builds side by side share objects: paths below the root are relative for the compiler cache
export CCACHE_BASEDIR=${CCACHE_BASEDIR:-$root}
export PYTHONPATH="$root/python${PYTHONPATH:+:$PYTHONPATH}"

# what stands at the top of a tool
usage() { sed -n '2,/^set/{/^#/s/^# \{0,1\}//p}' "$0"; }
case ${0##*/}/${1:-} in
  run/* | cost/* | pytest/*) ;; # say more
  */-h | */--help) usage; exit 0 ;;
esac

say() { printf '%s: %s\n' "${0##*/}" "$*"; }

# Prints the first python3 that has all the named modules; the one on the PATH may lack those that apt installed.
find_python() {
  local candidate check='import sys, importlib.util as u; sys.exit(not all(u.find_spec(m) for m in sys.argv[1:]))'
  for candidate in python3 /usr/bin/python3; do
    if command -v "$candidate" >/dev/null 2>&1 && "$candidate" -c "$check" "$@" 2>/dev/null; then
      command -v "$candidate"
      return
    fi
  done
  return 1
}
