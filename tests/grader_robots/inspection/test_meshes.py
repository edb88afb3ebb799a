"""A mesh's file becomes a few triangles; what is none, or too much, becomes nothing."""

import base64
import io
from zipfile import ZipFile

import numpy as np
import pytest
from trimesh.resolvers import FilePathResolver

from grader_robots.inspection import meshes

ONE = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])


def binary(corners, begins: bytes = b"a mesh") -> bytes:
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    rows = np.zeros(len(corners), kind)
    rows["corners"] = corners
    return begins.ljust(80, b" ") + len(corners).to_bytes(4, "little") + rows.tobytes()


def in_words(corners) -> bytes:
    facets = [
        "facet normal 0 0 1\n outer loop\n"
        + "".join(f"  vertex {x:e} {y:e} {z:e}\n" for x, y, z in each)
        + " endloop\nendfacet\n"
        for each in corners
    ]
    return f"solid a\n{''.join(facets)}endsolid a\n".encode()


def read(folder, data: bytes, name: str = "a.stl"):
    (folder / name).write_bytes(data)
    told = meshes.surface(str(folder / name))
    return np.frombuffer(base64.b64decode(told), "<f4").reshape(-1, 3, 3)


@pytest.mark.parametrize(
    "data",
    [binary(ONE), binary(ONE, b"solid, it says"), in_words(ONE)],
    ids=["bits", "solid", "words"],
)
def test_stl_of_both_kinds_is_read(data, tmp_path):
    assert read(tmp_path, data, "a.STL").tolist() == ONE.tolist()


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"solid",
        binary(ONE)[:-1],
        binary(ONE[:0]),
        binary(np.full((1, 3, 3), np.nan)),
        binary(np.full((1, 3, 3), 3e38)),
        b"x" * 80 + b"\xff" * 4,
        b"vertex a b c\n" * 3,
        b"vertex 1 1 1\n" * 2,
    ],
)
def test_what_is_no_stl_is_nothing(data, tmp_path):
    assert len(read(tmp_path, data)) == 0


def test_what_is_too_large_or_not_there_or_an_archive_is_nothing(tmp_path, monkeypatch):
    assert meshes.surface(str(tmp_path / "none.stl")) == ""
    packed = io.BytesIO()
    with ZipFile(packed, "w") as archive:
        archive.writestr("a.stl", binary(ONE))
    assert len(read(tmp_path, packed.getvalue(), "a.zip")) == 0
    monkeypatch.setattr(meshes, "_MOST_BYTES", 100)
    assert len(read(tmp_path, binary(ONE))) == 0


def test_a_fine_mesh_becomes_coarse_and_keeps_its_shape(tmp_path):
    turns, tilts = np.meshgrid(np.linspace(0, 2 * np.pi, 150), np.linspace(-1.5, 1.5, 100))
    ball = np.stack(
        (np.cos(turns) * np.cos(tilts), np.sin(turns) * np.cos(tilts), np.sin(tilts)), -1
    )
    a, b, c = ball[:-1, :-1], ball[:-1, 1:], ball[1:, 1:]
    corners = np.stack((a, b, c), axis=2).reshape(-1, 3, 3)
    made = read(tmp_path, binary(corners))
    assert 300 < len(made) <= meshes.MOST_TRIANGLES
    assert np.abs(np.sqrt((made**2).sum(axis=2)) - 1).max() < 0.1


def test_another_kind_is_read_where_trimesh_is_without_the_files_that_it_names(
    tmp_path, monkeypatch
):
    asked = []
    monkeypatch.setattr(FilePathResolver, "get", lambda _, name: asked.append(name))
    for names in (b"", b"mtllib /dev/zero\nusemtl a\n"):
        obj = names + b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
        assert read(tmp_path, obj, "a.obj").tolist() == ONE.tolist()
    assert asked == []


def test_of_a_mesh_in_words_no_more_is_read_than_may_be(tmp_path, monkeypatch):
    monkeypatch.setattr(meshes, "_MOST_READ", 2)
    assert len(read(tmp_path, in_words(ONE.repeat(2, axis=0)))) == 2
    assert len(read(tmp_path, in_words(ONE.repeat(3, axis=0)))) == 0
