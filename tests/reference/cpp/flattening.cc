// Flattenings of disks by CGAL: conformal in the sense of least squares, and by mean values.
#define CGAL_EIGEN3_ENABLED 1
#include <CGAL/Eigen_solver_traits.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/Circular_border_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/Discrete_conformal_map_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/LSCM_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/Mean_value_coordinates_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>

#include <Eigen/SparseLU>

#include <stdexcept>

#include "msplines-reference/src/bindings.rs.h"
#include "reference.h"

namespace reference {
namespace {

namespace SMP = CGAL::Surface_mesh_parameterization;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

Mesh surface(Positions positions, Faces faces) {
  Mesh mesh;
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
    mesh.add_vertex({positions[i], positions[i + 1], positions[i + 2]});
  }
  for (std::size_t i = 0; i + 2 < faces.size(); i += 3) {
    mesh.add_face(Mesh::Vertex_index(faces[i]), Mesh::Vertex_index(faces[i + 1]),
                  Mesh::Vertex_index(faces[i + 2]));
  }
  return mesh;
}

template <class Parameterizer>
rust::Vec<double> flatten(Mesh& mesh, const Parameterizer& parameterizer) {
  const auto border = CGAL::Polygon_mesh_processing::longest_border(mesh).first;
  auto places = mesh.add_property_map<Mesh::Vertex_index, Kernel::Point_2>("v:uv").first;
  const auto error = SMP::parameterize(mesh, parameterizer, border, places);
  if (error != SMP::OK) {
    throw std::runtime_error(SMP::get_error_message(error));
  }
  rust::Vec<double> result;
  for (const auto vertex : mesh.vertices()) {
    result.push_back(places[vertex].x());
    result.push_back(places[vertex].y());
  }
  return result;
}

// The border where it is told to be.
struct GivenBorder {
  using TriangleMesh = Mesh;
  Positions places;

  template <class VertexUVMap, class VertexIndexMap, class VertexParameterizedMap>
  SMP::Error_code parameterize(const Mesh& mesh, Mesh::Halfedge_index border, VertexUVMap uv,
                               VertexIndexMap, VertexParameterizedMap done) const {
    for (const auto halfedge : CGAL::halfedges_around_face(border, mesh)) {
      const auto vertex = target(halfedge, mesh);
      put(uv, vertex, Kernel::Point_2(places[2 * vertex.idx()], places[2 * vertex.idx() + 1]));
      put(done, vertex, true);
    }
    return SMP::OK;
  }
  bool is_border_convex() const { return false; }
};

}  // namespace

// Two coordinates for each vertex, of which those on the border are kept.
rust::Vec<double> cgal_harmonic(Positions positions, Faces faces, Positions places) {
  using Matrix = CGAL::Eigen_sparse_matrix<double>::EigenType;
  using Solver = CGAL::Eigen_solver_traits<Eigen::SparseLU<Matrix>>;
  Mesh mesh = surface(positions, faces);
  return flatten(mesh, SMP::Discrete_conformal_map_parameterizer_3<Mesh, GivenBorder, Solver>(
                           GivenBorder{places}));
}

rust::Vec<double> cgal_lscm(Positions positions, Faces faces) {
  Mesh mesh = surface(positions, faces);
  return flatten(mesh, SMP::LSCM_parameterizer_3<Mesh>());
}

rust::Vec<double> cgal_mean_value(Positions positions, Faces faces) {
  using Border = SMP::Circular_border_arc_length_parameterizer_3<Mesh>;
  Mesh mesh = surface(positions, faces);
  return flatten(mesh, SMP::Mean_value_coordinates_parameterizer_3<Mesh, Border>());
}

}  // namespace reference
