// Facts, Loop and Catmull-Clark subdivision by OpenMesh.
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/config.h>
#include <OpenMesh/Tools/Subdivider/Uniform/CatmullClarkT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/ModifiedButterFlyT.hh>

#include <string>
#include <vector>

#include "msplines-reference/src/bindings.rs.h"
#include "reference.h"

namespace reference {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using PolyMesh = OpenMesh::PolyMesh_ArrayKernelT<Traits>;

// Returns the mesh and how many faces OpenMesh refused.
std::size_t build(Positions positions, Faces faces, Mesh& mesh) {
  std::vector<Mesh::VertexHandle> vertices;
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
    vertices.push_back(mesh.add_vertex({positions[i], positions[i + 1], positions[i + 2]}));
  }
  std::size_t refused = 0;
  for (std::size_t i = 0; i + 2 < faces.size(); i += 3) {
    const std::vector<Mesh::VertexHandle> corners = {
        vertices[faces[i]], vertices[faces[i + 1]], vertices[faces[i + 2]]};
    if (!mesh.add_face(corners).is_valid()) ++refused;
  }
  return refused;
}

std::size_t count_boundary_loops(const Mesh& mesh) {
  std::vector<bool> seen(mesh.n_halfedges(), false);
  std::size_t loops = 0;
  for (const auto start : mesh.halfedges()) {
    if (!mesh.is_boundary(start) || seen[start.idx()]) continue;
    ++loops;
    auto here = static_cast<Mesh::HalfedgeHandle>(start);
    while (!seen[here.idx()]) {
      seen[here.idx()] = true;
      here = mesh.next_halfedge_handle(here);
    }
  }
  return loops;
}

// Returns the surface after one round.
template <class Subdivider>
Surface subdivided(Positions positions, Faces faces) {
  Mesh mesh;
  build(positions, faces, mesh);
  Subdivider subdivider;
  subdivider.attach(mesh);
  subdivider(1);
  subdivider.detach();
  Surface surface;
  for (const auto vertex : mesh.vertices()) {
    for (int axis = 0; axis < 3; ++axis) surface.positions.push_back(mesh.point(vertex)[axis]);
  }
  for (const auto face : mesh.faces()) {
    for (const auto corner : face.vertices()) surface.faces.push_back(corner.idx());
  }
  return surface;
}

// Writes of which vertices each vertex of the next step will be the point: new vertices come edge
// after edge, then face after face.
void write_origins(const PolyMesh& mesh, PolygonLevel& level) {
  const auto close = [&level] { level.origin_ends.push_back(level.origins.size()); };
  for (const auto vertex : mesh.vertices()) {
    level.origins.push_back(vertex.idx());
    close();
  }
  for (const auto edge : mesh.edges()) {
    level.origins.push_back(edge.v0().idx());
    level.origins.push_back(edge.v1().idx());
    close();
  }
  for (const auto face : mesh.faces()) {
    for (const auto corner : face.vertices()) level.origins.push_back(corner.idx());
    close();
  }
}

}  // namespace

MeshFacts openmesh_facts(Positions positions, Faces faces) {
  Mesh mesh;
  // OpenMesh reports each face it refuses on its log.
  omerr().disable();
  MeshFacts facts{};
  facts.refused_faces = build(positions, faces, mesh);
  facts.vertices = mesh.n_vertices();
  facts.edges = mesh.n_edges();
  facts.faces = mesh.n_faces();
  facts.boundary_loops = count_boundary_loops(mesh);
  for (const auto vertex : mesh.vertices()) {
    if (!mesh.is_manifold(vertex)) ++facts.non_manifold_vertices;
    if (mesh.is_boundary(vertex)) ++facts.boundary_vertices;
  }
  return facts;
}

Surface openmesh_loop(Positions positions, Faces faces) {
  return subdivided<OpenMesh::Subdivider::Uniform::LoopT<Mesh, double>>(positions, faces);
}

Surface openmesh_butterfly(Positions positions, Faces faces) {
  return subdivided<OpenMesh::Subdivider::Uniform::ModifiedButterflyT<Mesh, double>>(positions,
                                                                                     faces);
}

rust::Vec<PolygonLevel> openmesh_catmull_clark(const Control& control) {
  PolyMesh mesh;
  std::vector<PolyMesh::VertexHandle> vertices;
  for (std::size_t i = 0; i + 2 < control.positions.size(); i += 3) {
    const double* p = control.positions.data() + i;
    vertices.push_back(mesh.add_vertex({p[0], p[1], p[2]}));
  }
  std::size_t start = 0;
  for (int size : control.sizes) {
    std::vector<PolyMesh::VertexHandle> corners;
    for (int i = 0; i < size; ++i) corners.push_back(vertices[control.corners[start + i]]);
    mesh.add_face(corners);
    start += size;
  }
  rust::Vec<PolygonLevel> levels;
  for (std::uint32_t l = 0; l < control.levels; ++l) {
    PolygonLevel level;
    write_origins(mesh, level);
    OpenMesh::Subdivider::Uniform::CatmullClarkT<PolyMesh, double> catmull_clark;
    catmull_clark.attach(mesh);
    catmull_clark(1);
    catmull_clark.detach();
    for (const auto vertex : mesh.vertices()) {
      for (int axis = 0; axis < 3; ++axis) level.positions.push_back(mesh.point(vertex)[axis]);
    }
    levels.push_back(std::move(level));
  }
  return levels;
}

rust::String openmesh_version() {
  return std::to_string(OM_GET_VER) + "." + std::to_string(OM_GET_MAJ);
}

}  // namespace reference
