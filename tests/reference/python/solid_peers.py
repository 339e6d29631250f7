"""Answers questions about solids and surfaces: a line of JSON on standard input, a line on standard output.

A question is an object whose member `ask` names a function below; its other members are the
arguments. Numbers go both ways with all their digits. VTK and meshio read and write meshes, VTK
evaluates Bézier cells and measures hexahedra, SciPy evaluates tensor products. An exception ends it.
"""

import json
import sys
from importlib import metadata
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
from scipy.interpolate import NdBSpline
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import reference, vtkIdList, vtkPoints
from vtkmodules.vtkCommonDataModel import (
    VTK_BEZIER_HEXAHEDRON,
    VTK_BEZIER_QUADRILATERAL,
    VTK_BEZIER_TRIANGLE,
    VTK_HEXAHEDRON,
    VTK_TETRA,
    vtkCellArray,
    vtkPolyData,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersCore import vtkFeatureEdges
from vtkmodules.vtkFiltersVerdict import vtkMeshQuality
from vtkmodules.vtkIOLegacy import vtkUnstructuredGridWriter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

VTK_NAMES = {
    VTK_BEZIER_HEXAHEDRON: "bezier hexahedron",
    VTK_BEZIER_QUADRILATERAL: "bezier quadrilateral",
    VTK_BEZIER_TRIANGLE: "bezier triangle",
    VTK_HEXAHEDRON: "hexahedron",
    VTK_TETRA: "tetra",
}


def versions():
    return {name: metadata.version(name) for name in ["vtk", "meshio", "scipy"]}


def vtk_grid(path):
    """The grid of a `.vtu` file as VTK reads it."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    if reader.GetErrorCode() != 0 or reader.GetOutput().GetNumberOfCells() == 0:
        raise ValueError(f"VTK cannot read {path}: error {reader.GetErrorCode()}")
    return reader.GetOutput()


def vtk_reads(path):
    grid = vtk_grid(path)
    cells, corners = {}, vtkIdList()
    for cell in range(grid.GetNumberOfCells()):
        grid.GetCellPoints(cell, corners)
        ids = [corners.GetId(i) for i in range(corners.GetNumberOfIds())]
        cells.setdefault(VTK_NAMES[grid.GetCellType(cell)], []).append(ids)
    return {
        "points": vtk_to_numpy(grid.GetPoints().GetData()).tolist(),
        "cells": cells,
        "point_data": vtk_arrays(grid.GetPointData()),
        "cell_data": vtk_arrays(grid.GetCellData()),
    }


def vtk_arrays(data):
    arrays = [data.GetArray(i) for i in range(data.GetNumberOfArrays())]
    return {array.GetName(): vtk_to_numpy(array).tolist() for array in arrays}


def meshio_reads(path):
    mesh = meshio.read(path)
    cells = {}
    for block in mesh.cells:
        cells.setdefault(block.type, []).extend(block.data.tolist())
    return {
        "points": mesh.points.tolist(),
        "cells": cells,
        "point_data": {name: array.tolist() for name, array in mesh.point_data.items()},
        "cell_data": {
            name: np.concatenate(blocks).tolist() for name, blocks in mesh.cell_data.items()
        },
    }


def bezier_points(path, places):
    """Points of Bézier cells of a `.vtu` file; a place is a cell and three parameters in it."""
    grid, points = vtk_grid(path), []
    for index, *parameters in places:
        cell = grid.GetCell(index)
        if not VTK_NAMES.get(cell.GetCellType(), "").startswith("bezier"):
            raise ValueError(f"cell {index} is a {cell.GetClassName()}")
        point, weights = [0.0] * 3, [0.0] * cell.GetNumberOfPoints()
        cell.EvaluateLocation(reference(0), parameters, point, weights)
        points.append(point)
    return points


def unstructured(points, cells, kind):
    """VTK's grid of cells of one kind."""
    grid, places = vtkUnstructuredGrid(), vtkPoints()
    places.SetDataTypeToDouble()
    places.SetData(numpy_to_vtk(np.array(points, dtype=float), deep=True))
    grid.SetPoints(places)
    for cell in cells:
        grid.InsertNextCell(kind, len(cell), cell)
    return grid


def hexahedra_quality(points, cells):
    """Volumes and scaled Jacobians of hexahedra by Verdict."""
    grid, found = unstructured(points, cells, VTK_HEXAHEDRON), {}
    for name in ["Volume", "ScaledJacobian"]:
        quality = vtkMeshQuality()
        quality.SetInputData(grid)
        getattr(quality, f"SetHexQualityMeasureTo{name}")()
        quality.Update()
        values = quality.GetOutput().GetCellData().GetArray("Quality")
        found[name] = vtk_to_numpy(values).tolist()
    return found


def non_manifold_edges(points, soups):
    """Edges of more than two triangles, the smaller point first, of each list of triangles."""
    return [non_manifold_edges_of(points, faces) for faces in soups]


def non_manifold_edges_of(points, faces):
    surface, places, triangles = vtkPolyData(), vtkPoints(), vtkCellArray()
    places.SetDataTypeToDouble()
    places.SetData(numpy_to_vtk(np.array(points, dtype=float), deep=True))
    surface.SetPoints(places)
    for face in faces:
        triangles.InsertNextCell(len(face), face)
    surface.SetPolys(triangles)
    numbers = numpy_to_vtk(np.arange(len(points), dtype=float), deep=True)
    numbers.SetName("number")
    surface.GetPointData().AddArray(numbers)
    filter = vtkFeatureEdges()
    filter.SetInputData(surface)
    filter.NonManifoldEdgesOn()
    filter.BoundaryEdgesOff()
    filter.FeatureEdgesOff()
    filter.ManifoldEdgesOff()
    filter.Update()
    found, ends, edges = filter.GetOutput(), vtkIdList(), []
    for line in range(found.GetNumberOfLines()):
        found.GetCellPoints(line, ends)
        number = found.GetPointData().GetArray("number")
        edges.append(sorted(int(number.GetValue(ends.GetId(i))) for i in range(2)))
    return edges


def write_tetrahedra(folder, points, cells):
    """Writes tetrahedra in every way that VTK and meshio have, and returns the names of files."""
    written = []

    def path(name):
        written.append(name)
        return str(Path(folder) / name)

    mesh = meshio.Mesh(np.array(points), [("tetra", np.array(cells))])
    for name, options in {
        "meshio.mesh": {"file_format": "medit"},
        "meshio.text22.msh": {"file_format": "gmsh22", "binary": False},
        "meshio.binary22.msh": {"file_format": "gmsh22", "binary": True},
        "meshio.text41.msh": {"file_format": "gmsh", "binary": False},
        "meshio.binary41.msh": {"file_format": "gmsh", "binary": True},
        "meshio.text.vtu": {"file_format": "vtu", "binary": False},
        "meshio.plain.vtu": {"file_format": "vtu", "compression": None},
        "meshio.zlib.vtu": {"file_format": "vtu", "compression": "zlib"},
        "meshio.text42.vtk": {"file_format": "vtk42", "binary": False},
        "meshio.binary42.vtk": {"file_format": "vtk42", "binary": True},
        "meshio.text51.vtk": {"file_format": "vtk", "binary": False},
        "meshio.binary51.vtk": {"file_format": "vtk", "binary": True},
        "meshio.node": {"file_format": "tetgen"},
    }.items():
        mesh.write(path(name), **options)
    grid = unstructured(points, cells, VTK_TETRA)
    for form in ["Ascii", "Binary", "Appended"]:
        for compressor in ["None", "ZLib"]:
            for bits in [32, 64]:
                name = f"vtk.{form}.{compressor}.{bits}.vtu".lower()
                vtk_writes_xml(grid, path(name), form, compressor, bits)
    for version in [42, 51]:
        for form in ["ASCII", "Binary"]:
            writer = vtkUnstructuredGridWriter()
            writer.SetFileName(path(f"vtk.{form}{version}.vtk".lower()))
            writer.SetInputData(grid)
            writer.SetFileVersion(version)
            getattr(writer, f"SetFileTypeTo{form}")()
            if writer.Write() != 1:
                raise ValueError(f"VTK cannot write {written[-1]}")
    return written


def vtk_writes_xml(grid, path, form, compressor, bits):
    """Writes a `.vtu` file in one of VTK's ways; the appended block is raw where it is 64 bits wide."""
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(path)
    writer.SetInputData(grid)
    getattr(writer, f"SetDataModeTo{form}")()
    getattr(writer, f"SetCompressorTypeTo{compressor}")()
    getattr(writer, f"SetHeaderTypeToUInt{bits}")()
    writer.SetEncodeAppendedData(bits == 32)
    if writer.Write() != 1:
        raise ValueError(f"VTK cannot write {path}")


def gismo_points(path, parameters):
    """Points of a `TensorBSpline3` in the XML of G+Smo, whose first index varies fastest."""
    geometry = ElementTree.parse(path).getroot().find("Geometry")
    if geometry.get("type") != "TensorBSpline3":
        raise ValueError(f"the geometry is a {geometry.get('type')}")
    bases = sorted(geometry.find("Basis").findall("Basis"), key=lambda b: int(b.get("index")))
    vectors = [basis.find("KnotVector") for basis in bases]
    knots = [np.array(vector.text.split(), dtype=float) for vector in vectors]
    degrees = [int(vector.get("degree")) for vector in vectors]
    sizes = [len(t) - p - 1 for t, p in zip(knots, degrees)]
    coefficients = geometry.find("coefs")
    dimension = int(coefficients.get("geoDim"))
    numbers = np.array(coefficients.text.split(), dtype=float)
    lattice = numbers.reshape(*reversed(sizes), dimension).transpose(2, 1, 0, 3)
    spline = NdBSpline(tuple(knots), np.ascontiguousarray(lattice), degrees, extrapolate=False)
    return {
        "domain": [[t[p], t[-p - 1]] for t, p in zip(knots, degrees)],
        "points": spline(np.array(parameters)).tolist(),
    }


def tensor_points(knots, lattice, parameters, orders):
    """Derivatives of a bicubic tensor product at parameters, for each pair of orders."""
    knots = tuple(np.array(vector) for vector in knots)
    spline = NdBSpline(knots, np.array(lattice), 3, extrapolate=False)
    at = np.array(parameters)
    return [spline(at, nu=pair).tolist() for pair in orders]


QUESTIONS = {
    function.__name__: function
    for function in [
        versions,
        vtk_reads,
        meshio_reads,
        bezier_points,
        hexahedra_quality,
        non_manifold_edges,
        write_tetrahedra,
        gismo_points,
        tensor_points,
    ]
}


def main():
    # What libraries print goes where it disturbs no answer.
    answers, sys.stdout = sys.stdout, sys.stderr
    for line in sys.stdin:
        question = json.loads(line)
        answer = QUESTIONS[question.pop("ask")](**question)
        print(json.dumps(answer), file=answers, flush=True)


if __name__ == "__main__":
    main()
