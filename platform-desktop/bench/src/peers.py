"""Runs the bench's rivals that are Python packages.

Reads requests line by line on stdin, data following its line as raw little-endian bytes, and
answers each with one line: "ready WHAT" or "ms TIME" or "missing WHY".

    voxels N                        then N^3 bytes, 0 or 1: the next runs are edges and smooth
    mesh VERTICES TRIANGLES PITCH   then f32 and u32 triples: the next runs are fill
    edges | smooth | fill           one run
"""
import gc
import sys
import time


def contours(data, n):
    """VTK's surface of N^3 voxels; one empty voxel around them closes it, as ours is closed."""
    import numpy
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    vtk.vtkSMPTools.SetBackend("Sequential")
    voxels = numpy.pad(numpy.frombuffer(data, numpy.uint8).reshape(n, n, n), 1)
    image = vtk.vtkImageData()
    image.SetDimensions(n + 2, n + 2, n + 2)
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel(), deep=True))

    def edges():
        surface = vtk.vtkFlyingEdges3D()
        surface.SetInputData(image)
        surface.SetValue(0, 0.5)
        return surface

    def smooth():
        surface = edges()
        smoothed = vtk.vtkSmoothPolyDataFilter()
        smoothed.SetInputConnection(surface.GetOutputPort())
        smoothed.SetNumberOfIterations(2)
        smoothed.SetRelaxationFactor(0.5)
        return smoothed

    version = vtk.vtkVersion.GetVTKVersion()
    return {"edges": lambda: edges().Update, "smooth": lambda: smooth().Update}, version


def voxelizers(vertices, triangles, pitch):
    """trimesh's solid voxels of a mesh."""
    import numpy
    import trimesh

    mesh = trimesh.Trimesh(
        numpy.frombuffer(vertices, "<f4").reshape(-1, 3),
        numpy.frombuffer(triangles, "<u4").reshape(-1, 3),
    )

    def fill():
        return lambda: mesh.voxelized(pitch).fill()

    return {"fill": fill}, trimesh.__version__


def serve(requests):
    works = {}
    while line := requests.readline():
        name, *words = line.decode().split()
        data = []
        if name == "voxels":
            data = [requests.read(int(words[0]) ** 3)]
        elif name == "mesh":
            data = [requests.read(12 * int(count)) for count in words[:2]]
        try:
            if name == "voxels":
                works, version = contours(*data, int(words[0]))
                yield f"ready {version}"
            elif name == "mesh":
                works, version = voxelizers(*data, float(words[2]))
                yield f"ready {version}"
            else:
                work = works[name]()
                start = time.perf_counter()
                work()
                yield f"ms {(time.perf_counter() - start) * 1e3}"
        except Exception as error:
            yield "missing " + " ".join(f"{type(error).__name__}: {error}".split())


gc.disable()
for answer in serve(sys.stdin.buffer):
    print(answer, flush=True)
    gc.collect()
