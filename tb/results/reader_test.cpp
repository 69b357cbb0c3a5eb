// sw/fovea/results: tables and folders of results as they are read, whole and damaged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sw/fovea/results/csv.h"
#include "sw/fovea/results/stored_run.h"
#include "sw/fovea/results/table_file.h"
#include "tb/unit/support.h"

namespace fovea::results {
namespace {

using test::TempDir;
using test::user_error;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

std::vector<std::vector<std::string>> records(const std::string& text,
                                              std::vector<std::size_t>* lines = nullptr) {
  std::vector<std::vector<std::string>> out;
  each_csv_record("f.csv", text, [&](const CsvPlace& at, std::span<const std::string> fields) {
    out.emplace_back(fields.begin(), fields.end());
    if (lines) lines->push_back(at.line);
  });
  return out;
}

TEST(CsvTest, QuotesCommasAndLineBreaks) {
  std::vector<std::size_t> lines;
  EXPECT_THAT(records("a,\"b,\"\"c\"\"\nd\",\n1,2,3\n", &lines),
              ElementsAre(ElementsAre("a", "b,\"c\"\nd", ""), ElementsAre("1", "2", "3")));
  EXPECT_THAT(lines, ElementsAre(1, 3));
  EXPECT_THAT(records("last,line"), ElementsAre(ElementsAre("last", "line")));
  EXPECT_EQ(user_error([] { records("a\nb,\"c"); }), "f.csv:2: a quote without its end");
}

TEST(CsvTest, NumbersAreWholeFields) {
  const std::filesystem::path file = "f.csv";
  const CsvPlace at{file, 7};
  EXPECT_EQ(whole(at, "18446744073709551615"), 18446744073709551615u);
  EXPECT_EQ(user_error([&] { whole(at, "18446744073709551616"); }),
            "f.csv:7: '18446744073709551616' is not a whole number");
  for (const char* bad : {"", "1 ", "-1", "0x1", "1.5"})
    EXPECT_THAT(user_error([&] { whole(at, bad); }), HasSubstr("f.csv:7"));
  for (const char* bad : {"", "nan", "inf", "1e999", "1,5"})
    EXPECT_THAT(user_error([&] { number(at, bad); }), HasSubstr("f.csv:7"));
  EXPECT_EQ(number(at, "-1.5e3"), -1500.0);
  EXPECT_EQ(time_ps(at, "2601418666.667"), 2601418666667u);
  EXPECT_EQ(time_ps(at, ""), std::nullopt);
  for (const char* bad : {"1", "1.2", "1.2345", ".", "a.000"})
    EXPECT_THAT(user_error([&] { time_ps(at, bad); }), HasSubstr("f.csv:7"));
}

TEST(CsvTest, LinesOfWindowsAndBlankOnesChangeNothing) {
  std::vector<std::size_t> lines;
  EXPECT_THAT(records("a,b\r\n\r\n1,2\r\n\n3,\"\"\r\n\"4\r\n\",5\r", &lines),
              ElementsAre(ElementsAre("a", "b"), ElementsAre("1", "2"), ElementsAre("3", ""),
                          ElementsAre("4\r\n", "5")));
  EXPECT_THAT(lines, ElementsAre(1, 3, 5, 6));
  EXPECT_THAT(records("a\rb,\"\"\n\"\"\n"), ElementsAre(ElementsAre("a\rb", ""), ElementsAre("")));
}

TEST(CsvTest, ColumnsAreFoundByTheirNames) {
  const TempDir dir;
  dir.write("t.csv", "new,b,a,other\nx,2,1,y\n");
  static constexpr std::array<std::string_view, 2> kColumns{"a", "b"};
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> others;
  each_csv_row(
      dir / "t.csv", kColumns,
      [&](const CsvPlace& at, std::span<const std::string> f) {
        EXPECT_EQ(at.line, 2u);
        rows.emplace_back(f.begin(), f.end());
      },
      kMaxTableBytes, [&](std::span<const std::string> names) { others.assign(names.begin(), names.end()); });
  EXPECT_THAT(rows, ElementsAre(ElementsAre("1", "2", "x", "y")));
  EXPECT_THAT(others, ElementsAre("new", "other"));
  const TableFile table(dir / "t.csv", {"a"});
  EXPECT_EQ(table.count(0, "a"), 1u);
  EXPECT_EQ(table.text(0, "other"), "y");
  EXPECT_FALSE(table.has("c"));
  EXPECT_THAT(user_error([&] { TableFile(dir / "t.csv", {"a", "c"}); }),
              HasSubstr("t.csv:1: there is no column 'c'; allowed: a table with the columns a,c"));
  EXPECT_THAT(user_error([&] { table.count(0, "other"); }), HasSubstr("t.csv:2: 'y' is not a whole number"));
}

TEST(CsvTest, WhatIsWrittenIsReadBack) {
  const std::vector<std::string> fields{"", "a,b", "\"q\"", "two\nlines", "end\r", "plain"};
  EXPECT_THAT(records(table_row(fields)), ElementsAre(ElementsAreArray(fields)));
}

/// A small run, of which a test changes one file.
struct StoredRunTest : testing::Test {
  TempDir dir;
  std::string config = R"({"format": "fovea run 1", "version": "1", "commit": "c", "modified": true, "experiment": "e",
    "new": {"a": 1}, "sha256": {"firmware.elf": "ab", "trace": null}, "params": {"k": {"value": "1", "default": "2",
    "origin": "set", "tag": "assumed", "source": "s", "belief": {"low": "0", "high": "3"}, "description": "d"}}})";
  std::string stats = R"({"complete": true, "neg": {"value": -5, "unit": "1"}, "ended_by": "frames",
    "kernel": "staged", "warnings": [{"kind": "w", "what": "t", "count": 2}, {}],
    "n": {"value": 7, "unit": "1", "description": "d"}, "m": {"value": null, "unit": "s"},
    "r": {"value": 1.5, "unit": "s", "description": "d"}})";
  std::string host = R"({"command": ["run", "x"], "wall_time": {"value": 1, "unit": "s"}})";
  StoredRun read(bool partial = false) {
    dir.write("r/config.json", config);
    dir.write("r/stats.json", stats);
    dir.write("r/host.json", host);
    return read_stored_run(dir / "r", partial);
  }
  std::string error(bool partial = false) {
    return user_error([&] { read(partial); });
  }
  static std::string changed(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    return text.replace(at, from.size(), to);
  }
};

