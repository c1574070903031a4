/// What a configuration says when it cannot be used, and what it becomes when it can.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "config/config.hpp"
#include "core/angles.hpp"
#include "core/error.hpp"

namespace noctule::config {
namespace {

enum class Colour { red, green };

struct Noise {
  double base = 0.003;
  double angle = radians(1.5);
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("base_cm", &Noise::base, unit::centimetre, "sd at 0", positive());
    v.field("angle_deg", &Noise::angle, unit::degree, "sd of angles", between(0.0, 90.0));
  }
};

struct Wall {
  std::string name;
  Vector2 begin = Vector2::Zero();
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &Wall::name, "its name");
    v.field("begin_cm", &Wall::begin, unit::centimetre, "where it begins");
  }
};

struct Sound {
  double speed = 343.0;
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("speed_m_per_s", &Sound::speed, unit::metre_per_second, "its speed", positive());
  }
};

struct Parameters {
  int particles = 100;
  std::int64_t big = -1;
  std::uint64_t seed = 7;
  bool quantise = true;
  Colour colour = Colour::red;
  Pose2 start;
  std::vector<double> weights{1.0};
  std::vector<Vector2> path;
  std::vector<Wall> walls;
  Noise noise;
  std::optional<Noise> extra;
  std::filesystem::path data;
  std::variant<Noise, Sound> source;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("particles", &Parameters::particles, unit::one, "number of particles", at_least(1));
    v.field("big", &Parameters::big, unit::one, "a long number");
    v.field("seed", &Parameters::seed, unit::one, "a seed");
    v.field("quantise", &Parameters::quantise, "round the ranges");
    v.choice("colour", &Parameters::colour, {{"red", Colour::red}, {"green", Colour::green}}, "a colour");
    v.field("start", &Parameters::start, unit::metre_degree, "start");
    v.field("weights", &Parameters::weights, unit::one, "weights", at_least(0.0));
    v.field("path_m", &Parameters::path, unit::metre, "way-points");
    v.list("walls", &Parameters::walls, "walls");
    v.group("noise", &Parameters::noise, "noise");
    v.group("extra", &Parameters::extra, "more noise");
    v.field("data", &Parameters::data, "a data file");
    v.one_of("source", &Parameters::source, {"noise", "sound"}, "what is heard");
  }
  std::string validate() const {
    return particles == 13 && seed == 13 ? "particles and seed: expected at most one 13, got two" : "";
  }
};

std::string problem_of(const std::string& text, std::vector<std::string> assignments = {}) {
  try {
    (void)parse<Parameters>(text, "p.yaml", assignments);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no problem";
}

/// A folder that is gone after the test.
class FilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    directory_ = std::filesystem::temp_directory_path() /
                 ("noctule_config_" + std::string(info->name()) + "_" + std::to_string(::getpid()));
    std::filesystem::create_directories(directory_ / "filters");
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::filesystem::path file(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name) << text;
    return directory_ / name;
  }
  std::string problem_of_file(const std::filesystem::path& path) const {
    try {
      (void)load<Parameters>(path);
    } catch (const InputError& e) {
      std::string text = e.what();
      const std::string prefix = directory_.string() + "/";
      for (std::size_t at = 0; (at = text.find(prefix)) != std::string::npos;) text.erase(at, prefix.size());
      return text;
    }
    return "no problem";
  }
  std::filesystem::path directory_;
};

TEST(Read, EmptyTextGivesDefaults) {
  const auto p = parse<Parameters>("");
  EXPECT_EQ(p.particles, 100);
  EXPECT_EQ(p.noise.base, 0.003);
  EXPECT_FALSE(p.extra.has_value());
}

