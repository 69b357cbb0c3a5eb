#!/usr/bin/env bash
# The program of the hardware events: every scenario is good, and each source that is not modelled is named when
# the multiplexer selects it and when its event is enabled. Usage: events.sh FOVEA PROGRAM
set -uo pipefail
fail() {
  echo "$*"
  exit 1
}
text=$(timeout 200 "$1" exec --board "$2" 2>&1) || fail "status $?: $text"
echo "$text"
grep -q 'no event was missed: good' <<<"$text" || fail 'not to the end'
grep -q BAD <<<"$text" && fail 'a scenario is bad'
for source in '3 gives EDMA event 18 to SPI3XEVT' '4 gives EDMA event 19 to SPI3REVT' \
  '6 gives EDMA event 40 to EMAC RXTHRESH' '11 gives EDMA event 45 to SPI4REVT'; do
  grep -q "EDMA_EVTMUX bit $source, which is silent here" <<<"$text" || fail "no warning: $source"
done
for event in '26 of MMC0RXEVT' '45 of SPI4REVT' '52 of PWM0'; do
  grep -q "EESR enables EDMA event $event, which is silent here" <<<"$text" || fail "no warning: $event"
done
grep -q 'EESR enables EDMA event 28' <<<"$text" && fail 'a warning about a source that is modelled'
exit 0
