// Times multilevel B-splines by mba (its header comes by -include), a program of its own:
// `mba FOLDER LEVELS` reads parameters.npy, points.npy and tests.npy, all of doubles in rows of three,
// fits each coordinate from 2 spans on, prints the processor seconds of the fits and of the values at
// the tests, and writes these to result.npy.
#include <array>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Point = std::array<double, 3>;

// Returns the rows of three doubles behind the header of a file of NumPy's first version.
std::vector<Point> read(const std::string& path, std::string* header = nullptr) {
  std::ifstream file(path, std::ios::binary);
  std::array<unsigned char, 10> prelude{};
  file.read(reinterpret_cast<char*>(prelude.data()), prelude.size());
  std::string text(prelude[8] + 256 * prelude[9], ' ');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file) throw std::runtime_error("cannot read " + path);
  if (header != nullptr) {
    *header = std::string(prelude.begin(), prelude.end()) + text;
  }
  std::vector<Point> rows;
  Point row{};
  while (file.read(reinterpret_cast<char*>(row.data()), sizeof(row))) rows.push_back(row);
  return rows;
}

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) return 2;
  const std::string folder = arguments[1];
  const auto levels = static_cast<unsigned>(std::stoul(arguments[2]));
  const auto parameters = read(folder + "/parameters.npy");
  const auto points = read(folder + "/points.npy");
  std::string header;
  const auto tests = read(folder + "/tests.npy", &header);
  std::vector<Point> found(tests.size());
  double fits = 0.0;
  double values = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> data;
    for (const auto& point : points) data.push_back(point[axis]);
    const double start = cpu_seconds();
    // No residual ends it early.
    const mba::MBA<3> spline(Point{0, 0, 0}, Point{1, 1, 1}, {3, 3, 3}, parameters, data, levels,
                             0.0);
    const double middle = cpu_seconds();
    for (std::size_t i = 0; i < tests.size(); ++i) found[i][axis] = spline(tests[i]);
    fits += middle - start;
    values += cpu_seconds() - middle;
  }
  std::ofstream file(folder + "/result.npy", std::ios::binary);
  file.write(header.data(), static_cast<std::streamsize>(header.size()));
  file.write(reinterpret_cast<const char*>(found.data()),
             static_cast<std::streamsize>(found.size() * sizeof(Point)));
  std::printf("{\"seconds\": [%.9f, %.9f]}\n", fits, values);
  return file ? 0 : 1;
}
