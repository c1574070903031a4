#include "smoothing/selected_inverse.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <stdexcept>

#include "core/rng.hpp"

namespace noctule::smoothing {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// J'J of equations that couple neighbours and some random pairs.
Sparse random_information(int n, std::uint64_t seed) {
  Rng rng(seed);
  Sparse j(4 * n, n);
  for (int row = 0; row < 4 * n; ++row) {
    const int a = row % n;
    const int b = row < 2 * n ? (a + 1) % n : static_cast<int>(rng.index(static_cast<std::uint64_t>(n)));
    j.coeffRef(row, a) += rng.normal();
    if (rng.uniform() < 0.7) j.coeffRef(row, b) += rng.normal();
  }
  return j.transpose() * j;
}

TEST(SelectedInverse, EqualsTheDenseInverseWhereTheMatrixHasEntries) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Sparse information = random_information(1 + static_cast<int>(seed) * 3, seed);
    const Eigen::MatrixXd dense = Eigen::MatrixXd(information).inverse();
    const SelectedInverse inverse(information);
    for (int c = 0; c < information.cols(); ++c) {
      for (Sparse::InnerIterator it(information, c); it; ++it) {
        const auto r = static_cast<int>(it.row());
        EXPECT_NEAR(inverse(r, c), dense(r, c), 1e-9 * dense.cwiseAbs().maxCoeff()) << "seed " << seed;
      }
    }
  }
}

TEST(SelectedInverse, OfADiagonalMatrix) {
  Sparse information(3, 3);
  for (int i = 0; i < 3; ++i) information.insert(i, i) = i + 1.0;
  const SelectedInverse inverse(information);
  for (int i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(inverse(i, i), 1.0 / (i + 1.0));
  EXPECT_EQ(inverse(0, 2), 0.0);
  EXPECT_NO_THROW(SelectedInverse(Sparse(0, 0)));
}

TEST(SelectedInverse, RefusesWhatIsNotPositiveDefinite) {
  Sparse information(2, 2);
  information.insert(0, 0) = 1.0;
  EXPECT_THROW(SelectedInverse{information}, std::domain_error);
  information.insert(1, 1) = -1.0;
  EXPECT_THROW(SelectedInverse{information}, std::domain_error);
}

}  // namespace
}  // namespace noctule::smoothing
