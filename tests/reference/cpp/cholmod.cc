// Supernodal Cholesky factorisation by CHOLMOD in the order of METIS or AMD.
#include <suitesparse/cholmod.h>

#include <time.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "msplines-reference/src/bindings.rs.h"
#include "reference.h"

namespace reference {

struct Cholmod::State {
  cholmod_common common{};
  cholmod_sparse* matrix = nullptr;
  cholmod_factor* factor = nullptr;
  // Reused between solves, as a program that solves often would.
  cholmod_dense* solution = nullptr;
  cholmod_dense* work_y = nullptr;
  cholmod_dense* work_e = nullptr;

  void check(const char* step) const {
    if (common.status != CHOLMOD_OK) {
      throw std::runtime_error(std::string(step) + ": CHOLMOD status " +
                               std::to_string(common.status));
    }
  }
};

Cholmod::Cholmod(rust::Slice<const std::size_t> starts, rust::Slice<const std::uint32_t> rows,
                 rust::Slice<const double> values, bool metis)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  cholmod_start(&s.common);
  s.common.nmethods = 1;
  s.common.method[0].ordering = metis ? CHOLMOD_METIS : CHOLMOD_AMD;
  s.common.postorder = 1;
  s.common.supernodal = CHOLMOD_SUPERNODAL;
  s.common.print = 0;
  const std::size_t size = starts.size() - 1;
  const int lower = -1;
  s.matrix = cholmod_allocate_sparse(size, size, rows.size(), 1, 1, lower, CHOLMOD_REAL, &s.common);
  s.check("allocate");
  std::copy(starts.begin(), starts.end(), static_cast<int*>(s.matrix->p));
  std::copy(rows.begin(), rows.end(), static_cast<int*>(s.matrix->i));
  std::copy(values.begin(), values.end(), static_cast<double*>(s.matrix->x));
}

Cholmod::~Cholmod() {
  State& s = *state_;
  cholmod_free_dense(&s.solution, &s.common);
  cholmod_free_dense(&s.work_y, &s.common);
  cholmod_free_dense(&s.work_e, &s.common);
  cholmod_free_factor(&s.factor, &s.common);
  cholmod_free_sparse(&s.matrix, &s.common);
  cholmod_finish(&s.common);
}

void Cholmod::analyze() {
  State& s = *state_;
  cholmod_free_factor(&s.factor, &s.common);
  s.factor = cholmod_analyze(s.matrix, &s.common);
  s.check("analyze");
}

void Cholmod::factor() {
  State& s = *state_;
  if (s.factor == nullptr) analyze();
  cholmod_factorize(s.matrix, s.factor, &s.common);
  s.check("factor");
}

void Cholmod::solve(rust::Slice<const double> right_hand_sides, rust::Slice<double> solutions) {
  State& s = *state_;
  cholmod_dense b{};
  b.nrow = s.matrix->nrow;
  b.ncol = right_hand_sides.size() / b.nrow;
  b.nzmax = right_hand_sides.size();
  b.d = b.nrow;
  b.x = const_cast<double*>(right_hand_sides.data());
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_solve2(CHOLMOD_A, s.factor, &b, nullptr, &s.solution, nullptr, &s.work_y, &s.work_e,
                 &s.common);
  s.check("solve");
  const double* x = static_cast<const double*>(s.solution->x);
  std::copy(x, x + solutions.size(), solutions.begin());
}

std::size_t Cholmod::stored_values() const { return state_->factor->xsize; }

std::unique_ptr<Cholmod> cholmod_lower(rust::Slice<const std::size_t> starts,
                                       rust::Slice<const std::uint32_t> rows,
                                       rust::Slice<const double> values, bool metis) {
  return std::make_unique<Cholmod>(starts, rows, values, metis);
}

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

rust::String cholmod_version() {
  return std::to_string(CHOLMOD_MAIN_VERSION) + "." + std::to_string(CHOLMOD_SUB_VERSION) + "." +
         std::to_string(CHOLMOD_SUBSUB_VERSION);
}

}  // namespace reference
