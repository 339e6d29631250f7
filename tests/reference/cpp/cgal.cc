// Areas, volume, cotangents and mixed Voronoi areas by CGAL.
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Weights/cotangent_weights.h>
#include <CGAL/Weights/mixed_voronoi_region_weights.h>
#include <CGAL/Weights/utils.h>
#include <CGAL/version.h>

#include "msplines-reference/src/bindings.rs.h"
#include "reference.h"

namespace reference {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;

Point point(Positions positions, std::uint32_t vertex) {
  const std::size_t at = 3 * static_cast<std::size_t>(vertex);
  return {positions[at], positions[at + 1], positions[at + 2]};
}

}  // namespace

Measures cgal_measures(Positions positions, Faces faces) {
  namespace PMP = CGAL::Polygon_mesh_processing;
  CGAL::Surface_mesh<Point> mesh;
  using Vertex = CGAL::Surface_mesh<Point>::Vertex_index;
  const std::size_t vertices = positions.size() / 3;
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    mesh.add_vertex(point(positions, static_cast<std::uint32_t>(vertex)));
  }
  Measures measures;
  for (std::size_t i = 0; i + 2 < faces.size(); i += 3) {
    const std::uint32_t corners[3] = {faces[i], faces[i + 1], faces[i + 2]};
    const auto face = mesh.add_face(Vertex(corners[0]), Vertex(corners[1]), Vertex(corners[2]));
    measures.face_areas.push_back(PMP::face_area(face, mesh));
    for (int corner = 0; corner < 3; ++corner) {
      const Point before = point(positions, corners[(corner + 2) % 3]);
      const Point here = point(positions, corners[corner]);
      const Point after = point(positions, corners[(corner + 1) % 3]);
      // The part of the triangle that belongs to the middle argument.
      measures.corner_areas.push_back(CGAL::Weights::mixed_voronoi_area(before, here, after));
    }
  }
  measures.area = PMP::area(mesh);
  measures.volume = CGAL::is_closed(mesh) ? PMP::volume(mesh) : 0.0;
  return measures;
}

rust::Vec<double> cgal_face_cotangents(Positions positions, Faces faces) {
  rust::Vec<double> cotangents;
  for (std::size_t i = 0; i + 2 < faces.size(); i += 3) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Point before = point(positions, faces[i + (corner + 2) % 3]);
      const Point here = point(positions, faces[i + corner]);
      const Point after = point(positions, faces[i + (corner + 1) % 3]);
      cotangents.push_back(CGAL::Weights::cotangent(before, here, after));
    }
  }
  return cotangents;
}

// Four vertices per edge: one opposite vertex, one end, the other opposite vertex, the other end.
rust::Vec<double> cgal_cotangent_weights(Positions positions, Faces flaps) {
  rust::Vec<double> weights;
  for (std::size_t i = 0; i + 3 < flaps.size(); i += 4) {
    weights.push_back(CGAL::Weights::cotangent_weight(
        point(positions, flaps[i]), point(positions, flaps[i + 1]),
        point(positions, flaps[i + 2]), point(positions, flaps[i + 3])));
  }
  return weights;
}

rust::String cgal_version() { return CGAL_VERSION_STR; }

}  // namespace reference
