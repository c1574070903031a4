#include "experiment/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <ostream>
#include <stdexcept>

#include "core/limits.hpp"
#include "core/rng.hpp"
#include "experiment/csv.hpp"
#include "report/text.hpp"

namespace noctule::experiment {
namespace {

constexpr std::size_t kExactFlips = 12;
constexpr int kRandomFlips = 9999;
constexpr std::uint64_t kBootstrapSeed = 1;
constexpr const char* kHeader =
    "scenario,metric,unit,filter,parameters,against,against_parameters,pairs,dropped,diverged,against_diverged,mean,"
    "against_mean,difference,ci95_low,ci95_high,bootstrap95_low,bootstrap95_high,percent,p,p_permutation,p_holm";

struct Pairs {
  std::vector<double> a, b;
  int dropped = 0;
};

Pairs pair_up(std::span<const Row> a, std::span<const Row> b) {
  std::map<std::uint64_t, double> of_a;
  for (const Row& row : a) of_a[row.seed] = row.value;
  Pairs pairs;
  std::size_t shared = 0;
  for (const Row& row : b) {
    const auto partner = of_a.find(row.seed);
    if (partner == of_a.end()) {
      ++pairs.dropped;
      continue;
    }
    ++shared;
    if (std::isfinite(partner->second) && std::isfinite(row.value)) {
      pairs.a.push_back(partner->second);
      pairs.b.push_back(row.value);
    } else {
      ++pairs.dropped;
    }
  }
  pairs.dropped += static_cast<int>(of_a.size() - shared);
  return pairs;
}

int count_diverged(std::span<const Row> rows) {
  return static_cast<int>(std::ranges::count_if(rows, &Row::diverged));
}

/// Twice the smaller tail, from a sum beyond which `observed` lies in either direction.
class TailCount {
 public:
  explicit TailCount(std::span<const double> differences) {
    double magnitude = 0.0;
    for (const double d : differences) {
      observed_ += d;
      magnitude += std::abs(d);
    }
    observed_ = std::abs(observed_) - 1e-12 * magnitude;  // equal sums in another order are equal
  }
  void add(double sum) {
    ++all_;
    if (std::abs(sum) >= observed_) ++beyond_;
  }
  [[nodiscard]] int all() const { return all_; }
  [[nodiscard]] int beyond() const { return beyond_; }

 private:
  double observed_ = 0.0;
  int all_ = 0, beyond_ = 0;
};

}  // namespace

Comparison compare(std::span<const Row> a, std::span<const Row> b) {
  if (a.empty() || b.empty()) throw std::invalid_argument("compare: no rows");
  const Pairs pairs = pair_up(a, b);
  Comparison c;
  c.subject = {a.front().scenario, a.front().filter, a.front().parameters};
  c.against = {b.front().scenario, b.front().filter, b.front().parameters};
  c.metric = a.front().metric;
  c.unit = a.front().unit;
  c.pairs = static_cast<int>(pairs.a.size());
  c.dropped = pairs.dropped;
  c.diverged = count_diverged(a);
  c.against_diverged = count_diverged(b);
  if (c.pairs == 0) {
    c.mean = c.against_mean = c.difference = c.percent = c.p_value = c.p_permutation = c.p_holm = kNan;
    c.ci95 = c.bootstrap95 = {kNan, kNan};
    return c;
  }
  const eval::PairedDifference difference = eval::paired_difference(pairs.a, pairs.b);
  std::vector<double> d(pairs.a.size());
  std::ranges::transform(pairs.a, pairs.b, d.begin(), std::minus<>());
  c.mean = eval::mean(pairs.a);
  c.against_mean = eval::mean(pairs.b);
  c.difference = difference.mean;
  c.ci95 = difference.interval;
  c.bootstrap95 = c.pairs > 1 ? eval::bootstrap_interval(d, kBootstrapSeed) : Interval{kNan, kNan};
  c.percent = c.against_mean != 0.0 ? 100.0 * c.difference / std::abs(c.against_mean) : kNan;
  c.p_value = difference.p_value;
  c.p_permutation = sign_flip_p_value(d);
  c.p_holm = c.p_value;
  return c;
}

void correct(std::span<Comparison> comparisons) {
  std::vector<double> p;
  for (const Comparison& c : comparisons) p.push_back(c.p_value);
  const std::vector<double> corrected = holm(p);
  for (std::size_t i = 0; i < corrected.size(); ++i) comparisons[i].p_holm = corrected[i];
}

std::string p_value_text(double p, const std::string& none) {
  if (std::isnan(p)) return none;
  return p < 0.001 ? "< 0.001" : report::fixed(p, 3);
}

std::vector<double> holm(std::span<const double> p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return std::isnan(p_values[i]); });
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p_values[i]; });
  std::vector<double> corrected(p_values.size(), kNan);
  double largest = 0.0;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    largest = std::max(largest, static_cast<double>(order.size() - rank) * p_values[order[rank]]);
    corrected[order[rank]] = std::min(1.0, largest);
  }
  return corrected;
}

