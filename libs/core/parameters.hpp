#pragma once
/// How a parameter struct lists its fields once. From that list the `config` room loads, saves, checks and documents
/// it.
///
/// ```cpp
/// struct FilterParameters {
///   int particles = 100;
///   double gate = radians(3.0);
///   Resampling resampling = Resampling::systematic;
///   NoiseParameters noise;
///   template <class Visitor>
///   static void describe(Visitor& v) {
///     v.field("particles", &FilterParameters::particles, unit::one, "number of particles", at_least(1));
///     v.field("gate_deg", &FilterParameters::gate, unit::degree, "bearing gate", positive());
///     v.choice("resampling", &FilterParameters::resampling,
///              {{"systematic", Resampling::systematic}, {"ssp", Resampling::ssp}}, "how particles are redrawn");
///     v.group("noise", &FilterParameters::noise, "sensor noise");
///   }
///   std::string validate() const;  // optional: a problem across fields, empty when sound
/// };
/// ```
/// A visitor has `field` for bool, int, int64_t, uint64_t, double, std::string, std::filesystem::path (relative to the
/// file that says it), Vector2, Pose2 (x, y, yaw) and std::vectors of double, std::string or Vector2, `choice` for
/// enums, `group` for a nested struct or a std::optional of one (absent unless the file has it) and `list` for a
/// std::vector of structs; `one_of` for a std::variant of structs, told apart by the key `type`. `unit::one` may be
/// left out. The key `file` is taken: it refers to another file. The key carries the unit (`_m`, `_cm`, `_deg`, `_s`
/// ...); the member is SI.
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace noctule {

/// A unit as written in files, and its size in SI.
struct Unit {
  const char* symbol;
  double to_si;
};

namespace unit {
inline constexpr Unit one{"1", 1.0};
inline constexpr Unit metre{"m", 1.0};
inline constexpr Unit centimetre{"cm", 0.01};
inline constexpr Unit degree{"deg", 3.14159265358979323846 / 180.0};
inline constexpr Unit degree_per_sqrt_metre{"deg/sqrt(m)", 3.14159265358979323846 / 180.0};
inline constexpr Unit second{"s", 1.0};
inline constexpr Unit hertz{"Hz", 1.0};
inline constexpr Unit metre_per_second{"m/s", 1.0};
inline constexpr Unit degree_per_second{"deg/s", 3.14159265358979323846 / 180.0};
/// Pose2 fields: metres for x and y, degrees for yaw.
inline constexpr Unit metre_degree{"m, m, deg", 1.0};
inline constexpr Unit centimetre_degree{"cm, cm, deg", 0.01};
}  // namespace unit

/// Allowed values of a number, in the unit of the file; for vectors it holds for each element.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_allowed = true;
  bool max_allowed = true;
};
[[nodiscard]] constexpr Range any_finite() {
  return {};
}
[[nodiscard]] constexpr Range at_least(double min) {
  return {.min = min};
}
[[nodiscard]] constexpr Range positive() {
  return {.min = 0.0, .min_allowed = false};
}
[[nodiscard]] constexpr Range between(double min, double max) {
  return {.min = min, .max = max};
}

/// Names of an enum's values, in the order they are offered.
template <class Enum>
using Choices = std::vector<std::pair<const char*, Enum>>;

}  // namespace noctule
