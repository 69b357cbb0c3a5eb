// libFuzzer's entry: `fovea_fuzz --reader=NAME [libFuzzer's options] [folders]`.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tb/fuzz/readers.h"

namespace {

const fovea::fuzz::Reader* g_reader = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view kOption = "--reader=";
  for (int k = 1; k < *argc; ++k) {
    const std::string_view word = (*argv)[k];
    if (!word.starts_with(kOption)) continue;
    for (const auto& reader : fovea::fuzz::readers())
      if (word.substr(kOption.size()) == reader.name) g_reader = &reader;
  }
  if (!g_reader) {  // names and sources, for scripts/fuzz
    for (const auto& reader : fovea::fuzz::readers()) std::printf("%s %s\n", reader.name, reader.sources);
    std::exit(2);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fovea::fuzz::run(*g_reader, {reinterpret_cast<const char*>(data), size});
  return 0;
}
