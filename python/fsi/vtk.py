"""Converts a dump for ParaView: one .vtu file per frame, and a .pvd file that lists them with their
times."""

import base64
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from . import dump

_TYPES = {"f": "Float64", "i": "Int64", "u": "UInt8"}


def write(path, frame):
    """One frame as a .vtu file: particles as vertices; columns NAMEx, NAMEy (, NAMEz) as vectors,
    the others as scalars."""
    n = len(frame)
    points = np.zeros((n, 3))
    for k, axis in enumerate("xyz"):
        if axis in frame:
            points[:, k] = frame[axis]
    arrays = "".join(_array(name, values) for name, values in _fields(frame).items())
    cells = _array("connectivity", np.arange(n)) + _array("offsets", np.arange(1, n + 1)) + _array(
        "types", np.ones(n, np.uint8))
    Path(path).write_text(
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        'header_type="UInt64">\n'
        f'<UnstructuredGrid>\n<Piece NumberOfPoints="{n}" NumberOfCells="{n}">\n<PointData>\n'
        f'{arrays}</PointData>\n'
        f'<Points>\n{_array("points", points)}</Points>\n<Cells>\n{cells}</Cells>\n</Piece>\n'
        '</UnstructuredGrid>\n</VTKFile>\n')


def convert(path, folder=None, progress=None):
    """Converts a dump, frame by frame, into a folder named as the dump without its ending; returns
    the path of the .pvd file."""
    path = Path(path)
    name = path.name.removesuffix(".gz").rsplit(".", 1)[0]
    folder = Path(folder) if folder else path.parent / name
    listed = []
    for frame in dump.frames(path, progress=progress):
        if not listed:
            if "x" not in frame or "y" not in frame:
                raise ValueError(f"{path} has no columns x and y; it has "
                                 f"{', '.join(frame.columns)}")
            if folder.exists() and not folder.is_dir():
                raise ValueError(f"{folder}, where the pictures would go, is a file: name another "
                                 "folder behind the dump")
            folder.mkdir(parents=True, exist_ok=True)
        file = f"{name}.{frame.step:09d}.vtu"
        write(folder / file, frame)
        listed.append(f'<DataSet timestep="{frame.time!r}" file={quoteattr(file)}/>\n')
    if not listed:
        raise ValueError(f"{path} has no frames: is it a dump of LAMMPS (dump custom, dump_modify "
                         "time yes)?")
    index = folder / f"{name}.pvd"
    index.write_text('<VTKFile type="Collection" version="1.0">\n<Collection>\n' + "".join(listed)
                     + "</Collection>\n</VTKFile>\n")
    return index


def _fields(frame):
    """{name: scalars (n,) or vectors (n, 3)}"""
    found, rest = {}, [name for name in frame.columns if name not in ("x", "y", "z")]
    for name in rest:
        stem, axis = name[:-1], name[-1:]
        if stem and axis in "xyz" and stem + "x" in rest and stem + "y" in rest and stem not in (
            "sx", "sy", "sz"):
            if axis == "x":
                zero = np.zeros(len(frame))
                found[stem] = np.column_stack([frame[stem + a] if stem + a in frame else zero
                                               for a in "xyz"])
        else:
            found[name] = frame[name]
    return found


def _array(name, values):
    values = np.ascontiguousarray(values, dtype=np.asarray(values).dtype.newbyteorder("<"))
    data = values.tobytes()
    components = values.shape[1] if values.ndim == 2 else 1
    content = base64.b64encode(np.uint64(len(data)).astype("<u8").tobytes() + data).decode()
    return (f'<DataArray type="{_TYPES[values.dtype.kind]}" Name={quoteattr(name)} '
            f'NumberOfComponents="{components}" format="binary">'
            f"{content}</DataArray>\n")

