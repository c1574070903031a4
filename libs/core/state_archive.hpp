#pragma once
/// The whole state of an algorithm as bytes, for a restart on the same kind of machine. One function of a class, say
/// `transfer(StateArchive&)`, lists its members for both ways, so that what is written and what is read cannot differ.
#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "core/error.hpp"
#include "core/pose2.hpp"
#include "core/stamp.hpp"

namespace noctule {

class StateArchive {
 public:
  /// Writes.
  StateArchive() = default;
  /// Reads. \param bytes are not copied
  explicit StateArchive(std::span<const char> bytes) : reads_(true), rest_(bytes) {}

  [[nodiscard]] bool reads() const { return reads_; }
  [[nodiscard]] const std::string& bytes() const { return written_; }
  /// \throws InputError when not all has been read
  void expect_end() const {
    if (!rest_.empty())
      throw InputError("state: expected its end, got " + std::to_string(rest_.size()) + " more bytes");
  }

  /// One after the other. \throws InputError when the bytes end early or cannot be
  template <class... Values>
  void operator()(Values&... values) {
    (one(values), ...);
  }
  /// A vector whose elements are listed by body(element); `make` is what new ones are copies of.
  template <class T, class Body>
  void each(std::vector<T>& list, const T& make, const Body& body) {
    std::uint64_t size = list.size();
    one(size);
    if (reads_) {
      expect(size);  // each element takes a byte at least
      list.assign(size, make);
    }
    for (T& element : list) body(element);
  }

 private:
  template <class T>
  static constexpr bool is_plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

  template <class T>
  void one(T& value) {
    if constexpr (requires { value.transfer(*this); }) {
      value.transfer(*this);
    } else {
      static_assert(is_plain<T>, "list the members: bytes between them would be written too");
      raw(&value, sizeof(T));
    }
  }
  void one(Pose2& p) { (*this)(p.x, p.y, p.yaw); }
  void one(Stamp& s) { (*this)(s.utime, s.seq); }
  void one(PoseGaussian& g) { (*this)(g.mean, g.covariance); }
  template <int Rows, int Columns>
  void one(Eigen::Matrix<double, Rows, Columns>& m) {
    if constexpr (Rows == Eigen::Dynamic || Columns == Eigen::Dynamic) {
      auto rows = static_cast<std::uint64_t>(m.rows()), columns = static_cast<std::uint64_t>(m.cols());
      (*this)(rows, columns);
      if (reads_) {
        expect(rows);
        expect(columns);
        expect(rows * columns);
        m.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
      }
    }
    raw(m.data(), static_cast<std::size_t>(m.size()) * sizeof(double));
  }
  template <class T>
  void one(std::optional<T>& value) {
    bool has = value.has_value();
    one(has);
    if (reads_ && has) value.emplace();
    if (reads_ && !has) value.reset();
    if (has) one(*value);
  }
  template <class T, std::size_t N>
  void one(std::array<T, N>& list) {
    for (T& element : list) one(element);
  }
  template <class T>
  void one(std::vector<T>& list) {
    if constexpr (is_plain<T>) {
      std::uint64_t size = list.size();
      one(size);
      if (reads_) {
        expect(size);
        list.resize(size);
      }
      raw(list.data(), list.size() * sizeof(T));
    } else {
      each(list, T{}, [this](T& element) { one(element); });
    }
  }

  void raw(void* data, std::size_t size) {
    if (size == 0) return;
    if (!reads_) {
      written_.append(static_cast<const char*>(data), size);
      return;
    }
    expect(size);
    std::memcpy(data, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }
  void expect(std::uint64_t size) const {
    if (size > rest_.size()) {
      throw InputError("state: expected " + std::to_string(size) + " more bytes, got " + std::to_string(rest_.size()));
    }
  }

  bool reads_ = false;
  std::string written_;
  std::span<const char> rest_;
};

}  // namespace noctule
