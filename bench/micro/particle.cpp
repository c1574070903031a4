/// Cost of resampling, ns per particle, for N in 1e2 .. 1e6: our methods, a plain systematic loop, MRPT.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "core/rng.hpp"
#include "particle/resampling.hpp"
#ifdef NOCTULE_WITH_MRPT
#include <mrpt/bayes/CParticleFilterCapable.h>
#include <mrpt/random/RandomGenerators.h>
#endif

namespace {

using noctule::Rng;
using noctule::particle::Resampling;

/// Weights as after a scan: exp of chi-square-like log likelihoods, about half of the particles count.
std::vector<double> log_weights(std::size_t n) {
  Rng rng(1);
  std::vector<double> w(n);
  for (double& v : w) v = -0.5 * std::pow(rng.normal(), 2) * 4.0;
  return w;
}
std::vector<double> weights(std::size_t n) {
  auto w = log_weights(n);
  for (double& v : w) v = std::exp(v);
  return w;
}

/// Other weights of the same kind at every call: a branch predictor learns a thousand particles by heart, which no
/// filter lets it do.
class Windows {
 public:
  explicit Windows(std::size_t n) : n_(n), all_(weights(n + kMore)), before_(all_.size() + 1) {
    std::partial_sum(all_.begin(), all_.end(), before_.begin() + 1);
  }
  std::span<const double> next() { return std::span(all_).subspan(at_ = (at_ + 7919) % kMore, n_); }
  /// Sum of the weights that next() gave.
  [[nodiscard]] double total() const { return before_[at_ + n_] - before_[at_]; }

 private:
  static constexpr std::size_t kMore = 1 << 16;
  std::size_t n_, at_ = 0;
  std::vector<double> all_, before_;
};

void report_per_particle(benchmark::State& state) {
  state.counters["per_particle"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(state.range(0)),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// The textbook loop: weights of known sum in, indices out, nothing checked.
void plain_systematic(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  Windows windows(n);
  std::vector<std::uint32_t> index(n);
  std::uint64_t step = 0;
  for (auto _ : state) {
    const auto w = windows.next();
    Rng rng(1, 2, step++);
    const double spacing = windows.total() / static_cast<double>(n);
    double u = rng.uniform() * spacing, cumulative = w[0];
    std::size_t j = 0;
    for (std::size_t m = 0; m < n; ++m, u += spacing) {
      while (u > cumulative && j + 1 < n) cumulative += w[++j];
      index[m] = static_cast<std::uint32_t>(j);
    }
    benchmark::DoNotOptimize(index.data());
    benchmark::ClobberMemory();
  }
  report_per_particle(state);
}

/// Offspring and their slots, as a filter uses them.
void resample(benchmark::State& state, Resampling method) {
  const auto n = static_cast<std::size_t>(state.range(0));
  Windows windows(n);
  const auto resampler = noctule::particle::make_resampler(method);
  std::vector<std::uint32_t> counts(n), index(n);
  std::vector<double> copy_weights(n);
  std::uint64_t step = 0;
  for (auto _ : state) {
    const auto w = windows.next();
    Rng rng(1, 2, step++);
    if (resampler->equal_weights()) {
      resampler->offspring(w, static_cast<std::uint32_t>(n), rng, counts);
    } else {
      resampler->offspring(w, static_cast<std::uint32_t>(n), rng, counts, copy_weights);
    }
    noctule::particle::place_in_slots(counts, index);
    benchmark::DoNotOptimize(index.data());
    benchmark::ClobberMemory();
  }
  report_per_particle(state);
}

#ifdef NOCTULE_WITH_MRPT
/// MRPT takes log weights, so that its figure includes n exponentials.
void mrpt(benchmark::State& state, mrpt::bayes::CParticleFilter::TParticleResamplingAlgorithm method) {
  const auto w = log_weights(static_cast<std::size_t>(state.range(0)));
  mrpt::random::getRandomGenerator().randomize(1);
  std::vector<std::size_t> index;
  for (auto _ : state) {
    mrpt::bayes::CParticleFilterCapable::computeResampling(method, w, index);
    benchmark::DoNotOptimize(index.data());
    benchmark::ClobberMemory();
  }
  report_per_particle(state);
}
BENCHMARK_CAPTURE(mrpt, systematic, mrpt::bayes::CParticleFilter::prSystematic)
    ->RangeMultiplier(10)
    ->Range(100, 1000000);
BENCHMARK_CAPTURE(mrpt, multinomial, mrpt::bayes::CParticleFilter::prMultinomial)
    ->RangeMultiplier(10)
    ->Range(100, 1000000);
#endif

BENCHMARK(plain_systematic)->RangeMultiplier(10)->Range(100, 1000000);

/// Every method by its name in configuration files.
const int kMethods = [] {
  for (const auto& [name, method] : noctule::particle::resampling_choices()) {
    benchmark::RegisterBenchmark((std::string("resample/") + name).c_str(), resample, method)
        ->RangeMultiplier(10)
        ->Range(100, 1000000);
  }
  return 0;
}();

}  // namespace