TEST(Read, EveryKindOfValue) {
  const auto p = parse<Parameters>(R"(
particles: 5
big: -9223372036854775808
seed: 18446744073709551615
quantise: false
colour: green
start: [1, -2.5, 90]
weights: [1, 2e-1]
path_m: [[0, 1], [2, 3]]
walls:
  - {name: north, begin_cm: [150, 0]}
  - name: "5"
noise: {base_cm: 0.5, angle_deg: 3}
extra: {base_cm: 1}
)");
  EXPECT_EQ(p.particles, 5);
  EXPECT_EQ(p.big, std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(p.seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_FALSE(p.quantise);
  EXPECT_EQ(p.colour, Colour::green);
  EXPECT_EQ(p.start, (Pose2{1.0, -2.5, radians(90.0)}));
  EXPECT_EQ(p.weights, (std::vector<double>{1.0, 0.2}));
  EXPECT_EQ(p.path, (std::vector<Vector2>{{0.0, 1.0}, {2.0, 3.0}}));
  ASSERT_EQ(p.walls.size(), 2u);
  EXPECT_EQ(p.walls[0].begin, Vector2(1.5, 0.0));
  EXPECT_EQ(p.walls[1].name, "5");
  EXPECT_EQ(p.noise.base, 0.005);
  EXPECT_EQ(p.noise.angle, radians(3.0));
  ASSERT_TRUE(p.extra.has_value());
  EXPECT_EQ(p.extra->base, 0.01);
}

TEST(Read, SaysWhereWhatAndWhy) {
  EXPECT_EQ(problem_of("\nparticles: -5"), "p.yaml:2: particles: expected an integer >= 1, got -5");
  EXPECT_EQ(problem_of("partcles: 5"), "p.yaml:1: unknown key 'partcles', did you mean 'particles'?");
  EXPECT_EQ(problem_of("noise:\n  bsae_cm: 5"), "p.yaml:2: noise: unknown key 'bsae_cm', did you mean 'base_cm'?");
  EXPECT_EQ(problem_of("noise: {base_m: 5}"),
            "p.yaml:1: noise: unknown key 'base_m', wrong unit: expected 'base_cm' in cm");
  EXPECT_EQ(problem_of("noise: {angle: 5}"),
            "p.yaml:1: noise: unknown key 'angle', wrong unit: expected 'angle_deg' in deg");
  EXPECT_EQ(problem_of("noise: {zz: 5}"), "p.yaml:1: noise: unknown key 'zz', known are: base_cm, angle_deg");
  EXPECT_EQ(problem_of("walls: [{nothing_like_it: 1}]"),
            "p.yaml:1: walls[0]: unknown key 'nothing_like_it', known are: name, begin_cm");
  EXPECT_EQ(problem_of("particles: 5\nparticles: 6"), "p.yaml:2: duplicate key 'particles', first in p.yaml:1");
}

TEST(Read, RefusesWrongTypes) {
  EXPECT_EQ(problem_of("particles: 1.5"), "p.yaml:1: particles: expected an integer >= 1, got 1.5");
  EXPECT_EQ(problem_of("particles: 1e3"), "p.yaml:1: particles: expected an integer >= 1, got 1e3");
  EXPECT_EQ(problem_of("particles: \"5\""), "p.yaml:1: particles: expected an integer >= 1, got \"5\"");
  EXPECT_EQ(problem_of("particles: many"), "p.yaml:1: particles: expected an integer >= 1, got many");
  EXPECT_EQ(problem_of("particles:"), "p.yaml:1: particles: expected an integer >= 1, got nothing");
  EXPECT_EQ(problem_of("particles: [1]"), "p.yaml:1: particles: expected an integer >= 1, got a list");
  EXPECT_EQ(problem_of("particles: 99999999999"),
            "p.yaml:1: particles: expected an integer >= 1 of 32 bits, got 99999999999");
  EXPECT_EQ(problem_of("seed: -1"), "p.yaml:1: seed: expected an integer >= 0, got -1");
  EXPECT_EQ(problem_of("quantise: yes"), "p.yaml:1: quantise: expected true or false, got yes");
  EXPECT_EQ(problem_of("colour: blue"), "p.yaml:1: colour: expected one of red, green, got blue");
  EXPECT_EQ(problem_of("start: [1, 2]"), "p.yaml:1: start: expected a pose [x, y, yaw] in m, m, deg, got a list");
  EXPECT_EQ(problem_of("path_m: [[1, 2], 3]"), "p.yaml:1: path_m[1]: expected a point [x, y] in m, got 3");
  EXPECT_EQ(problem_of("walls: {}"), "p.yaml:1: walls: expected a list of maps, got a map");
  EXPECT_EQ(problem_of("walls: [{name: [1]}]"), "p.yaml:1: walls[0].name: expected a text, got a list");
  EXPECT_EQ(problem_of("noise: 3"), "p.yaml:1: noise: expected a map of keys, got 3");
  EXPECT_EQ(problem_of("- 1"), "p.yaml:1: expected a map of keys, got a list");
}

TEST(Read, OneOfSeveralTypes) {
  const auto p = parse<Parameters>("source: {type: sound, speed_m_per_s: 340}");
  EXPECT_EQ(std::get<Sound>(p.source).speed, 340.0);
  EXPECT_EQ(std::get<Noise>(parse<Parameters>("source: {base_cm: 1, type: noise}").source).base, 0.01);
  EXPECT_EQ(problem_of("source: {speed_m_per_s: 1}"),
            "p.yaml:1: source: expected a map with the key 'type' (one of noise, sound), got a map");
  EXPECT_EQ(problem_of("source: {type: light}"), "p.yaml:1: source.type: expected one of noise, sound, got light");
  EXPECT_EQ(problem_of("source: {type: noise, speed_m_per_s: 1}"),
            "p.yaml:1: source: unknown key 'speed_m_per_s', known are: type, base_cm, angle_deg");
}

TEST(Read, RefusesNumbersThatAreNoneOrOutOfRange) {
  EXPECT_EQ(problem_of("noise: {base_cm: 0}"), "p.yaml:1: noise.base_cm: expected a number > 0 in cm, got 0");
  EXPECT_EQ(problem_of("noise: {angle_deg: 91}"),
            "p.yaml:1: noise.angle_deg: expected a number in [0, 90] in deg, got 91");
  EXPECT_EQ(problem_of("noise: {angle_deg: 3 rad}"),
            "p.yaml:1: noise.angle_deg: expected a number in [0, 90] in deg, got 3 rad");
  EXPECT_EQ(problem_of("weights: [1, -1]"), "p.yaml:1: weights[1]: expected a number >= 0, got -1");
  for (const char* text : {".nan", "nan", "NaN", "-.inf", ".inf", "inf"}) {
    EXPECT_EQ(problem_of(std::string("start: [0, ") + text + ", 0]"),
              std::string("p.yaml:1: start[1]: expected a finite number, got ") + text);
  }
  EXPECT_NE(problem_of("start: [1e999, 0, 0]"), "no problem");
}

TEST(Read, ListsAllProblemsAtOnce) {
  EXPECT_EQ(problem_of("particles: 0\nnoise: {base_cm: x, angle_rad: 1}\nseed: 1.0"),
            "p.yaml:1: particles: expected an integer >= 1, got 0\n"
            "p.yaml:2: noise.base_cm: expected a number > 0 in cm, got x\n"
            "p.yaml:2: noise: unknown key 'angle_rad', wrong unit: expected 'angle_deg' in deg\n"
            "p.yaml:3: seed: expected an integer >= 0, got 1.0");
}

TEST(Read, ChecksAcrossFieldsWhenEachIsSound) {
  EXPECT_EQ(problem_of("particles: 13\nseed: 13"), "p.yaml:1: particles and seed: expected at most one 13, got two");
  EXPECT_EQ(problem_of("particles: 13\nseed: 13\nbig: x"), "p.yaml:3: big: expected an integer, got x");
}

TEST(Read, RefusesWhatIsNotYaml) {
  EXPECT_TRUE(problem_of("particles: 1\nnoise: {base_cm: 1\n").starts_with("p.yaml:")) << problem_of("noise: {");
  EXPECT_NE(problem_of("particles: 1\n\tbig: 2").find("not valid YAML"), std::string::npos);
  EXPECT_EQ(problem_of("particles: 1\n---\nparticles: 2"), "p.yaml:3: expected one YAML document, got 2");
  EXPECT_EQ(problem_of("[1, 2]: 3"), "p.yaml:1: expected a plain word as key, got a list or a map");
  EXPECT_NE(problem_of("noise: &a [*a]"), "no problem");  // contains itself
  std::string bomb = "a0: &a0 [x]\n";
  for (int i = 1; i < 40; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + last + ", " + last + "]\n";
  }
  EXPECT_NE(problem_of(bomb).find("more than a million values"), std::string::npos);
}

TEST(Read, AnyBytesAreEitherReadOrRefused) {
  const std::string sound = "particles: 5\nnoise: {base_cm: 0.5}\nwalls:\n  - {name: a, begin_cm: [1, 2]}\n";
  for (std::size_t at = 0; at < sound.size(); ++at) {
    for (const char c : {'\0', '\xff', ':', '[', '}', '&', '*', '!', '%', '\n', '"', '-'}) {
      std::string text = sound;
      text[at] = c;
      EXPECT_FALSE(problem_of(text).empty());
      EXPECT_FALSE(problem_of(text.substr(0, at)).empty());
    }
  }
}

TEST(Set, OverridesSingleValues) {
  const std::vector<std::string> assignments{"noise.base_cm=2", "walls[1].name=b", "path_m=[[1, 2]]",
                                             "extra.base_cm=4"};
  const auto p = parse<Parameters>("walls: [{name: x}, {name: y}]", "p.yaml", assignments);
  EXPECT_EQ(p.noise.base, 0.02);
  EXPECT_EQ(p.walls[0].name, "x");
  EXPECT_EQ(p.walls[1].name, "b");
  EXPECT_EQ(p.path.size(), 1u);
  EXPECT_EQ(p.extra.value().base, 0.04);
}

TEST(Set, SaysWhatIsWrong) {
  EXPECT_EQ(problem_of("", {"particles=-5"}), "--set particles=-5: particles: expected an integer >= 1, got -5");
  EXPECT_EQ(problem_of("", {"noise.bas_cm=1"}),
            "--set noise.bas_cm=1: noise: unknown key 'bas_cm', did you mean 'base_cm'?");
  EXPECT_EQ(problem_of("", {"particles"}), "--set particles: expected key.path=value");
  EXPECT_EQ(problem_of("", {"=5"}), "--set =5: expected key.path=value");
  EXPECT_EQ(problem_of("", {"walls[0].name=b"}), "--set walls[0].name=b: there is no item [0] (0 items)");
  EXPECT_NE(problem_of("", {"noise={"}), "no problem");
}

TEST_F(FilesTest, MissingFileDirectoryAndSyntax) {
  EXPECT_EQ(problem_of_file(directory_ / "none.yaml"), "none.yaml: no such file");
  EXPECT_EQ(problem_of_file(directory_ / "filters"), "filters: expected a file, got a directory");
  EXPECT_EQ(problem_of_file(file("a.yaml", "a: [1\n")).rfind("a.yaml:", 0), 0u);
}

TEST_F(FilesTest, ReferencesAreRelativeAndOverridden) {
  file("filters/noise.yaml", "base_cm: 2\nangle_deg: 4\n");
  file("filters/all.yaml", "particles: 9\nnoise: {file: noise.yaml}\n");
  const auto p = load<Parameters>(file("a.yaml", "file: filters/all.yaml\nseed: 3\nnoise: {angle_deg: 5}\n"));
  EXPECT_EQ(p.particles, 9);
  EXPECT_EQ(p.seed, 3u);
  EXPECT_EQ(p.noise.base, 0.02);
  EXPECT_EQ(p.noise.angle, radians(5.0));
}

TEST_F(FilesTest, AReferenceReplacesAReferenceAndSetSwapsIt) {
  file("filters/noise.yaml", "base_cm: 2\nangle_deg: 4\n");
  const auto other = file("filters/other.yaml", "angle_deg: 8\n");
  file("filters/all.yaml", "noise: {file: noise.yaml}\n");
  const auto replaced = load<Parameters>(file("a.yaml", "file: filters/all.yaml\nnoise: {file: filters/other.yaml}\n"));
  EXPECT_EQ(replaced.noise.base, 0.003) << "nothing of noise.yaml is left";
  const std::vector<std::string> assignments{"noise.base_cm=7", "noise.file=" + other.string()};
  const auto swapped = load<Parameters>(directory_ / "filters/all.yaml", assignments);
  EXPECT_EQ(swapped.noise.base, 0.07);
  EXPECT_EQ(swapped.noise.angle, radians(8.0));
}

TEST_F(FilesTest, ProblemsNameTheFileTheyAreIn) {
  file("filters/noise.yaml", "\nbase_cm: -1\n");
  EXPECT_EQ(problem_of_file(file("a.yaml", "noise: {file: filters/noise.yaml}\n")),
            "filters/noise.yaml:2: noise.base_cm: expected a number > 0 in cm, got -1");
  EXPECT_EQ(problem_of_file(file("b.yaml", "\nnoise: {file: filters/none.yaml}\n")),
            "b.yaml:2: file: filters/none.yaml: no such file");
  EXPECT_EQ(problem_of_file(file("c.yaml", "noise: {file: c.yaml}\n")),
            "c.yaml:1: file: more than 16 files refer to each other in a chain");
  EXPECT_EQ(problem_of_file(file("d.yaml", "noise: {file: [1]}\n")),
            "d.yaml:1: file: expected the path of a YAML file, got a list");
}

TEST_F(FilesTest, PathsAreRelativeToTheFileThatSaysThem) {
  file("filters/all.yaml", "data: ../run.log\n");
  EXPECT_EQ(load<Parameters>(file("a.yaml", "file: filters/all.yaml\n")).data, directory_ / "run.log");
  const std::vector<std::string> assignments{"data=x.log"};
  EXPECT_EQ(load<Parameters>(directory_ / "a.yaml", assignments).data, std::filesystem::current_path() / "x.log");
}

}  // namespace
}  // namespace noctule::config
