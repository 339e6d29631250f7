// Facts and Loop subdivision by OpenMesh.
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/config.h>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>

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
  Mesh mesh;
  build(positions, faces, mesh);
  OpenMesh::Subdivider::Uniform::LoopT<Mesh, double> loop;
  loop.attach(mesh);
  loop(1);
  loop.detach();
  Surface surface;
  for (const auto vertex : mesh.vertices()) {
    for (int axis = 0; axis < 3; ++axis) surface.positions.push_back(mesh.point(vertex)[axis]);
  }
  for (const auto face : mesh.faces()) {
    for (const auto corner : face.vertices()) surface.faces.push_back(corner.idx());
  }
  return surface;
}

rust::String openmesh_version() {
  return std::to_string(OM_GET_VER) + "." + std::to_string(OM_GET_MAJ);
}

}  // namespace reference
