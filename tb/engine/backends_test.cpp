// The key `engine` in a program that was built without Verilator: this file compiles the choice of the backend so.
#include "model/engine/backends.h"

#undef FOVEA_ENGINE_RTL
#include "model/engine/backends.cpp"

#include <gtest/gtest.h>

namespace fovea::engine {
namespace {

struct NoHost : EngineBackend::Host {
  void issue(const Burst&, Picoseconds) override {}
  void interrupt(bool) override {}
};

TEST(Backends, WithoutVerilatorTheKeySaysWhatIsMissingAndWhatIsAllowed) {
  Clock clock;
  NoHost host;
  for (const std::string kind : {"none", "tlm", "rtl", "both", "both_tlm"}) {
    ParamSet set;
    EngineParams params;
    set.add(params);
    set.set("engine", kind);
    if (kind == "none" || kind == "tlm") {
      EXPECT_NE(make_backend(params, clock, host, {}), nullptr);
      continue;
    }
    try {
      make_backend(params, clock, host, {});
      ADD_FAILURE() << kind;
    } catch (const UserError& e) {
      EXPECT_EQ(std::string(e.what()), "key 'engine': '" + kind +
                                           "' needs Verilator, which was missing when this program was built; allowed: "
                                           "none, tlm");
    }
  }
}

}  // namespace
}  // namespace fovea::engine
