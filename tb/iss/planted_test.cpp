// A core with a defect in one class of instructions fails the random comparison.
#include "tb/iss/planted.h"

#include <algorithm>
#include <iomanip>
#include <iostream>

#include "tb/iss/random_compare.h"
#include "tb/iss/system_code.h"
#include "tb/iss/system_machine.h"

int fovea_planted = 0;

namespace fovea::cpu::test {
namespace {

/// Classes whose rows are privileged, undefined or calls: random privileged code has them.
bool of_the_system(InsnClass c) {
  return c == InsnClass::kException || c == InsnClass::kCoprocessor ||
         c == InsnClass::kThumbException;
}

std::uint32_t resume() {
  const std::string names = output_of(ARM_PREFIX "nm " SYSTEM_DIR "/system_random.elf");
  std::istringstream in(names);
  std::string value, kind, each;
  while (in >> value >> kind >> each)
    if (each == "resume") return static_cast<std::uint32_t>(std::stoul(value, nullptr, 16));
  throw std::runtime_error("no symbol resume");
}

/// The log of a privileged program; iss.system_differential compares such logs with QEMU's.
std::string log_of(const SystemCode& code) {
  SystemMachine m;
  m.load(0, read_file(SYSTEM_DIR "/system_random.bin"));
  m.load(SystemCode::kBase, code.image);
  return m.run(Caches::kNone);
}

/// @return what `run` gives differs from `right`, or it goes astray
template <class F>
bool noticed(std::size_t number, F run) {
  fovea_planted = static_cast<int>(number);
  bool wrong = true;
  try {
    wrong = run();
  } catch (const std::exception& e) {
    std::cout << "(" << e.what() << ") ";
  }
  fovea_planted = 0;
  return wrong;
}

TEST(PlantedTest, ADefectInEachClassIsNoticed) {
  const RandomProgram p = generate(4711, 400, 10);
  const std::string want = by_qemu(p);
  ASSERT_TRUE(differences(p, by_core(p).output, want).empty());
  const SystemCode code = generate_system(4711, 30, 40, resume());
  const std::string log = log_of(code);
  std::vector<bool> seen(static_cast<std::size_t>(InsnClass::kCount));
  std::size_t number = 0;
  for (const Defect& d : kDefects) {
    ++number;
    seen[static_cast<std::size_t>(d.insn_class)] = true;
    const bool wrong =
        of_the_system(d.insn_class) || d.privileged
            ? noticed(number, [&] { return log_of(code) != log; })
            : noticed(number, [&] {
                return !differences(p, by_core(p, true, 5 * kPsPerMs).output, want).empty();
              });
    std::cout << std::setw(24) << class_name(d.insn_class) << ": " << d.what
              << (wrong ? ", noticed\n" : ", NOT noticed\n");
    EXPECT_TRUE(wrong) << class_name(d.insn_class) << ": " << d.what;
  }
  for (std::size_t c = 0; c < seen.size(); ++c)
    EXPECT_TRUE(seen[c]) << class_name(static_cast<InsnClass>(c));
  EXPECT_TRUE(differences(p, by_core(p).output, want).empty()) << "all are off again";
}

}  // namespace
}  // namespace fovea::cpu::test
