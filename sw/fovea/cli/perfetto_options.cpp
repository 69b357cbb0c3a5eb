#include "sw/fovea/cli/perfetto_options.h"

#include <CLI/CLI.hpp>

#include "model/common/check.h"
#include "sw/fovea/config/run_until.h"

namespace fovea::app {

void add_perfetto_options(CLI::App& command, PerfettoOptions& o) {
  command.add_option("--perfetto", o.file, "Record a trace for https://ui.perfetto.dev in this file")
      ->type_name("FILE")
      ->check(CLI::Validator(
          [](const std::string& s) { return s.empty() ? "a file name is needed" : std::string(); }, ""));
  command
      .add_option("--perfetto-tracks", o.request.tracks,
                  "Record the tracks whose GROUP/TRACK matches this regular expression")
      ->type_name("REGEX")
      ->capture_default_str();
  command
      .add_option("--perfetto-from", o.request.from,
                  "Record from this time since power-up on, or from the measured window on")
      ->type_name("TIME|window")
      ->capture_default_str();
  command
      .add_option("--perfetto-for", o.duration,
                  "Record for this long, with --perfetto-trigger for this long after it")
      ->type_name("TIME");
  command
      .add_option("--perfetto-trigger", o.request.trigger,
                  "End the recording with the first displayed frame of this kind")
      ->type_name("EVENT")
      ->check(CLI::IsMember({"dropped", "repeated", "underflow"}));
  command.add_option("--perfetto-size", o.request.megabytes,
                     "Largest size in MiB; requests and functions end when it is full, with "
                     "--perfetto-trigger the newest events are kept")
      ->type_name("MIB")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
}

PerfettoRequest perfetto_of(const PerfettoOptions& o) {
  PerfettoRequest request = o.request;
  request.file = o.file;
  const PerfettoRequest plain;
  const bool others = request.tracks != plain.tracks || request.from != plain.from || !o.duration.empty() ||
                      !request.trigger.empty() || request.megabytes != plain.megabytes;
  if (request.file.empty() && others)
    throw UserError("--perfetto-...: nothing is recorded; allowed: with --perfetto FILE");
  if (!o.duration.empty()) request.duration = parse_time("--perfetto-for", o.duration);
  return request;
}

}  // namespace fovea::app