TEST_F(StoredRunTest, AllThatIsWrittenIsThere) {
  const StoredRun r = read();
  EXPECT_EQ(r.version + r.commit + r.experiment + r.ended_by + r.kernel, "1ceframesstaged");
  EXPECT_TRUE(r.modified);
  EXPECT_TRUE(r.complete);
  using Hash = std::pair<std::string, std::string>;
  EXPECT_THAT(r.hashes, ElementsAre(Hash("firmware.elf", "ab"), Hash("trace", "")));
  ASSERT_EQ(r.parameters.size(), 1u);
  const Parameter& p = r.parameters[0];
  EXPECT_THAT((std::vector{p.key, p.value, p.origin, p.initial, p.tag, p.source, p.belief, p.description}),
              ElementsAre("k", "1", "set", "2", "assumed", "s", "0 .. 3", "d"));
  ASSERT_EQ(r.warnings.size(), 2u);
  EXPECT_EQ(r.warnings[0].kind + r.warnings[0].what + std::to_string(r.warnings[0].count), "wt2");
  EXPECT_EQ(r.warnings[1].count, 0u);
  ASSERT_EQ(r.figures.size(), 4u);
  EXPECT_EQ(r.figures[0].name, "m");
  EXPECT_FALSE(r.figures[0].value);
  EXPECT_EQ(r.figures[1].value, StatBase::Value(std::uint64_t{7}));
  EXPECT_TRUE(r.figures[1].whole);
  EXPECT_EQ(r.figures[2].value, StatBase::Value(-5.0));
  EXPECT_TRUE(r.figures[2].whole);
  EXPECT_EQ(r.figures[3].value, StatBase::Value(1.5));
  EXPECT_EQ(r.figures[3].unit, "s");
  EXPECT_FALSE(r.figures[3].whole);
  EXPECT_THAT(r.command_line, ElementsAre("run", "x"));
  ASSERT_EQ(r.host.size(), 1u);
  EXPECT_EQ(read_figures(dir / "r/stats.json").size(), 4u);
}

