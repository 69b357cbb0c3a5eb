#!/usr/bin/env bash
# scripts/cameras over a stand-in of `fovea limits`: how many cameras it finds, with a chip whose rate of remaps is
# known, and how it deals with pages, failures and unknown words.
# Usage: cameras_table.sh SOURCE OUT
set -uo pipefail
source=$1 out=$2
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
failures=0
fail() {
  echo "$*"
  failures=$((failures + 1))
}
# A chip that remaps RATE frames a second less one for each MB/s of load. A burst of its load takes 400 ns; the load
# cannot move more than MOST bytes a second.
cat >stand_in <<'P'
#!/usr/bin/python3
import json, os, sys
args = sys.argv[1:]
assert args[0] == "limits", args
with open("calls", "a") as f:
    f.write(" ".join(args) + "\n")
settings = dict(args[i + 1].split("=", 1) for i, a in enumerate(args) if a == "-s")
over = [args[i + 1].split("=", 1) for i, a in enumerate(args) if a == "--over"]
out = args[args.index("-o") + 1]
os.makedirs(os.path.join(out, "points", "p", "run"), exist_ok=True)
if os.environ.get("FAIL"):
    sys.exit(3)
if "--binds" in args:
    with open(os.path.join(out, "binds.csv"), "w") as f:
        f.write("resource,binds,gain\ncore clock,yes,0.031\nSDRAM clock,no,0.02\nbridges of the core,yes,0.4\n")
quad = args[1].endswith("birds-eye-quad.yaml")
if "cameras.count" in settings or quad:
    relock = int(settings.get("tvp5146.relock_fields", "0"))
    with open(os.path.join(out, "limits.csv"), "w") as f:
        f.write("firmware.kernel,searched,answer,why_bad,frame.rate,frame.remap_time.max\n")
        for kernel in over[0][1].split(","):
            bad = kernel == "slow"
            time = "" if kernel == "late" else .05 if bad else .03
            f.write(f"{kernel},as it is,{'not met' if bad else 'met'},"
                    f"{'1 dropped frame' if bad else ''},{25 / (1 + relock / 2)},{time}\n")
    sys.exit(1)
load = 0
if "load.1.gap" in settings:
    gap = float(settings["load.1.gap"].removesuffix("ns")) * 1e-9
    load = int(settings["load.1.outstanding"]) * 64 / (gap + 400e-9)
load = min(load, float(os.environ.get("MOST", "1e12")))
figures = {"frame.window": .08, "bus.load.write_bytes": load * .08,
           "frame.remap_rate": float(os.environ["RATE"]) - load / 1e6}
stats = {"complete": True, **{name: {"value": value, "unit": "1"} for name, value in figures.items()}}
for name, text in ("stats", stats), ("config", {"format": "fovea run 1", "params": {}}):
    with open(os.path.join(out, "points", "p", "run", name + ".json"), "w") as f:
        json.dump(text, f)
with open(os.path.join(out, "limits.csv"), "w") as f:
    f.write("firmware.kernel\nx\n")
with open(os.path.join(out, "points.csv"), "w") as f:
    f.write("folder,command,point,status,verdict,why\n" + "p,run,as it is,0,met,\n" * int(os.environ.get("N", "1")))
P
chmod +x stand_in
# cameras NAME STATUS OPTIONS...: what it prints is in NAME.out and NAME.err, its table in NAME.csv.
cameras() {
  local name=$1 status=$2 got
  shift 2
  : >calls
  timeout 60 "$source/scripts/cameras" --fovea ./stand_in -o "$name" --csv "$name.csv" "$@" >"$name.out" 2>"$name.err"
  got=$?
  [ "$got" = "$status" ] || fail "$name: status $got, expected $status: $(tail -3 "$name.err")"
}
rows() { # NAME ROW...: the rows below the header
  local name=$1
  shift
  [ "$(tail -n +2 "$name.csv")" = "$(printf '%s\n' "$@")" ] || fail "$name: $(cat "$name.csv")"
}
has() { grep -qF -- "$2" "$1" || fail "$1 lacks '$2': $(cat "$1")"; }
live=(--ways live --kernels plain --presets 297/243 --formats pal --binds -)

