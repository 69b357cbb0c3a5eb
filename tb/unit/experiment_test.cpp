// sw/fovea/config/experiment.h: the YAML file, its errors of one line, and the order of precedence.
#include "sw/fovea/config/experiment.h"

#include <sys/stat.h>

#include "tb/own_diagnostics.h"
#include "tb/unit/support.h"

namespace fovea::app {
namespace {

using test::TempDir;
using test::user_error;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

struct LensParams : ParamGroup {
  LensParams() : ParamGroup("lens") {
    fov.matters_only("lens.mapping = equisolid", {&mapping},
                     [this] { return mapping.is("equisolid"); });
  }
  EnumParam mapping{*this,     "mapping",       "linear", {"linear", "equisolid"},
                    "mapping", Origin::kChoice, ""};
  RealParam fov{*this, "fov", "deg", 180, 10, 220, "field of view", Origin::kChoice, ""};
  ListParam table{*this, "table", {0, 0}, {2, 4}, "a table", Origin::kChoice, ""};
};
struct CameraParams : ParamGroup {
  CameraParams() : ParamGroup("camera") {}
  TextParam file{*this, "file", "", "the picture"};
  TextParam note{*this, "note", "", "any text"};
};
struct RunParams : ParamGroup {
  RunParams() : ParamGroup("run") {}
  IntParam frames{*this, "frames", IntParam::Unit::kCount, 25, 1,
                  1000,  "frames", Origin::kChoice,        ""};
};

class ExperimentTest : public testing::Test {
 protected:
  ExperimentTest() {
    params.add(lens);
    params.add(camera);
    params.add(run);
  }
  std::string load_error(const std::string& text) {
    const auto file = dir.write("bad.yaml", text);
    return user_error([&] { experiment.load(file); });
  }
  /// "…/bad.yaml:LINE: " in front, then the given parts.
  static testing::Matcher<std::string> at(int line, const std::string& part) {
    return AllOf(HasSubstr("bad.yaml:" + std::to_string(line) + ": "), HasSubstr(part));
  }
  TempDir dir;
  LensParams lens;
  CameraParams camera;
  RunParams run;
  ParamSet params;
  Experiment experiment{params};
};

class NoEffectTest : public ExperimentTest {
 protected:
  OwnDiagnostics diagnostics;
  std::vector<std::string> warned() {
    warn_without_effect(params, experiment);
    std::vector<std::string> out;
    for (const auto& [what, count] : diagnostics.counts()) {
      EXPECT_EQ(what.first, Diagnostics::Kind::kConfiguration);
      out.push_back(what.second);
    }
    return out;
  }
};

TEST_F(NoEffectTest, OfOneFileIsAWarningThatSaysWhy) {
  experiment.load(dir.write("a.yaml", "lens.fov: 90deg\nlens.mapping: linear\n"));
  EXPECT_THAT(warned(), testing::ElementsAre(AllOf(
                            StartsWith("'lens.fov' is set ("), HasSubstr("a.yaml:1) but has no effect "
                            "with lens.mapping = linear: it needs lens.mapping = equisolid"))));
}

TEST_F(NoEffectTest, OnTheCommandLineIsAWarningAlsoBesideADefault) {
  experiment.load(dir.write("a.yaml", "run.frames: 3\n"));
  experiment.override_with("lens.fov=90deg");
  EXPECT_THAT(warned(), testing::ElementsAre(HasSubstr("'lens.fov' is set (command line)")));
}

TEST_F(NoEffectTest, WithStrictIsAnError) {
  experiment.load(dir.write("a.yaml", "lens.fov: 90deg\n"));
  diagnostics.set_strict(true);
  EXPECT_THAT(user_error([&] { warn_without_effect(params, experiment); }),
              HasSubstr("'lens.fov' is set"));
}

TEST_F(NoEffectTest, ByALaterChoiceIsMeant) {
  dir.write("inner.yaml", "lens.fov: 90deg\nlens.mapping: equisolid\n");
  experiment.load(dir.write("a.yaml", "include: inner.yaml\nlens.mapping: linear\n"));
  EXPECT_THAT(warned(), testing::IsEmpty());
  experiment.override_with("lens.mapping=equisolid");
  experiment.override_with("lens.mapping=linear");
  EXPECT_THAT(warned(), testing::IsEmpty());
  experiment.override_with("lens.fov=80deg");
  EXPECT_EQ(warned().size(), 1u);
}

TEST_F(NoEffectTest, AnOuterFileThatSetsADeadKeyIsWarned) {
  dir.write("inner.yaml", "lens.mapping: linear\n");
  experiment.load(dir.write("a.yaml", "include: inner.yaml\nlens.fov: 90deg\n"));
  EXPECT_EQ(warned().size(), 1u);
}

TEST_F(NoEffectTest, AKeyThatMattersIsNot) {
  experiment.load(dir.write("a.yaml", "lens.fov: 90deg\nlens.mapping: equisolid\n"));
  EXPECT_THAT(warned(), testing::IsEmpty());
}

TEST_F(ExperimentTest, NestedAndDottedKeysAreTheSame) {
  experiment.load(dir.write("a.yaml",
                            "lens: {mapping: equisolid, fov: 170deg}\n"
                            "run.frames: 7\n"));
  EXPECT_EQ(lens.mapping(), "equisolid");
  EXPECT_EQ(lens.fov(), 170);
  EXPECT_EQ(run.frames(), 7u);
  EXPECT_EQ(experiment.name(), "a");
}

TEST_F(ExperimentTest, SequencesBecomeLists) {
  experiment.load(dir.write("a.yaml", "lens:\n  table:\n    - 1.5\n    - -2\n"));
  EXPECT_EQ(lens.table(), (std::vector<double>{1.5, -2}));
}

TEST_F(ExperimentTest, EmptyFileMeansAllDefaults) {
  experiment.load(dir.write("a.yaml", "# nothing yet\n"));
  EXPECT_FALSE(run.frames.user_set());
}

TEST_F(ExperimentTest, OriginsNameFileAndLineOrCommandLine) {
  const auto file = dir.write("a.yaml", "lens:\n  fov: 90deg\nrun:\n  frames: 3\n");
  experiment.load(file);
  experiment.override_with("run.frames=4");
  EXPECT_EQ(experiment.origin("lens.fov").text(), file.string() + ":2");
  EXPECT_EQ(experiment.origin("run.frames").text(), "command line");
  EXPECT_EQ(experiment.origin("lens.mapping").text(), "default");
}

TEST_F(ExperimentTest, IncludedFilesComeFirstWhereverTheyStand) {
  dir.write("base/base.yaml", "run.frames: 3\nlens.fov: 90deg\ncamera.file: pic.png\n");
  experiment.load(dir.write("a.yaml", "run.frames: 4\ninclude: base/base.yaml\n"));
  EXPECT_EQ(run.frames(), 4u);
  EXPECT_EQ(lens.fov(), 90);
  EXPECT_EQ(camera.file(), (dir / "base/pic.png").string()) << "relative to its own file";
  experiment.override_with("lens.fov=100deg");
  experiment.override_with("lens.fov=110deg");
  EXPECT_EQ(lens.fov(), 110) << "the last -s wins";
  EXPECT_EQ(experiment.files().size(), 2u);
}

TEST_F(ExperimentTest, FileNamesAreRelativeToTheExperimentOnlyInFiles) {
  experiment.load(dir.write("x/a.yaml", "camera: {file: ../pics/p.png, note: ../pics/p.png}\n"));
  EXPECT_EQ(camera.file(), (dir / "pics/p.png").string());
  EXPECT_EQ(camera.note(), "../pics/p.png") << "not a key that names a file";
  experiment.override_with("camera.file=p.png");
  EXPECT_EQ(camera.file(), "p.png");
  experiment.override_with("camera.file=/abs/p.png");
  EXPECT_EQ(camera.file(), "/abs/p.png");
}

TEST_F(ExperimentTest, ValuesMayHoldEqualsSigns) {
  experiment.override_with("camera.note=a=b");
  EXPECT_EQ(camera.note(), "a=b");
}

TEST_F(ExperimentTest, UnknownKeyNamesFileLineKeyAndSuggestion) {
  EXPECT_THAT(load_error("lens:\n  maping: linear\n"),
              AllOf(at(2, "'lens.maping'"), HasSubstr("did you mean 'lens.mapping'?")));
}

TEST_F(ExperimentTest, MissingUnitAndRangeSayWhatIsAllowed) {
  EXPECT_THAT(load_error("\nlens.fov: 180\n"),
              AllOf(at(2, "'lens.fov'"), HasSubstr("10deg .. 220deg")));
  EXPECT_THAT(load_error("lens: {fov: 221deg}\n"), at(1, "10deg .. 220deg"));
  EXPECT_THAT(load_error("run: {frames: 0}\n"), at(1, "1 .. 1000"));
  EXPECT_THAT(load_error("lens: {mapping: fisheye}\n"), at(1, "linear, equisolid"));
  EXPECT_THAT(load_error("lens: {table: [1, 2, 3]}\n"), at(1, "2 or 4"));
}

TEST_F(ExperimentTest, KeyWrittenTwiceIsAnErrorInAnySpelling) {
  EXPECT_THAT(load_error("run.frames: 3\nrun:\n  frames: 3\n"),
              AllOf(at(3, "'run.frames'"), HasSubstr("line 1")));
  EXPECT_THAT(load_error("run: {frames: 3, frames: 4}\n"), at(1, "written twice"));
}

TEST_F(ExperimentTest, GroupInPlaceOfKeyListsItsKeys) {
  EXPECT_THAT(load_error("lens: equisolid\n"), at(1, "lens.mapping"));
  EXPECT_THAT(load_error("run:\n  frames: {a: 1}\n"), at(2, "did you mean 'run.frames'?"));
}

TEST_F(ExperimentTest, EmptyValuesAreErrors) {
  EXPECT_THAT(load_error("run:\n  frames:\n"), HasSubstr("'run.frames' has no value"));
  EXPECT_THAT(load_error("lens: {}\n"), at(1, "'lens' has no value"));
  EXPECT_THAT(load_error("lens: {table: [1, ~]}\n"), at(1, "lens.table"));
}

TEST_F(ExperimentTest, TopLevelMustBeAMap) {
  EXPECT_THAT(load_error("just text\n"), at(1, "map"));
  EXPECT_THAT(load_error("- a\n- b\n"), at(1, "map"));
  EXPECT_THAT(load_error("~\n"), at(1, "map"));
}

TEST_F(ExperimentTest, BrokenYamlNamesTheLine) {
  EXPECT_THAT(load_error("run: {frames: 3\nlens: x\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(load_error("a: 1\n\tb: 2\n"), HasSubstr("not valid YAML"));
}

TEST_F(ExperimentTest, AliasesTagsAndSecondDocumentsAreRefused) {
  EXPECT_THAT(load_error("run: &r {frames: 3}\n"), at(1, "aliases"));
  EXPECT_THAT(load_error("lens.fov: &f 90deg\n"), at(1, "aliases"));
  EXPECT_THAT(load_error("run.frames: !!int 3\n"), at(1, "tags"));
  EXPECT_THAT(load_error("run.frames: 3\n---\nrun.frames: 4\n"), HasSubstr("one YAML document"));
}

TEST_F(ExperimentTest, AliasBombIsRefusedBeforeItGrows) {
  std::string bomb = "a: &a [x,x,x,x,x,x,x,x,x]\n";
  for (char c = 'b'; c < 'k'; ++c) {
    const std::string before = std::string("*") + static_cast<char>(c - 1);
    bomb += std::string(1, c) + ": &" + c + " [" + before;
    for (int i = 0; i < 8; ++i) bomb += "," + before;
    bomb += "]\n";
  }
  EXPECT_THAT(load_error(bomb), at(1, "aliases"));
}

TEST_F(ExperimentTest, DeepNestingIsRefused) {
  EXPECT_THAT(load_error(std::string(50'000, '[')), HasSubstr("bad.yaml:1: "));
  std::string maps;
  for (int i = 0; i < 9; ++i) maps += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  EXPECT_THAT(load_error(maps + "         a: 1\n"), HasSubstr("nested deeper"));
}

TEST_F(ExperimentTest, EightLevelsAreReadAndTheNinthIsNot) {
  const auto nested = [](unsigned levels) {
    std::string text;
    for (unsigned i = 0; i < levels; ++i)
      text += std::string(i, ' ') + (i + 1 < levels ? "a:\n" : "a: 1\n");
    return text;
  };
  EXPECT_THAT(load_error(nested(8)), HasSubstr("'a.a.a.a.a.a.a.a'"));
  EXPECT_THAT(load_error(nested(9)), at(9, "nested deeper than the 8 levels"));
}

TEST_F(ExperimentTest, SixtyFourFilesAreReadAndTheNextIsNot) {
  dir.write("leaf.yaml", "run.frames: 7\n");
  const auto including = [](unsigned files) {
    std::string text = "include: [leaf.yaml";
    for (unsigned i = 1; i < files; ++i) text += ", leaf.yaml";
    return text + "]\n";
  };
  experiment.load(dir.write("top.yaml", including(63)));
  EXPECT_EQ(run.frames(), 7u);
  Experiment another{params};
  const auto more = dir.write("more.yaml", including(64));
  EXPECT_THAT(user_error([&] { another.load(more); }), HasSubstr("more than 64"));
}

TEST_F(ExperimentTest, OversizedFileIsRefused) {
  EXPECT_THAT(load_error(std::string((1u << 20) + 1, '#')), HasSubstr("larger than"));
  experiment.load(dir.write("whole.yaml", std::string(1u << 20, '#')));
}

TEST_F(ExperimentTest, PipesAndDevicesAreRefusedAndNotReadAsEmpty) {
  const auto pipe = dir / "pipe.yaml";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& file : {pipe.string(), std::string("/dev/null")})
    EXPECT_THAT(user_error([&] { experiment.load(file); }),
                AllOf(HasSubstr(file), HasSubstr("not a regular file")));
}

TEST_F(ExperimentTest, IncludeErrorsNameTheLine) {
  EXPECT_THAT(load_error("run.frames: 3\ninclude: nowhere.yaml\n"), at(2, "nowhere.yaml"));
  EXPECT_THAT(load_error("include: bad.yaml\n"), HasSubstr("includes itself"));
  dir.write("b.yaml", "include: bad.yaml\n");
  EXPECT_THAT(load_error("include: b.yaml\n"), HasSubstr("includes itself"));
}

TEST_F(ExperimentTest, IncludeBombIsRefused) {
  for (int i = 0; i < 7; ++i) {
    const std::string next = "n" + std::to_string(i + 1) + ".yaml";
    dir.write("n" + std::to_string(i) + ".yaml",
              "include: [" + next + ", " + next + ", " + next + ", " + next + "]\n");
  }
  dir.write("n7.yaml", "");
  EXPECT_THAT(user_error([&] { experiment.load(dir / "n0.yaml"); }), HasSubstr("more than 64"));
}

TEST_F(ExperimentTest, MissingFileAndFolderAreOneLine) {
  EXPECT_THAT(user_error([&] { experiment.load(dir / "no.yaml"); }),
              AllOf(HasSubstr("no.yaml"), HasSubstr("No such file")));
  EXPECT_THAT(user_error([&] { experiment.load(dir.path()); }), HasSubstr("folder"));
}

TEST_F(ExperimentTest, LineBreaksInAValueStayInOneLineOfError) {
  EXPECT_THAT(load_error("lens.fov: \"1\\n2\"\n"), at(1, "1\\n2"));
}

TEST_F(ExperimentTest, CommandLineErrorsQuoteTheArgument) {
  EXPECT_THAT(user_error([&] { experiment.override_with("run.frames"); }),
              AllOf(StartsWith("-s 'run.frames'"), HasSubstr("key=value")));
  EXPECT_THAT(user_error([&] { experiment.override_with("run.frame=3"); }),
              AllOf(StartsWith("-s run.frame=3"), HasSubstr("did you mean 'run.frames'?")));
  EXPECT_THAT(user_error([&] { experiment.override_with("run.frames=many"); }),
              AllOf(HasSubstr("'many'"), HasSubstr("1 .. 1000")));
}

}  // namespace
}  // namespace fovea::app
