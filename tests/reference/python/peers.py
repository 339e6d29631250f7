"""Times one library on arrays in a folder: a line of JSON on standard input, a line on standard output.

`peers.py PEER FOLDER` names a package below. A question is an object whose member `ask` is one of its
functions, or `version`; its other members are the arguments. The answer has the processor seconds of
each step, and what was found is in `result.npy`; or it has an error. Reading the arrays, imports and
conversions of the result are not timed; whatever a user of the package has to compute is.
"""

import json
import os
import sys
import time
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path

import numpy as np

import pursuit_peers

FOLDER = Path(sys.argv[2])
SECONDS = []


@contextmanager
def timed():
    """Times one step in the processor seconds of all threads of this process."""
    start = time.process_time()
    yield
    SECONDS.append(time.process_time() - start)


def mesh():
    vertices = np.load(FOLDER / "vertices.npy")
    faces = np.load(FOLDER / "faces.npy").astype(np.int64)
    return vertices, faces


def knots():
    return np.load(FOLDER / "knots.npy").astype(np.int64).ravel()


def flux_and_areas(laplacian, areas, vertices):
    """The positive Laplacian of the positions, and the areas, a row for each vertex."""
    return np.column_stack([laplacian @ vertices, areas])


# libigl


def igl_harmonic(order):
    import igl

    vertices, faces = mesh()
    known = knots()
    with timed():
        return igl.harmonic(vertices, faces, known, vertices[known], order)


def igl_min_quad(order):
    import igl
    import scipy.sparse as sparse

    vertices, faces = mesh()
    known = knots()
    zero = np.zeros((len(vertices), 3))
    with timed():
        laplacian = igl.cotmatrix(vertices, faces)
        mass = igl.massmatrix(vertices, faces, igl.MASSMATRIX_TYPE_VORONOI)
        inverse = sparse.diags(1.0 / mass.diagonal())
        matrix = -laplacian if order == 1 else (laplacian @ inverse @ laplacian).tocsc()
        data = igl.min_quad_with_fixed_data()
        none = sparse.csc_matrix((0, 0))
        igl.min_quad_with_fixed_precompute(matrix, known, none, True, data)
        found = igl.min_quad_with_fixed_solve(data, zero, vertices[known], np.zeros((0, 3)))
    with timed():
        igl.min_quad_with_fixed_solve(data, zero, 2.0 * vertices[known], np.zeros((0, 3)))
    return found


def igl_laplacian():
    import igl

    vertices, faces = mesh()
    with timed():
        laplacian = igl.cotmatrix(vertices, faces)
        mass = igl.massmatrix(vertices, faces, igl.MASSMATRIX_TYPE_VORONOI)
    return flux_and_areas(-laplacian, mass.diagonal(), vertices)


def igl_loop():
    import igl

    vertices, faces = mesh()
    with timed():
        found, _ = igl.loop(vertices, faces, 1)
    return found


# potpourri3d and robust_laplacian


def harmonic_by_splu(build):
    """Harmonic functions with a Laplacian that a package builds, by SciPy's SuperLU."""
    import scipy.sparse.linalg as solvers

    vertices, faces = mesh()
    known = knots()
    free = np.setdiff1d(np.arange(len(vertices)), known)
    found = vertices.copy()
    with timed():
        laplacian = build(vertices, faces).tocsc()
        rest = laplacian[free]
        factor = solvers.splu(
            rest[:, free].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        found[free] = factor.solve(-(rest[:, known] @ vertices[known]))
    with timed():
        factor.solve(-(rest[:, known] @ (2.0 * vertices[known])))
    return found


def potpourri3d_harmonic(order):
    import potpourri3d

    return harmonic_by_splu(potpourri3d.cotan_laplacian)


def potpourri3d_laplacian():
    import potpourri3d

    vertices, faces = mesh()
    with timed():
        laplacian = potpourri3d.cotan_laplacian(vertices, faces)
        areas = potpourri3d.vertex_areas(vertices, faces)
    return flux_and_areas(laplacian, areas, vertices)


def robust_harmonic(order):
    import robust_laplacian

    return harmonic_by_splu(lambda v, f: robust_laplacian.mesh_laplacian(v, f)[0])


def robust_laplacian_laplacian():
    import robust_laplacian

    vertices, faces = mesh()
    with timed():
        laplacian, mass = robust_laplacian.mesh_laplacian(vertices, faces)
    return flux_and_areas(laplacian, mass.diagonal(), vertices)


# PyMeshLab


def meshlab(subdivide):
    import pymeshlab

    vertices, faces = mesh()
    with timed():
        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(vertices, faces))
        subdivide(meshes)
        found = meshes.current_mesh().vertex_matrix()
        meshes.current_mesh().face_matrix()
    return found