# Two cameras need 50 remaps and a load of 20.736 MB/s, up to 2 % more: 71.2 a second leave 50.04 or more.
RATE=71.2 cameras two 0 "${live[@]}"
case "$(sed -n 2p two.csv)" in live,2,720x576,plain,297/243,,25.000,25.*,yes,,0.0*,) ;; *) fail "$(cat two.csv)" ;; esac
case "$(sed -n 3p two.csv)" in live,3,*,no,*' of 75.0',-0.*) ;; *) fail "two: $(cat two.csv)" ;; esac
# A little less is too little for two.
RATE=70.7 cameras one 0 "${live[@]}"
case "$(sed -n 2p one.csv)" in live,1,720x576,plain,297/243,,25.000,70.7,yes,,1.83,) ;; *) fail "$(cat one.csv)" ;; esac
case "$(sed -n 3p one.csv)" in live,2,*,no,*' of 50.0',*) ;; *) fail "one: $(cat one.csv)" ;; esac
# None; exactly one.
RATE=24.9 cameras none 0 "${live[@]}"
rows none 'live,1,720x576,plain,297/243,,25.000,24.9,no,24.9 remaps a second of 25.0,-0.00,'
RATE=25 cameras exact 0 "${live[@]}"
has exact.csv 'live,1,720x576,plain,297/243,,25.000,25.0,yes,,0.00,'
has exact.csv 'live,2,'
# A part in 10^12 less is the window's rounding; one in 10^6 is too little.
RATE=24.99999999997 cameras rounded 0 "${live[@]}"
has rounded.csv 'live,1,720x576,plain,297/243,,25.000,25.0,yes,,-0.00,'
RATE=24.99997 cameras just_less 0 "${live[@]}"
has just_less.csv 'live,1,720x576,plain,297/243,,25.000,25.0,no,'
# NTSC: 59.94 remaps and 20.716 MB/s.
RATE=82 cameras ntsc 0 "${live[@]}" --formats ntsc
has ntsc.csv 'live,2,720x480,plain,297/243,,29.970,30.'
# A memory that cannot take the frames of three cameras.
RATE=1000 MOST=30e6 cameras full 0 "${live[@]}"
has full.csv "live,3,720x576,plain,297/243,,25.000,,no,the memory cannot take the cameras' frames,,"
# Without a load there is time for 16, with it for 15; bisection asks for no number twice and for few.
RATE=700 cameras many 0 "${live[@]}"
case "$(sed -n 2p many.csv)" in live,15,*,yes,,*) ;; *) fail "many: $(cat many.csv)" ;; esac
case "$(sed -n 3p many.csv)" in live,16,*,no,*) ;; *) fail "many: $(cat many.csv)" ;; esac
for n in 1 9 13 15 16; do grep -q -- "-plain-$n-0 " calls || fail "many: $n was not asked for: $(cat calls)"; done
[ "$(grep -c -- "-0 " calls)" = 5 ] || fail "many: $(cat calls)"
# What binds, the largest gain first.
RATE=60 cameras binds 0 "${live[@]}" --binds pal
has binds.csv 'bridges of the core 40 %; core clock 3 %'
has calls '--binds frame.remap_time.mean'
has calls 'load.1.gap'
# At further presets the first format and kernel alone are asked, and not what binds.
RATE=60 cameras presets 0 --ways live --kernels plain,fast --presets 297/243,216/172 --formats pal,vga --binds pal,vga
[ "$(cut -d, -f3,5 presets.csv | tail -n +2 | sort | uniq -c | tr -s ' ')" = \
  $' 4 640x480,297/243\n 2 720x576,216/172\n 4 720x576,297/243' ] || fail "presets: $(cat presets.csv)"
[ "$(grep -c -- '--binds' calls)" = 2 ] || fail "presets: $(cat calls)"
[ "$(grep -c 'core 40 %' presets.csv)" = 2 ] || fail "presets: $(cat presets.csv)"
[ "$(grep -c 'fast,216/172' presets.csv)" = 0 ] || fail "presets: $(cat presets.csv)"
# Two cameras at a reduced rate and a reduced size, with the first kernel at the first preset. 25 remaps and 10.368
# MB/s are needed for the one, 50 and 15.36 MB/s for the other.
reduced=(--ways reduced --kernels plain,fast --presets 297/243,216/172 --formats ntsc)
RATE=66 cameras reduced 0 "${reduced[@]}"
[ "$(wc -l <reduced.csv)" = 3 ] || fail "reduced: $(cat reduced.csv)"
case "$(sed -n 2p reduced.csv)" in reduced,2,720x576,plain,297/243,,12.500,27.*,yes,,1.2*,) ;;
  *) fail "reduced: $(cat reduced.csv)" ;; esac
case "$(sed -n 3p reduced.csv)" in reduced,2,640x480,plain,297/243,,25.000,25.*,yes,,0.0*,) ;;
  *) fail "reduced: $(cat reduced.csv)" ;; esac
RATE=65 cameras reduced_less 0 "${reduced[@]}"
case "$(sed -n 3p reduced_less.csv)" in *,no,*' of 50.0',-0.0*) ;; *) fail "reduced: $(cat reduced_less.csv)" ;; esac

