#pragma once
/// Axes of drawings: from values to user units, with round ticks.
#include <limits>
#include <string>
#include <vector>

namespace noctule::report {

/// The values that an axis has to show.
class ValueRange {
 public:
  /// \param positive_only for a logarithmic axis: nothing else is taken in
  explicit ValueRange(bool positive_only = false) : positive_only_(positive_only) {}
  /// What is not finite is ignored.
  void include(double value);
  [[nodiscard]] bool empty() const { return low_ > high_; }
  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }

 private:
  bool positive_only_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
};

class Axis {
 public:
  /// \param low,high values at `from` and `to`, low < high, positive where logarithmic
  Axis(double low, double high, bool logarithmic, double from, double to);
  /// With some room around the values (none below zero where they begin there); a plain one when there are none.
  Axis(const ValueRange& values, bool logarithmic, double from, double to);

  [[nodiscard]] double at(double value) const;
  [[nodiscard]] bool drawable(double value) const;
  struct Tick {
    double value;
    std::string label;
  };
  /// About `count`, with a true minus sign.
  [[nodiscard]] std::vector<Tick> ticks(int count) const;

 private:
  bool logarithmic_;
  double low_, high_;  // logarithms where logarithmic
  double from_, to_;
};

}  // namespace noctule::report
