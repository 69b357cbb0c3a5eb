// The words for people of what results name: culprits, masters, and the groups and colours in which charts show them
// (those of stall causes are in their rows, model/cpu/core/stalls.h). The one list; the page of a report gets it with
// its data.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace fovea::results {

/// Groups of culprits that colours can tell apart.
enum class Group { kIssue, kItself, kBridge, kWay, kRows, kVideo, kCopying, kOther };
struct GroupWords {
  Group group;
  std::string_view key, words;
  unsigned colour;  ///< --cN of the page
};
/// In the order in which a bar stacks them.
std::span<const GroupWords> group_words();

/// Where the time of a request goes, except to other masters.
struct CulpritWords {
  std::string_view name;   ///< in ddr.MASTER.wait.DIRECTION.NAME and cpu.stall.CAUSE.by.NAME
  std::string_view brief;  ///< "row conflicts", in a list
  std::string_view label;  ///< the same where there is room
  std::string_view spent;  ///< "on closing one row and opening another", to follow "12 %"
  Group group;
};
std::span<const CulpritWords> culprit_words();

/// The row of a culprit that is no master; null: none.
const CulpritWords* find_culprit(std::string_view name);
/// The group of any culprit.
Group group_of(std::string_view culprit);

/// A master, by the name of its port or by that in the statistics: "the display"; empty: there is no such master.
std::string_view master_words(std::string_view name);

/// Lines and areas of a chart, each of which has the same colour in every chart: masters, and lanes of a frame.
struct Look {
  std::string_view name;
  unsigned colour;  ///< --cN of the page
};
std::span<const Look> looks();

}  // namespace fovea::results
