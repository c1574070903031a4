#include "core/check.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

namespace noctule {
namespace {

struct Leg {
  double length = 1.0;
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("length_cm", &Leg::length, unit::centimetre, "length", positive());
  }
};

struct Lamp {
  double power = 40.0;
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("power", &Lamp::power, "power");
  }
};

struct Table {
  int people = 4;
  Vector2 size{1.0, 2.0};
  Pose2 pose;
  std::vector<double> weights{1.0};
  std::vector<Leg> legs{{0.7}, {0.7}};
  std::optional<Leg> spare;
  std::variant<Leg, Lamp> extra;
  std::string name = "table";
  std::filesystem::path drawing;
  bool round = false;
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("people", &Table::people, unit::one, "people", at_least(1));
    v.field("size_m", &Table::size, unit::metre, "size", positive());
    v.field("pose", &Table::pose, unit::metre_degree, "pose");
    v.field("weights", &Table::weights, unit::one, "weights", noctule::between(0.0, 1.0));
    v.list("legs", &Table::legs, "legs");
    v.group("spare", &Table::spare, "spare leg");
    v.one_of("extra", &Table::extra, {"leg", "lamp"}, "what comes with it");
    v.field("name", &Table::name, "name");
    v.field("drawing", &Table::drawing, "drawing");
    v.field("round", &Table::round, "round");
  }
  std::string validate() const { return name.empty() ? "name: expected a name, got none" : ""; }
};

TEST(FirstProblem, IsEmptyForSoundParameters) {
  EXPECT_EQ(first_problem(Table{}), "");
}

TEST(FirstProblem, NamesKeyAndValueInTheUnitOfTheFile) {
  Table t;
  t.legs[1].length = -0.25;
  EXPECT_EQ(first_problem(t), "legs[1].length_cm: expected a finite number > 0, got -25");
  t = {};
  t.people = 0;
  EXPECT_EQ(first_problem(t), "people: expected a finite number >= 1, got 0");
  t = {};
  t.weights = {0.5, 1.5};
  EXPECT_EQ(first_problem(t), "weights: expected a finite number >= 0 and <= 1, got 1.5");
  t = {};
  t.spare = Leg{0.0};
  EXPECT_EQ(first_problem(t), "spare.length_cm: expected a finite number > 0, got 0");
}

TEST(FirstProblem, RefusesWhatIsNotFinite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Table t;
    t.size.y() = bad;
    EXPECT_NE(first_problem(t).find("size_m: expected a finite number"), std::string::npos);
    t = {};
    t.pose.yaw = bad;
    EXPECT_NE(first_problem(t).find("pose: expected a finite number"), std::string::npos);
    t = {};
    t.extra = Lamp{bad};
    EXPECT_NE(first_problem(t).find("extra.power: expected a finite number"), std::string::npos);
  }
}

TEST(FirstProblem, AsksValidateWhenTheFieldsAreSound) {
  Table t;
  t.name.clear();
  EXPECT_EQ(first_problem(t), "name: expected a name, got none");
  EXPECT_THROW(require_sound(t, "table"), InputError);
  EXPECT_NO_THROW(require_sound(Table{}, "table"));
}

}  // namespace
}  // namespace noctule
