// Simplicial LDLᵀ factorisation by Eigen, in the order of AMD as Eigen has it by default.
#include <Eigen/Sparse>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "msplines-reference/src/bindings.rs.h"
#include "reference.h"

namespace reference {

struct Ldlt::State {
  Eigen::SparseMatrix<double> matrix;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver;
};

Ldlt::Ldlt(rust::Slice<const std::size_t> starts, rust::Slice<const std::uint32_t> rows,
           rust::Slice<const double> values)
    : state_(std::make_unique<State>()) {
  const auto size = static_cast<Eigen::Index>(starts.size()) - 1;
  const std::vector<int> outer(starts.begin(), starts.end());
  const std::vector<int> inner(rows.begin(), rows.end());
  state_->matrix = Eigen::Map<const Eigen::SparseMatrix<double>>(
      size, size, static_cast<Eigen::Index>(values.size()), outer.data(), inner.data(),
      values.data());
}

Ldlt::~Ldlt() = default;

void Ldlt::analyze() { state_->solver.analyzePattern(state_->matrix); }

void Ldlt::factor() {
  state_->solver.factorize(state_->matrix);
  if (state_->solver.info() != Eigen::Success) throw std::runtime_error("a pivot is zero");
}

void Ldlt::solve(rust::Slice<const double> right_hand_sides, rust::Slice<double> solutions) const {
  const Eigen::Index rows = state_->matrix.rows();
  const auto sides = static_cast<Eigen::Index>(right_hand_sides.size()) / rows;
  const Eigen::Map<const Eigen::MatrixXd> b(right_hand_sides.data(), rows, sides);
  Eigen::Map<Eigen::MatrixXd>(solutions.data(), rows, sides) = state_->solver.solve(b);
}

std::unique_ptr<Ldlt> eigen_lower(rust::Slice<const std::size_t> starts,
                                  rust::Slice<const std::uint32_t> rows,
                                  rust::Slice<const double> values) {
  return std::make_unique<Ldlt>(starts, rows, values);
}

rust::String eigen_version() {
  return std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
         std::to_string(EIGEN_MINOR_VERSION);
}

}  // namespace reference
