// Delaunay triangulations by CGAL: in the plane, and of a surface by flips of its edges.
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Heat_method_3/internal/Intrinsic_Delaunay_triangulation_3.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Triangulation_face_base_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cmath>
#include <utility>
#include <vector>

#include "msplines-reference/src/bindings.rs.h"
#include "reference.h"

namespace reference {
namespace {

using Plane = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Plane>;
using Structure = CGAL::Triangulation_data_structure_2<Vertices>;
using Delaunay = CGAL::Delaunay_triangulation_2<Plane, Structure>;

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Intrinsic = CGAL::Heat_method_3::Intrinsic_Delaunay_triangulation_3<Mesh>;

}  // namespace

// Two coordinates for each point; three corners for each triangle, counter-clockwise.
rust::Vec<std::uint32_t> cgal_plane_delaunay(Positions points) {
  std::vector<std::pair<Plane::Point_2, std::uint32_t>> numbered;
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
    numbered.emplace_back(Plane::Point_2(points[i], points[i + 1]),
                          static_cast<std::uint32_t>(i / 2));
  }
  const Delaunay delaunay(numbered.begin(), numbered.end());
  rust::Vec<std::uint32_t> faces;
  for (auto face = delaunay.finite_faces_begin(); face != delaunay.finite_faces_end(); ++face) {
    for (int corner = 0; corner < 3; ++corner) faces.push_back(face->vertex(corner)->info());
  }
  return faces;
}

IntrinsicEdges cgal_intrinsic(Positions positions, Faces faces) {
  using Vertex = Mesh::Vertex_index;
  Mesh mesh;
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
    mesh.add_vertex({positions[i], positions[i + 1], positions[i + 2]});
  }
  for (std::size_t i = 0; i + 2 < faces.size(); i += 3) {
    mesh.add_face(Vertex(faces[i]), Vertex(faces[i + 1]), Vertex(faces[i + 2]));
  }
  Intrinsic intrinsic(mesh);
  const Mesh& flipped = intrinsic.triangle_mesh();
  const auto& places = intrinsic.hcmap();
  IntrinsicEdges edges;
  for (const auto edge : flipped.edges()) {
    // Places are those of a half-edge's end, in the plane of its face.
    auto halfedge = flipped.halfedge(edge);
    if (flipped.is_border(halfedge)) halfedge = flipped.opposite(halfedge);
    const auto from = get(places, flipped.prev(halfedge));
    const auto to = get(places, halfedge);
    edges.ends.push_back(flipped.source(halfedge).idx());
    edges.ends.push_back(flipped.target(halfedge).idx());
    edges.lengths.push_back(std::hypot(to.first - from.first, to.second - from.second));
  }
  return edges;
}

}  // namespace reference
