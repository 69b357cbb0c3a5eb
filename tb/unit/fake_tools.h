// A stand-in for the tools of the board: `--bus-trace FILE` writes a line.
#pragma once
#include <memory>
#include <string_view>
#include <vector>

#include "sw/fovea/files/output_file.h"
#include "sw/fovea/tools/tool.h"

namespace fovea::test {

class FakeTrace : public app::Tool {
 public:
  explicit FakeTrace(const std::string& file)
      : file_(file, "--bus-trace", "a trace", [](std::string_view) { return true; }) {}
  void finish(const cpu::Counts&, app::ToolOutput&) override {
    file_.write("the trace\n");
    file_.commit();
  }

 private:
  app::OutputFile file_;
};

inline std::vector<app::ToolRow> fake_tools() {
  return {{.what = "the trace",
           .needs = app::ToolNeeds::kBoard,
           .lacks = "",
           .options = {{"--bus-trace", "FILE", "Write a trace", "a file name is needed"},
                       {.name = "--bus-trace-kept", .type = "N", .help = "Keep the last N", .fallback = "4096",
                        .least = 1, .most = 9999}},
           .make = [](const app::ToolValues& v, const app::ToolParts&) -> std::unique_ptr<app::Tool> {
             return std::make_unique<FakeTrace>(v.text("--bus-trace"));
           }}};
}

}  // namespace fovea::test
