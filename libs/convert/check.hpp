#pragma once
/// What the conversions share: checks on the fields of a message (no text is made unless one fails), and fills.
#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/pose2.hpp"
#include "core/stamp.hpp"

namespace noctule::convert {

class Check {
 public:
  explicit Check(const char* type) : name_(type) {}
  /// For an element of a list of `parent`, which must outlive it.
  Check(const Check& parent, const char* list, std::size_t index) : parent_(&parent), name_(list), index_(index) {}

  double finite(const char* field, double value) const {
    return within(field, value, -std::numeric_limits<double>::max(), std::numeric_limits<double>::max());
  }
  double not_negative(const char* field, double value) const {
    return within(field, value, 0.0, std::numeric_limits<double>::max());
  }
  /// A number in [min, max].
  double within(const char* field, double value, double min, double max) const {
    if (!(value >= min && value <= max)) refuse_number(field, value, min, max);
    return value;
  }
  template <class Integer>
  Integer not_negative_integer(const char* field, Integer value) const {
    if (value < 0) refuse(field, "an integer >= 0", std::to_string(value));
    return value;
  }

  std::int32_t integer_within(const char* field, std::int32_t value, std::int32_t min, std::int32_t max) const {
    if (value < min || value > max)
      refuse(field, "an integer from " + std::to_string(min) + " to " + std::to_string(max), std::to_string(value));
    return value;
  }
  /// A count that other fields determine.
  void count(const char* field, std::int64_t value, std::int64_t expected) const {
    if (value != expected) refuse(field, std::to_string(expected), std::to_string(value));
  }

  /// A code 0 ... last.
  template <class Enum>
  Enum code(const char* field, std::int8_t value, Enum last) const {
    if (value < 0 || value > static_cast<std::int8_t>(last))
      refuse(field, "a code from 0 to " + std::to_string(static_cast<int>(last)), std::to_string(value));
    return static_cast<Enum>(value);
  }
  bool flag(const char* field, std::int8_t value) const {
    if (value != 0 && value != 1) refuse(field, "0 or 1", std::to_string(value));
    return value == 1;
  }

  Pose2 pose(const char* x_field, double x, const char* y_field, double y, const char* yaw_field, double yaw) const {
    return {finite(x_field, x), finite(y_field, y), finite(yaw_field, yaw)};
  }
  Vector2 point(const char* x_field, double x, const char* y_field, double y) const {
    return {finite(x_field, x), finite(y_field, y)};
  }

  /// Finite, symmetric, no negative variance and no correlation beyond 1, all up to rounding; may be singular.
  template <int N>
  Eigen::Matrix<double, N, N> covariance(const char* field, const double (&rows)[N][N]) const {
    check_covariance(field, &rows[0][0], N);
    return Eigen::Map<const Eigen::Matrix<double, N, N, Eigen::RowMajor>>(&rows[0][0]);
  }

  /// A list of the message, which its count field must agree with; `convert` makes a value of an element and its Check.
  template <class Element, class Value>
  std::vector<Value> list(const char* count_field, std::int32_t count, const char* field,
                          const std::vector<Element>& elements, Value (*convert)(const Element&, const Check&)) const {
    if (count < 0 || static_cast<std::size_t>(count) != elements.size())
      refuse(count_field, "the length of " + std::string(field) + ", " + std::to_string(elements.size()),
             std::to_string(count));
    std::vector<Value> values;
    values.reserve(elements.size());
    for (std::size_t i = 0; i < elements.size(); ++i) values.push_back(convert(elements[i], Check(*this, field, i)));
    return values;
  }

  template <class Message>
  Stamp stamp(const Message& m, const char* frame) const {
    if (m.frame != frame) refuse("frame", std::string("'") + frame + "'", "'" + m.frame + "'");
    return {m.utime, not_negative_integer("seq", m.seq)};
  }

 private:
  [[noreturn]] void refuse(const char* field, const std::string& expected, const std::string& got) const;
  [[noreturn]] void refuse_number(const char* field, double value, double min, double max) const;
  void check_covariance(const char* field, const double* elements, int n) const;

  [[nodiscard]] std::string place() const;

  const Check* parent_ = nullptr;
  const char* name_;
  std::size_t index_ = 0;
};

/// Copies a matrix into a message.
template <int N>
void fill(double (&rows)[N][N], const Eigen::Matrix<double, N, N>& matrix) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) rows[i][j] = matrix(i, j);
}

/// Fills a list of a message and its count.
template <class Element, class Value>
void fill(std::int32_t& count, std::vector<Element>& elements, const std::vector<Value>& values,
          Element (*convert)(const Value&)) {
  count = static_cast<std::int32_t>(values.size());
  elements.reserve(values.size());
  for (const Value& value : values) elements.push_back(convert(value));
}

/// A message with its stamp and frame, all other numbers 0.
template <class Message>
Message stamped(const Stamp& stamp, const char* frame) {
  Message m{};
  m.utime = stamp.utime;
  m.seq = stamp.seq;
  m.frame = frame;
  return m;
}

}  // namespace noctule::convert
