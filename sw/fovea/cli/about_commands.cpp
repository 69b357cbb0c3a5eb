// The commands that tell about the program: params, version, completion, man.
#include <CLI/CLI.hpp>
#include <map>
#include <ostream>

#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/cli/help.h"
#include "sw/fovea/cli/params_table.h"
#include "sw/fovea/replay/replay_params.h"

namespace fovea::app {
namespace {

struct ParamsOptions {
  std::vector<std::string> patterns;
  bool markdown = false, of_replay = false;
};

int list_params(const ParamsOptions& o, const CliContext& context) {
  ParamSet params;
  ReplayParams replay;
  const auto machine = context.make_machine(MachineKind::kBoard);
  if (o.of_replay)
    replay.declare(params);
  else
    machine->declare(params);
  context.out << params_table(params, o.patterns, o.markdown) << std::flush;
  return kExitDone;
}

int print_completion(const Call& call) {
  std::map<std::string, std::vector<OfferedKey>> keys;
  CLI::App other;  // of which only the rows are needed
  for (const Command& c : add_commands(other))
    if (c.keys) keys[c.options->get_name()] = c.keys(call.context);
  call.context.out << bash_completion(call.app, keys) << std::flush;
  return kExitDone;
}

}  // namespace

std::vector<OfferedKey> keys_of(const ParamSet& params) {
  std::vector<OfferedKey> out;
  for (const auto* p : params.all()) {
    std::string words;
    if (p->unit() == "word" || p->unit() == "bool") words = p->allowed();
    std::erase(words, ',');
    out.push_back({p->key(), words});
  }
  return out;
}

Command add_params(CLI::App& app) {
  const auto o = std::make_shared<ParamsOptions>();
  CLI::App* const c = app.add_subcommand("params", "List parameters: default, allowed values, source");
  c->add_option("pattern", o->patterns, "Part of a key, or a pattern with * and ?; of several, the keys of each")
      ->type_name("TEXT");
  c->add_flag("--markdown", o->markdown, "As a Markdown table");
  c->add_flag("--replay", o->of_replay, "Those of 'fovea replay'");
  return {c, [o](const Call& call) { return list_params(*o, call.context); }};
}

Command add_version(CLI::App& app) {
  return {app.add_subcommand("version", "Print version and commit"), [](const Call& call) {
            call.context.out << "fovea " << version_text() << std::endl;
            return int{kExitDone};
          }};
}

Command add_completion(CLI::App& app) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* const c = app.add_subcommand("completion", "Print a script that completes commands, options and keys");
  c->add_option("shell", *shell, "The shell")->required()->check(CLI::IsMember({"bash"}));
  return {c, [shell](const Call& call) { return print_completion(call); }};
}

Command add_man(CLI::App& app) {
  return {app.add_subcommand("man", "Print the manual page (for 'man -l -')"), [](const Call& call) {
            call.context.out << man_page(call.app, version_text()) << std::flush;
            return int{kExitDone};
          }};
}

}  // namespace fovea::app