def meshlab_loop():
    import pymeshlab

    def subdivide(meshes):
        # Every edge is split, as the other libraries do.
        none = pymeshlab.PercentageValue(0)
        meshes.meshing_surface_subdivision_loop(iterations=1, threshold=none)

    return meshlab(subdivide)


def meshlab_catmull_clark():
    return meshlab(lambda meshes: meshes.meshing_surface_subdivision_catmull_clark(iterations=1))


# Splines over the cube


def clamped(spans):
    return np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, spans + 1), np.ones(3)])


def samples():
    return tuple(np.load(FOLDER / f"{name}.npy") for name in ("parameters", "points", "tests"))


def scipy_least_squares(spans):
    """The normal equations of SciPy's design matrix by SuperLU."""
    import scipy.sparse.linalg as solvers
    from scipy.interpolate import NdBSpline

    parameters, points, tests = samples()
    knots = (clamped(spans),) * 3
    with timed():
        design = NdBSpline.design_matrix(parameters, knots, 3)
        factor = solvers.splu(
            (design.T @ design).tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        coefficients = factor.solve(design.T @ points)
    spline = NdBSpline(knots, coefficients.reshape(spans + 3, spans + 3, spans + 3, 3), 3)
    with timed():
        found = spline(tests)
    return found


def gismo_least_squares(spans):
    import pygismo

    parameters, points, tests = samples()
    vector = pygismo.nurbs.gsKnotVector(list(clamped(spans)), 3)
    with timed():
        basis = pygismo.nurbs.gsTensorBSplineBasis3(vector, vector, vector)
        fitting = pygismo.modelling.gsFitting(
            np.asfortranarray(parameters.T), np.asfortranarray(points.T), basis
        )
        fitting.compute(0.0)
        spline = fitting.result()
    with timed():
        found = spline.eval(np.asfortranarray(tests.T))
    return np.asarray(found).T


def pursue(name, count, sparsity):
    return pursuit_peers.solve_all(name, FOLDER, count, sparsity, timed)


PEERS = {
    "libigl": {
        "harmonic": igl_harmonic,
        "min_quad": igl_min_quad,
        "laplacian": igl_laplacian,
        "loop": igl_loop,
    },
    "potpourri3d": {"harmonic": potpourri3d_harmonic, "laplacian": potpourri3d_laplacian},
    "robust_laplacian": {"harmonic": robust_harmonic, "laplacian": robust_laplacian_laplacian},
    "pymeshlab": {"loop": meshlab_loop, "catmull_clark": meshlab_catmull_clark},
    "scipy": {"least_squares": scipy_least_squares},
    "pygismo": {"least_squares": gismo_least_squares},
    "spams-bin": {"pursue": pursue},
    "scikit-learn": {"pursue": pursue},
}

MODULES = {"libigl": "igl", "spams-bin": "spams", "scikit-learn": "sklearn"}


def answer(peer, question):
    asked = question.pop("ask")
    if asked == "version":
        __import__(MODULES.get(peer, peer))
        return {"version": metadata.version(peer)}
    SECONDS.clear()
    found = PEERS[peer][asked](**question)
    np.save(FOLDER / "result.npy", np.ascontiguousarray(found, dtype=float))
    return {"seconds": list(SECONDS)}


def main():
    # What libraries print, from C++ as well, goes where it disturbs no answer.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for line in sys.stdin:
        try:
            told = answer(sys.argv[1], json.loads(line))
        except Exception as error:  # A peer that fails is a row that says so.
            told = {"error": f"{type(error).__name__}: {str(error).strip()[:200]}"}
        print(json.dumps(told), file=answers, flush=True)


if __name__ == "__main__":
    main()