double sign_flip_p_value(std::span<const double> differences, std::uint64_t seed) {
  if (differences.empty()) return kNan;
  if (!std::ranges::all_of(differences, [](double d) { return std::isfinite(d); })) {
    throw std::invalid_argument("sign_flip_p_value: a difference that is not finite");
  }
  TailCount count(differences);
  if (differences.size() <= kExactFlips) {
    for (std::uint64_t signs = 0; signs < (std::uint64_t{1} << differences.size()); ++signs) {
      double sum = 0.0;
      for (std::size_t i = 0; i < differences.size(); ++i)
        sum += (signs >> i & 1) != 0 ? -differences[i] : differences[i];
      count.add(sum);
    }
    return static_cast<double>(count.beyond()) / count.all();
  }
  constexpr std::size_t kBits = 64;
  for (int flip = 0; flip < kRandomFlips; ++flip) {
    Rng rng(seed, stream_id("sign_flip"), static_cast<std::uint64_t>(flip));
    double sum = 0.0;
    for (std::size_t begin = 0; begin < differences.size(); begin += kBits) {
      const std::uint64_t signs = rng();
      const std::size_t n = std::min(kBits, differences.size() - begin);
      for (std::size_t i = 0; i < n; ++i) {
        sum += (signs >> i & 1) != 0 ? -differences[begin + i] : differences[begin + i];
      }
    }
    count.add(sum);
  }
  return (1.0 + count.beyond()) / (1.0 + count.all());
}

void write_comparisons(std::ostream& out, std::span<const Comparison> comparisons) {
  out << kHeader << '\n';
  for (const Comparison& c : comparisons) {
    out << c.subject.scenario << ',' << c.metric << ',' << c.unit << ',' << c.subject.filter << ','
        << c.subject.parameters << ',' << c.against.filter << ',' << c.against.parameters << ',' << c.pairs << ','
        << c.dropped << ',' << c.diverged << ',' << c.against_diverged;
    for (const double value : {c.mean, c.against_mean, c.difference, c.ci95.low, c.ci95.high, c.bootstrap95.low,
                               c.bootstrap95.high, c.percent, c.p_value, c.p_permutation, c.p_holm}) {
      out << ',' << csv_number(value);
    }
    out << '\n';
  }
}

std::vector<Comparison> read_comparisons(const std::filesystem::path& file) {
  const CsvTable table(file, kHeader);
  std::vector<Comparison> comparisons;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto count = [&](std::size_t column) { return static_cast<int>(table.count(i, column)); };
    comparisons.push_back({{table.text(i, 0), table.text(i, 3), table.text(i, 4)},
                           {table.text(i, 0), table.text(i, 5), table.text(i, 6)},
                           table.text(i, 1),
                           table.text(i, 2),
                           count(7),
                           count(8),
                           count(9),
                           count(10),
                           table.number(i, 11),
                           table.number(i, 12),
                           table.number(i, 13),
                           {table.number(i, 14), table.number(i, 15)},
                           {table.number(i, 16), table.number(i, 17)},
                           table.number(i, 18),
                           table.number(i, 19),
                           table.number(i, 20),
                           table.number(i, 21)});
  }
  return comparisons;
}

}  // namespace noctule::experiment