# One port: 27 MB/s, of which a PAL picture of 720 x 576 needs all with its blanking.
cameras port 0 --ways port --kernels plain,fast --presets 297/243,216/172 --port 1,2,4
rows port 'port,1,720x576,,,,25.000,,yes,,,' \
  'port,2,720x576,,,,25.000,,no,"54.0 MB/s with blanking, 41.5 MB/s without; the port carries 27.0 MB/s",,' \
  'port,4,720x576,,,,25.000,,no,"108.0 MB/s with blanking, 82.9 MB/s without; the port carries 27.0 MB/s",,' \
  'port,4,"360x288, by a quad processor",fast,297/243,,25.000,25.000,yes,,0.25,'
cameras port_slow 0 --ways port --kernels slow --presets 297/243 --port 1
has port_slow.csv 'slow,297/243,,25.000,25.000,no,1 dropped frame,-0.25,'

# Taking turns: the margin is what the longest remap leaves of 40 ms.
cameras turns 0 --ways turns --turns 2,8 --kernels plain,slow --presets 297/243 --relock 0,2 --rounds 3
rows turns \
  'turns,2,720x576,plain,297/243,0,,12.500,yes,,0.25,' 'turns,2,720x576,plain,297/243,2,,6.250,yes,,0.25,' \
  'turns,2,720x576,slow,297/243,0,,12.500,no,1 dropped frame,-0.25,' \
  'turns,2,720x576,slow,297/243,2,,6.250,no,1 dropped frame,-0.25,' \
  'turns,8,720x576,plain,297/243,0,,3.125,yes,,0.25,' 'turns,8,720x576,plain,297/243,2,,1.562,yes,,0.25,' \
  'turns,8,720x576,slow,297/243,0,,3.125,no,1 dropped frame,-0.25,' \
  'turns,8,720x576,slow,297/243,2,,1.562,no,1 dropped frame,-0.25,'
# Each camera has three turns, with the frames in which the decoder searches.
for n in 2-297-243-0:6 2-297-243-2:12 8-297-243-0:24 8-297-243-2:48; do
  grep -q -- "turns-${n%:*} .*run.frames=${n#*:} .*relock_fields=${n:10:1} " calls || fail "turns: $n: $(cat calls)"
done
# Without a remap in the window nothing is shown to be feasible.
cameras unmeasured 0 --ways turns --turns 2 --kernels late --presets 297/243 --relock 10
rows unmeasured 'turns,2,720x576,late,297/243,10,,2.083,no,no whole remap in the window,,'
# At further presets the first number of fields alone is asked.
cameras turns_presets 0 --ways turns --turns 2 --kernels plain --presets 297/243,216/172 --relock 2,0
rows turns_presets 'turns,2,720x576,plain,297/243,2,,6.250,yes,,0.25,' \
  'turns,2,720x576,plain,297/243,0,,12.500,yes,,0.25,' \
  'turns,2,720x576,plain,216/172,2,,6.250,yes,,0.25,'

# Pages.
printf 'before\n<!-- cameras: begin -->\nold\n<!-- cameras: end -->\nafter\n' >page.md
RATE=25 cameras check 1 "${live[@]}" --check page.md
has check.err '-old'
RATE=25 cameras write 0 "${live[@]}" --write page.md
has page.md '| 1 | 720x576 | plain | 297/243 | 25.000 | 25.0 | yes |'
[ "$(sed -n '1p;$p' page.md)" = $'before\nafter' ] || fail "page: $(cat page.md)"
RATE=25 cameras again 0 "${live[@]}" --check page.md
RATE=26 cameras other 1 "${live[@]}" --check page.md
# What a page was made with is on it, and is what it is compared with if nothing else is asked for.
RATE=60 cameras made 0 "${live[@]}" --presets 297/243,432/340 --binds pal --write page.md
has page.md 'Made with `scripts/cameras --ways live --kernels plain --presets 297/243,432/340 --formats pal'
has page.md ' --formats pal`.'
has page.md '| 432/340 |'
RATE=60 cameras same 0 --check page.md
has calls 'clocks.preset=432/340'
has calls '--binds frame.remap_time.mean'
RATE=60 cameras fewer 1 "${live[@]}" --check page.md
RATE=61 cameras differs 1 --check page.md
printf 'no table\n' >none.md
RATE=25 cameras nowhere 1 "${live[@]}" --check none.md
has nowhere.err 'lacks the lines'

# Failures.
FAIL=1 RATE=25 cameras failed 1 "${live[@]}"
has failed.err 'ended with status 3'
N=2 RATE=25 cameras points 1 "${live[@]}"
has points.err 'has 2 points, expected one'
cameras word 1 --formats secam
has word.err "format 'secam' is not known; allowed: pal, ntsc, vga"
cameras way 1 --ways port,sea
has way.err "way 'sea' is not known; allowed: turns, live, reduced, port"
[ $failures = 0 ]
