#include "sw/fovea/cli/tool_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "model/common/check.h"

namespace fovea::app {
namespace {

CLI::Validator not_empty(const char* why) {
  return CLI::Validator([why](const std::string& s) { return s.empty() ? std::string(why) : std::string(); }, "");
}

}  // namespace

void ToolOptions::add_to(CLI::App& command, std::span<const ToolRow> rows) {
  for (const ToolRow& row : rows)
    for (const ToolOption& o : row.options) {
      CLI::Option* const option = *o.type ? command.add_option(o.name, o.help)->type_name(o.type)->expected(1)
                                          : command.add_flag(o.name, o.help);
      if (*o.missing) option->check(not_empty(o.missing));
      if (!o.allowed.empty()) option->check(CLI::IsMember(o.allowed));
      if (o.most) option->check(CLI::Range(o.least, o.most));
      if (*o.fallback) option->default_str(o.fallback);
      added_.push_back({&row, &o, option});
    }
}

namespace {

/// What of `exec` provides more; the other commands provide all that their options need.
const char* what_provides(ToolNeeds needs) {
  return needs == ToolNeeds::kBoard ? "with --board" : "without --fast-memory";
}

}  // namespace

/// `--flag=false` counts as not given.
bool ToolOptions::given(const Added& added) {
  return added.given->count() && (*added.option->type || added.given->as<bool>());
}

/// A number in base 10, in whatever base it was given.
std::string ToolOptions::text_of(const Added& added) {
  if (!*added.option->type) return "";
  return added.option->most ? std::to_string(added.given->as<std::uint64_t>()) : added.given->results().back();
}

std::vector<AskedTool> ToolOptions::asked(ToolNeeds provided, bool debugger) const {
  std::vector<AskedTool> out;
  for (const Added& a : added_) {
    if (!given(a)) continue;
    if (a.row->needs > provided)
      throw UserError(fmt::format("{}: {}; allowed: {}", a.option->name, a.row->lacks, what_provides(a.row->needs)));
    if (out.empty() || out.back().row != a.row) out.push_back({a.row, {}});
    out.back().values.set(a.option->name, text_of(a));
  }
  for (const AskedTool& t : out)
    if (t.row->check) t.row->check(t.values, debugger);
  return out;
}

void ToolOptions::set_keys(const ParamSet& params, Experiment& experiment) const {
  for (const Added& a : added_) {
    if (!given(a) || !a.row->keys) continue;
    ToolValues values;
    values.set(a.option->name, text_of(a));
    a.row->keys(values, params, experiment);
  }
}

void ToolOptions::refuse_inside(const RunDir& dir) const {
  for (const Added& a : added_)
    if (a.given->count() && std::string_view(a.option->type) == "FILE" && dir.covers(text_of(a)))
      throw UserError(fmt::format("{} '{}': it lies in the output folder, which holds the files of a run only; "
                                  "choose a place beside it",
                                  a.option->name, one_line(text_of(a))));
}

}  // namespace fovea::app
