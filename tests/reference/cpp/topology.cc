// Components, borders, soups, normals, lengths and angles of triangle meshes by CGAL.
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/compute_normal.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/manifoldness.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <iterator>
#include <vector>

#include "msplines-reference/src/bindings.rs.h"
#include "reference.h"

namespace reference {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Vertex = Mesh::Vertex_index;

// Returns whether CGAL takes all faces.
bool build(Positions positions, Faces faces, Mesh& mesh) {
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
    mesh.add_vertex({positions[i], positions[i + 1], positions[i + 2]});
  }
  bool takes_all = true;
  for (std::size_t i = 0; i + 2 < faces.size(); i += 3) {
    const auto face = mesh.add_face(Vertex(faces[i]), Vertex(faces[i + 1]), Vertex(faces[i + 2]));
    takes_all = takes_all && face != Mesh::null_face();
  }
  return takes_all;
}

}  // namespace

Pieces cgal_pieces(Positions positions, Faces faces) {
  Mesh mesh;
  build(positions, faces, mesh);
  auto labels = mesh.add_property_map<Mesh::Face_index, std::size_t>("f:component").first;
  Pieces pieces;
  PMP::connected_components(mesh, labels);
  for (const auto face : mesh.faces()) {
    pieces.components.push_back(static_cast<std::uint32_t>(labels[face]));
  }
  std::vector<Mesh::Halfedge_index> cycles;
  PMP::extract_boundary_cycles(mesh, std::back_inserter(cycles));
  for (const auto cycle : cycles) {
    pieces.border_lengths.push_back(PMP::face_border_length(cycle, mesh));
  }
  return pieces;
}

// The faces may be anything with three corners.
Soup cgal_soup(std::size_t vertices, Faces faces) {
  std::vector<std::array<std::size_t, 3>> polygons;
  for (std::size_t i = 0; i + 2 < faces.size(); i += 3) {
    polygons.push_back({faces[i], faces[i + 1], faces[i + 2]});
  }
  Soup soup;
  soup.is_manifold = PMP::is_polygon_soup_a_polygon_mesh(polygons);
  Mesh mesh;
  const std::vector<double> nowhere(3 * vertices, 0.0);
  soup.takes_all = build({nowhere.data(), nowhere.size()}, faces, mesh);
  if (soup.takes_all) {
    for (const auto vertex : mesh.vertices()) {
      if (!mesh.is_isolated(vertex) && PMP::is_non_manifold_vertex(vertex, mesh)) {
        soup.non_manifold_vertices.push_back(vertex.idx());
      }
    }
  }
  return soup;
}

Shape cgal_shape(Positions positions, Faces faces) {
  Mesh mesh;
  build(positions, faces, mesh);
  Shape shape;
  for (const auto face : mesh.faces()) {
    const auto normal = PMP::compute_face_normal(face, mesh);
    for (int axis = 0; axis < 3; ++axis) shape.normals.push_back(normal[axis]);
    const auto first = mesh.halfedge(face);
    for (const auto halfedge : CGAL::halfedges_around_face(first, mesh)) {
      const auto next = mesh.next(halfedge);
      shape.angles_degrees.push_back(CGAL::approximate_angle(
          mesh.point(mesh.source(halfedge)), mesh.point(mesh.target(halfedge)),
          mesh.point(mesh.target(next))));
    }
  }
  for (const auto edge : mesh.edges()) {
    shape.edge_lengths.push_back(PMP::edge_length(mesh.halfedge(edge), mesh));
  }
  return shape;
}

}  // namespace reference