TEST_F(StoredRunTest, ResultsOfOtherCommandsNameTheirFileAndWords) {
  config = changed(config, R"("experiment": "e")",
                   R"("command": "exec", "input": "a.elf", "arguments": ["1", "2"], "options": ["--board"])");
  const StoredRun r = read();
  EXPECT_EQ(r.command + r.input, "execa.elf");
  EXPECT_THAT(r.arguments, ElementsAre("1", "2"));
  EXPECT_THAT(r.options, ElementsAre("--board"));
}

TEST_F(StoredRunTest, WithoutHostJsonTheHostIsNotKnown) {
  read();
  std::filesystem::remove(dir / "r/host.json");
  const StoredRun r = read_stored_run(dir / "r");
  EXPECT_TRUE(r.command_line.empty() && r.host.empty());
}

TEST_F(StoredRunTest, WhatIsNoFolderOfResultsIsRefused) {
  EXPECT_THAT(user_error([&] { read_stored_run(dir / "none"); }), HasSubstr("is not a folder; allowed"));
  dir.write("file", "x");
  EXPECT_THAT(user_error([&] { read_stored_run(dir / "file"); }), HasSubstr("is not a folder; allowed"));
  std::filesystem::create_directory(dir / "empty");
  EXPECT_THAT(user_error([&] { read_stored_run(dir / "empty"); }), HasSubstr("it has no config.json of Fovea's"));
  const std::string good = config;
  for (const char* foreign : {"{\"format\": 7", "[1]", "{}", "7"}) {
    config = foreign;
    EXPECT_THAT(error(), HasSubstr("it has no config.json of Fovea's")) << foreign;
  }
  config = changed(good, "fovea run 1", "fovea run 2");
  EXPECT_THAT(error(), HasSubstr("its format is 'fovea run 2'; this version reads 'fovea run 1' only"));
  config = good;
  read();
  std::filesystem::remove(dir / "r/stats.json");
  EXPECT_THAT(user_error([&] { read_stored_run(dir / "r"); }), HasSubstr("has no stats.json: its run did not end"));
}

TEST_F(StoredRunTest, PartialResultsAreTakenIfAskedFor) {
  stats = changed(stats, "true", "false");
  EXPECT_THAT(error(), HasSubstr("holds partial results: its run was stopped or its guest failed; allowed: complete"));
  EXPECT_FALSE(read(true).complete);
}

TEST_F(StoredRunTest, WhatIsDamagedIsNeverGuessed) {
  const std::string good = stats, well = config;
  const auto damage = [&](const char* from, const char* to) {
    stats = changed(good, from, to);
    EXPECT_EQ(error(true), error(false));
    return error();
  };
  EXPECT_THAT(damage(R"("complete": true, )", ""), HasSubstr("does not say whether its results are complete"));
  EXPECT_THAT(damage("true", "1"), HasSubstr("does not say whether its results are complete"));
  EXPECT_THAT(damage(": 7", ": \"7\""), HasSubstr("stats.json': 'n' is no figure with a number and a unit"));
  EXPECT_THAT(damage(": 7", ": true"), HasSubstr("'n' is no figure"));
  EXPECT_THAT(damage(R"("value": 7, )", ""), HasSubstr("'n' is no figure"));
  EXPECT_THAT(damage(R"("unit": "1", )", ""), HasSubstr("'n' is no figure"));
  EXPECT_THAT(damage("{}", "1"), HasSubstr("a warning is not an object; it is damaged"));
  EXPECT_THAT(damage("{", "["), HasSubstr("not a file of JSON; it is damaged"));
  stats = good;
  config = changed(well, "\"params\": {", "\"parameters\": {");
  EXPECT_THAT(error(), HasSubstr("config.json': it has no parameters; it is damaged"));
  config = well;
  host = changed(host, ": 1", ": \"1\"");
  EXPECT_THAT(error(), HasSubstr("host.json': 'wall_time' is no figure"));
}

}  // namespace
}  // namespace fovea::results
