// How the findings say things.
#pragma once
#include <string>
#include <string_view>

namespace fovea::explain {

/// What a stall cause waits for, to follow "waits for": "D-cache line fills".
std::string waits_for(std::string_view cause);
/// The same for each cause of profile.csv but `issue`: also the sleeps, "the display's interrupt, asleep", "the EDMA".
std::string waits_or_sleeps_for(std::string_view cause);
/// Where a culprit's clocks go, to follow "12 %": "in the bridge between core and crossbar".
std::string spent(std::string_view culprit);
/// The same for the requests of another master than the core.
std::string spent_by_port(std::string_view culprit);
/// A master in words: "the display"; empty for culprits that are not masters.
std::string master(std::string_view culprit);
/// "43 %", "4.3 %", "less than 0.1 %".
std::string percent(double ratio);
/// "28.7 ms"
std::string milliseconds(double seconds);

}  // namespace fovea::explain
