// Catmull-Clark refinement and limits by OpenSubdiv, its weights in double precision.
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>
#include <opensubdiv/version.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "msplines-reference/src/bindings.rs.h"
#include "reference.h"

namespace reference {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

struct Point {
  double x[3] = {0.0, 0.0, 0.0};

  void Clear() { x[0] = x[1] = x[2] = 0.0; }
  void AddWithWeight(const Point& other, double weight) {
    for (int axis = 0; axis < 3; ++axis) x[axis] += weight * other.x[axis];
  }
};
using Points = std::vector<Point>;

std::unique_ptr<Far::TopologyRefiner> build(const Control& control, bool last_topology) {
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(control.sharp_corners
                                          ? Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER
                                          : Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
  options.SetCreasingMethod(control.chaikin ? Sdc::Options::CREASE_CHAIKIN
                                            : Sdc::Options::CREASE_UNIFORM);
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = static_cast<int>(control.positions.size() / 3);
  descriptor.numFaces = static_cast<int>(control.sizes.size());
  descriptor.numVertsPerFace = control.sizes.data();
  descriptor.vertIndicesPerFace = control.corners.data();
  descriptor.numCreases = static_cast<int>(control.crease_sharpness.size());
  descriptor.creaseVertexIndexPairs = control.crease_ends.data();
  descriptor.creaseWeights = control.crease_sharpness.data();
  descriptor.numCorners = static_cast<int>(control.corner_sharpness.size());
  descriptor.cornerVertexIndices = control.corner_vertices.data();
  descriptor.cornerWeights = control.corner_sharpness.data();
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  std::unique_ptr<Far::TopologyRefiner> refiner(
      Factory::Create(descriptor, Factory::Options(Sdc::SCHEME_CATMARK, options)));
  if (!refiner) throw std::runtime_error("OpenSubdiv refuses the mesh");
  Far::TopologyRefiner::UniformOptions uniform(static_cast<int>(control.levels));
  uniform.fullTopologyInLastLevel = last_topology;
  refiner->RefineUniform(uniform);
  return refiner;
}

rust::Vec<double> flat(const Points& points) {
  rust::Vec<double> all;
  all.reserve(3 * points.size());
  for (const Point& point : points) {
    for (double x : point.x) all.push_back(x);
  }
  return all;
}

// Writes of which vertices of the level before each vertex of a level is the point.
void write_origins(const Far::TopologyLevel& parent, int count, PolygonLevel& level) {
  std::vector<std::vector<int>> origins(count);
  for (int v = 0; v < parent.GetNumVertices(); ++v) origins[parent.GetVertexChildVertex(v)] = {v};
  for (int e = 0; e < parent.GetNumEdges(); ++e) {
    const auto ends = parent.GetEdgeVertices(e);
    origins[parent.GetEdgeChildVertex(e)] = {ends[0], ends[1]};
  }
  for (int f = 0; f < parent.GetNumFaces(); ++f) {
    const auto corners = parent.GetFaceVertices(f);
    origins[parent.GetFaceChildVertex(f)].assign(corners.begin(), corners.end());
  }
  for (const auto& origin : origins) {
    for (int v : origin) level.origins.push_back(v);
    level.origin_ends.push_back(level.origins.size());
  }
}

// Writes the neighbour along the first sharp edge of each vertex, or the vertex itself.
void write_leads(const Far::TopologyLevel& level, PolygonLimits& limits) {
  for (int v = 0; v < level.GetNumVertices(); ++v) {
    int lead = v;
    for (int e : level.GetVertexEdges(v)) {
      if (lead != v || level.GetEdgeSharpness(e) <= 0.0f) continue;
      const auto ends = level.GetEdgeVertices(e);
      lead = ends[0] == v ? ends[1] : ends[0];
    }
    const auto edges = level.GetVertexEdges(v);
    const auto ends = level.GetEdgeVertices(edges[0]);
    limits.first_neighbours.push_back(ends[0] == v ? ends[1] : ends[0]);
    limits.sharp_neighbours.push_back(lead);
  }
}

}  // namespace

PolygonRefinement opensubdiv_refine(const Control& control) {
  const auto refiner = build(control, true);
  const Far::PrimvarRefinerReal<double> primvar(*refiner);
  PolygonRefinement refinement;
  Points points(control.positions.size() / 3);
  for (std::size_t i = 0; i < control.positions.size(); ++i) {
    points[i / 3].x[i % 3] = control.positions[i];
  }
  for (int l = 1; l <= static_cast<int>(control.levels); ++l) {
    const int count = refiner->GetLevel(l).GetNumVertices();
    Points finer(count);
    primvar.Interpolate(l, points, finer);
    points = std::move(finer);
    PolygonLevel level;
    level.positions = flat(points);
    write_origins(refiner->GetLevel(l - 1), count, level);
    refinement.levels.push_back(std::move(level));
  }
  const std::size_t count = points.size();
  Points limits(count), first(count), second(count);
  primvar.Limit(points, limits, first, second);
  refinement.limits.positions = flat(limits);
  refinement.limits.first_tangents = flat(first);
  refinement.limits.second_tangents = flat(second);
  write_leads(refiner->GetLevel(static_cast<int>(control.levels)), refinement.limits);
  return refinement;
}

rust::Vec<double> opensubdiv_positions(const Control& control) {
  const auto refiner = build(control, false);
  const Far::PrimvarRefinerReal<double> primvar(*refiner);
  Points points(control.positions.size() / 3);
  for (std::size_t i = 0; i < control.positions.size(); ++i) {
    points[i / 3].x[i % 3] = control.positions[i];
  }
  for (int l = 1; l <= static_cast<int>(control.levels); ++l) {
    Points finer(refiner->GetLevel(l).GetNumVertices());
    primvar.Interpolate(l, points, finer);
    points = std::move(finer);
  }
  return flat(points);
}

rust::String opensubdiv_version() {
  return std::to_string(OPENSUBDIV_VERSION_NUMBER / 10000) + "." +
         std::to_string(OPENSUBDIV_VERSION_NUMBER / 100 % 100) + "." +
         std::to_string(OPENSUBDIV_VERSION_NUMBER % 100);
}

}  // namespace reference
