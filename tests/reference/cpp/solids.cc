// Orientation, volume and angles of tetrahedra, Delaunay tetrahedra and self-intersections by CGAL.
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <CGAL/convex_hull_3.h>

#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

#include "msplines-reference/src/bindings.rs.h"
#include "reference.h"

namespace reference {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;

using Predicates = CGAL::Exact_predicates_inexact_constructions_kernel;
using Rational = CGAL::Simple_cartesian<CGAL::Exact_rational>;
using Base = CGAL::Triangulation_vertex_base_with_info_3<std::uint32_t, Predicates>;
using Cells = CGAL::Triangulation_data_structure_3<Base>;
using Delaunay = CGAL::Delaunay_triangulation_3<Predicates, Cells>;
using Mesh = CGAL::Surface_mesh<Predicates::Point_3>;

template <typename Kernel>
typename Kernel::Point_3 point(Positions positions, std::size_t vertex) {
  return {positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]};
}

}  // namespace

// Four points per tetrahedron.
rust::Vec<std::int8_t> cgal_orientations(Positions corners) {
  rust::Vec<std::int8_t> signs;
  for (std::size_t i = 0; i + 11 < corners.size(); i += 12) {
    const std::size_t first = i / 3;
    const auto corner = [&](std::size_t k) { return point<Predicates>(corners, first + k); };
    signs.push_back(static_cast<std::int8_t>(
        CGAL::orientation(corner(0), corner(1), corner(2), corner(3))));
  }
  return signs;
}

// Rounded from rational numbers, but for square root and arc tangent.
rust::Vec<Tetrahedron> cgal_tetrahedra(Positions corners) {
  constexpr std::size_t edges[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                       {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
  rust::Vec<Tetrahedron> tetrahedra;
  for (std::size_t i = 0; i + 11 < corners.size(); i += 12) {
    const std::size_t first = i / 3;
    const Rational::Point_3 at[4] = {
        point<Rational>(corners, first), point<Rational>(corners, first + 1),
        point<Rational>(corners, first + 2), point<Rational>(corners, first + 3)};
    Tetrahedron found;
    found.volume = CGAL::to_double(CGAL::volume(at[0], at[1], at[2], at[3]));
    for (std::size_t edge = 0; edge < 6; ++edge) {
      const auto& [a, b, c, d] = edges[edge];
      const auto degrees = CGAL::approximate_dihedral_angle(at[a], at[b], at[c], at[d]);
      found.dihedral_degrees[edge] = CGAL::to_double(degrees);
    }
    tetrahedra.push_back(found);
  }
  return tetrahedra;
}

DelaunayMesh cgal_delaunay(Positions positions) {
  std::vector<std::pair<Predicates::Point_3, std::uint32_t>> points;
  std::vector<Predicates::Point_3> bare;
  for (std::size_t vertex = 0; vertex < positions.size() / 3; ++vertex) {
    bare.push_back(point<Predicates>(positions, vertex));
    points.emplace_back(bare.back(), static_cast<std::uint32_t>(vertex));
  }
  const Delaunay delaunay(points.begin(), points.end());
  DelaunayMesh mesh;
  for (auto cell = delaunay.finite_cells_begin(); cell != delaunay.finite_cells_end(); ++cell) {
    for (int corner = 0; corner < 4; ++corner) {
      mesh.cells.push_back(cell->vertex(corner)->info());
    }
  }
  Mesh hull;
  CGAL::convex_hull_3(bare.begin(), bare.end(), hull);
  mesh.hull_volume = PMP::volume(hull);
  mesh.hull_vertices = hull.number_of_vertices();
  return mesh;
}

rust::Vec<std::uint32_t> cgal_self_intersections(Positions positions, Faces faces) {
  Mesh mesh;
  for (std::size_t vertex = 0; vertex < positions.size() / 3; ++vertex) {
    mesh.add_vertex(point<Predicates>(positions, vertex));
  }
  using Vertex = Mesh::Vertex_index;
  for (std::size_t i = 0; i + 2 < faces.size(); i += 3) {
    // A face that is not taken would shift the numbers of those after it.
    if (mesh.add_face(Vertex(faces[i]), Vertex(faces[i + 1]), Vertex(faces[i + 2])) ==
        Mesh::null_face()) {
      throw std::runtime_error("CGAL does not take face " + std::to_string(i / 3));
    }
  }
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  PMP::self_intersections<CGAL::Sequential_tag>(mesh, std::back_inserter(pairs));
  rust::Vec<std::uint32_t> flat;
  for (const auto& [first, second] : pairs) {
    flat.push_back(first);
    flat.push_back(second);
  }
  return flat;
}

}  // namespace reference
