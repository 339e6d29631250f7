// Distances between surfaces by CGAL.
#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Surface_mesh.h>

#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "msplines-reference/src/bindings.rs.h"
#include "reference.h"

namespace reference {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Primitive = CGAL::AABB_face_graph_triangle_primitive<Mesh>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Mesh build(Positions positions, Faces faces) {
  Mesh mesh;
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
    mesh.add_vertex(Point(positions[i], positions[i + 1], positions[i + 2]));
  }
  using Vertex = Mesh::Vertex_index;
  for (std::size_t i = 0; i + 2 < faces.size(); i += 3) {
    if (mesh.add_face(Vertex(faces[i]), Vertex(faces[i + 1]), Vertex(faces[i + 2])) ==
        Mesh::null_face()) {
      throw std::runtime_error("CGAL does not take face " + std::to_string(i / 3));
    }
  }
  return mesh;
}

}  // namespace

double cgal_hausdorff(Positions from_positions, Faces from_faces, Positions to_positions,
                      Faces to_faces, double error) {
  const Mesh from = build(from_positions, from_faces);
  const Mesh to = build(to_positions, to_faces);
  return PMP::bounded_error_Hausdorff_distance<CGAL::Sequential_tag>(from, to, error);
}

Sampled cgal_sampled(Positions from_positions, Faces from_faces, Positions to_positions,
                     Faces to_faces, std::size_t count) {
  const Mesh from = build(from_positions, from_faces);
  const Mesh to = build(to_positions, to_faces);
  std::vector<Point> points;
  PMP::sample_triangle_mesh(from, std::back_inserter(points),
                            CGAL::parameters::use_random_uniform_sampling(true)
                                .number_of_points_on_faces(count)
                                .do_sample_vertices(false)
                                .do_sample_edges(false)
                                .random_seed(1));
  Tree tree(CGAL::faces(to).first, CGAL::faces(to).second, to);
  tree.accelerate_distance_queries();
  Sampled sampled;
  for (const Point& point : points) {
    for (int d = 0; d < 3; ++d) {
      sampled.points.push_back(point[d]);
    }
    sampled.distances.push_back(std::sqrt(tree.squared_distance(point)));
  }
  return sampled;
}

}  // namespace reference
