// The harnesses of the fuzzer, with the corpus and small changes of it, in an ordinary build.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <regex>
#include <set>

#include "model/common/check.h"
#include "tb/fuzz/readers.h"
#include "tb/rounds.h"

namespace fovea::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> inputs_of(const std::string& reader) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(CORPUS) / reader)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<std::string> out;
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    out.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return out;
}

class CorpusTest : public testing::TestWithParam<Reader> {};

// Otherwise the fuzzer would begin outside the reader.
TEST_P(CorpusTest, MostFilesAreRead) {
  const auto inputs = inputs_of(GetParam().name);
  std::size_t read = 0;
  for (const std::string& input : inputs) read += run(GetParam(), input) == Result::kRead;
  EXPECT_GT(2 * read, inputs.size());
}

TEST_P(CorpusTest, ChangesAndCutsAreReadOrRefused) {
  std::mt19937 random(1);
  for (const std::string& input : inputs_of(GetParam().name))
    for (unsigned n = 0; n < rounds(100); ++n) {
      std::string bytes = input;
      for (unsigned k = random() % 4; k-- > 0 && !bytes.empty();) {
        const std::size_t at = random() % bytes.size();
        switch (random() % 4) {
          case 0: bytes[at] = static_cast<char>(random()); break;
          case 1: bytes.erase(at, random() % 8); break;
          case 2: bytes.insert(at, bytes.substr(random() % bytes.size(), random() % 16)); break;
          default: bytes.resize(at);
        }
      }
      run(GetParam(), bytes);
    }
}

INSTANTIATE_TEST_SUITE_P(Readers, CorpusTest, testing::ValuesIn(readers().begin(), readers().end()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(CorpusFoldersTest, EachIsThatOfAReader) {
  std::set<std::string> folders, names;
  for (const auto& entry : fs::directory_iterator(CORPUS)) folders.insert(entry.path().filename().string());
  for (const Reader& reader : readers()) names.insert(reader.name);
  EXPECT_EQ(folders, names);
}

// What scripts/fuzz counts the coverage of: every alternative of the expression is the beginning of a source's name.
TEST(CorpusFoldersTest, TheSourcesOfEachReaderAreThere) {
  std::string sources;
  for (const char* top : {"sw/fovea", "model"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SOURCE) / top))
      if (const auto kind = entry.path().extension(); kind == ".cpp" || kind == ".h")
        sources += fs::relative(entry.path(), SOURCE).string() + "\n";
  const std::regex group(R"((.*)\(([^()]*)\)(.*))"), alternative("[^|]+");
  const std::function<void(const std::string&, const char*)> look = [&](const std::string& text, const char* reader) {
    if (std::smatch m; std::regex_match(text, m, group)) {
      const std::string words = m[2];
      for (std::sregex_iterator at(words.begin(), words.end(), alternative), end; at != end; ++at)
        look(m[1].str() + at->str() + m[3].str(), reader);
      return;
    }
    EXPECT_TRUE(std::regex_search(sources, std::regex(text))) << reader << ": no source is called " << text;
  };
  for (const Reader& reader : readers()) look(reader.sources, reader.name);
}

Result throws(std::string_view) { throw std::runtime_error("a defect"); }
Result rambles(std::string_view) { throw UserError("one line\nand another"); }

TEST(HarnessTest, WhatIsNoRefusalOfOneLineIsADefect) {
  EXPECT_THROW(run({"throws", "", throws}, ""), std::runtime_error);
  EXPECT_THROW(run({"rambles", "", rambles}, ""), std::logic_error);
}

}  // namespace
}  // namespace fovea::fuzz
