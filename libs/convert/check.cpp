#include "convert/check.hpp"

#include <cmath>
#include <cstdio>

#include "core/error.hpp"

namespace noctule::convert {
namespace {

constexpr double kRounding = 1e-12;         // of a variance or covariance [m^2, m rad, rad^2]
constexpr double kRelativeRounding = 1e-6;  // of sqrt(variance * variance)

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.9g", value);
  return buffer;
}

}  // namespace

void Check::refuse(const char* field, const std::string& expected, const std::string& got) const {
  throw InputError(place() + '.' + field + ": expected " + expected + ", got " + got);
}

std::string Check::place() const {
  return parent_ == nullptr ? name_ : parent_->place() + '.' + name_ + '[' + std::to_string(index_) + ']';
}

void Check::refuse_number(const char* field, double value, double min, double max) const {
  std::string expected = "a finite number";
  if (min > -std::numeric_limits<double>::max()) expected += " >= " + text(min);
  if (max < std::numeric_limits<double>::max()) expected += " <= " + text(max);
  refuse(field, expected, text(value));
}

void Check::check_covariance(const char* field, const double* elements, int n) const {
  const auto at = [&](int row, int column) { return elements[row * n + column]; };
  for (int i = 0; i < n; ++i) {
    if (!std::isfinite(at(i, i)) || at(i, i) < -kRounding) refuse(field, "finite variances >= 0", text(at(i, i)));
    for (int j = 0; j < i; ++j) {
      const double bound = std::sqrt(std::abs(at(i, i) * at(j, j)));
      const double tolerance = kRounding + kRelativeRounding * bound;
      if (!(std::abs(at(i, j) - at(j, i)) <= tolerance && std::abs(at(i, j)) <= bound + tolerance))
        refuse(field, "a finite symmetric matrix with correlations of at most 1",
               text(at(i, j)) + " and " + text(at(j, i)) + " between variances " + text(at(i, i)) + " and " +
                   text(at(j, j)));
    }
  }
}

}  // namespace noctule::convert
