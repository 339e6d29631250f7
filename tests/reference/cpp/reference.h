// Functions of OpenMesh, OpenSubdiv, CGAL, CHOLMOD and Eigen as src/bindings.rs sees them.
#pragma once

#include <cstdint>
#include <memory>

#include "rust/cxx.h"

namespace reference {

using Positions = rust::Slice<const double>;  // x y z of each vertex
using Faces = rust::Slice<const std::uint32_t>;  // three corners of each triangle

struct MeshFacts;
struct Surface;
struct Measures;
struct Control;
struct PolygonLevel;
struct PolygonRefinement;
struct Tetrahedron;
struct DelaunayMesh;
struct Sampled;
struct Pieces;
struct Soup;
struct Shape;
struct IntrinsicEdges;

MeshFacts openmesh_facts(Positions positions, Faces faces);
Surface openmesh_loop(Positions positions, Faces faces);
Surface openmesh_butterfly(Positions positions, Faces faces);
rust::Vec<PolygonLevel> openmesh_catmull_clark(const Control& control);

PolygonRefinement opensubdiv_refine(const Control& control);
rust::Vec<double> opensubdiv_positions(const Control& control);

Measures cgal_measures(Positions positions, Faces faces);
rust::Vec<double> cgal_face_cotangents(Positions positions, Faces faces);
rust::Vec<double> cgal_cotangent_weights(Positions positions, Faces flaps);

Pieces cgal_pieces(Positions positions, Faces faces);
Soup cgal_soup(std::size_t vertices, Faces faces);
Shape cgal_shape(Positions positions, Faces faces);

rust::Vec<std::uint32_t> cgal_plane_delaunay(Positions points);
IntrinsicEdges cgal_intrinsic(Positions positions, Faces faces);

rust::Vec<double> cgal_harmonic(Positions positions, Faces faces, Positions places);
rust::Vec<double> cgal_lscm(Positions positions, Faces faces);
rust::Vec<double> cgal_mean_value(Positions positions, Faces faces);

rust::Vec<std::int8_t> cgal_orientations(Positions corners);
rust::Vec<Tetrahedron> cgal_tetrahedra(Positions corners);
DelaunayMesh cgal_delaunay(Positions positions);
rust::Vec<std::uint32_t> cgal_self_intersections(Positions positions, Faces faces);

double cgal_hausdorff(Positions from_positions, Faces from_faces, Positions to_positions,
                      Faces to_faces, double error);
Sampled cgal_sampled(Positions from_positions, Faces from_faces, Positions to_positions,
                     Faces to_faces, std::size_t count);

class Cholmod {
 public:
  Cholmod(rust::Slice<const std::size_t> starts, rust::Slice<const std::uint32_t> rows,
          rust::Slice<const double> values, bool metis);
  ~Cholmod();
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  void analyze();
  void factor();
  void solve(rust::Slice<const double> right_hand_sides, rust::Slice<double> solutions);
  std::size_t stored_values() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::unique_ptr<Cholmod> cholmod_lower(rust::Slice<const std::size_t> starts,
                                       rust::Slice<const std::uint32_t> rows,
                                       rust::Slice<const double> values, bool metis);

class Ldlt {
 public:
  Ldlt(rust::Slice<const std::size_t> starts, rust::Slice<const std::uint32_t> rows,
       rust::Slice<const double> values);
  ~Ldlt();

  void analyze();
  void factor();
  void solve(rust::Slice<const double> right_hand_sides, rust::Slice<double> solutions) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::unique_ptr<Ldlt> eigen_lower(rust::Slice<const std::size_t> starts,
                                  rust::Slice<const std::uint32_t> rows,
                                  rust::Slice<const double> values);
rust::String eigen_version();

double cpu_seconds();
rust::String cholmod_version();
rust::String cgal_version();
rust::String openmesh_version();
rust::String opensubdiv_version();

}  // namespace reference
