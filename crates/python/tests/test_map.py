"""Maps from arrays and from other libraries."""

from __future__ import annotations

import json

import numpy
import pytest

import joulepath


def test_an_array_is_the_map_that_its_file_is(tmp_path):
    z_m = numpy.random.default_rng(2).uniform(0, 1, (8, 11)).round(3)
    names = numpy.where(z_m > 0.5, "grass", None)
    blocked = z_m > 0.9
    grid = {"cell_size_m": 0.5, "origin_m": [10, 20], "rows": 8, "columns": 11, "crs": "EPSG:32632"}
    grid |= {"elevation_m": z_m.tolist(), "surface": names.tolist(), "obstacle": blocked.tolist()}
    path = tmp_path / "yard.json"
    path.write_text(json.dumps(grid))
    array = joulepath.Map.from_array(z_m, 0.5, (10, 20), "EPSG:32632", surface=names, obstacle=blocked)
    file = joulepath.Map.open(path)
    assert array.id == file.id
    numpy.testing.assert_allclose(array.elevation_m, z_m, atol=1e-4)
    numpy.testing.assert_array_equal(array.obstacle, blocked)
    numpy.testing.assert_array_equal(array.surface, numpy.where(z_m > 0.5, "grass", ""))


@pytest.mark.parametrize("dtype", [numpy.float32, numpy.int16, numpy.uint8])
def test_numbers_of_any_type_and_layout_are_elevations(dtype):
    z = numpy.arange(12).reshape(3, 4).astype(dtype)
    plain = joulepath.Map.from_array(z.astype(float), 1.0)
    assert joulepath.Map.from_array(z, 1.0).id == plain.id
    assert joulepath.Map.from_array(numpy.asfortranarray(z), 1.0).id == plain.id
    assert joulepath.Map.from_array(z[:, ::-1][:, ::-1], 1.0).id == plain.id


def test_rasterio_and_its_file_are_one_map(tmp_path):
    import rasterio
    from rasterio.transform import from_origin

    z_m = numpy.random.default_rng(3).uniform(100, 110, (20, 30)).astype(numpy.float32)
    z_m[4, 5] = -9999
    path = tmp_path / "dem.tif"
    profile = {"driver": "GTiff", "height": 20, "width": 30, "count": 1, "dtype": "float32", "nodata": -9999}
    with rasterio.open(path, "w", crs="EPSG:32632", transform=from_origin(500, 900, 2, 2), **profile) as out:
        out.write(z_m, 1)
    with rasterio.open(path) as dataset:
        array = joulepath.Map.from_rasterio(dataset)
    file = joulepath.Map.open(path)
    assert array.origin_m == file.origin_m == (500.0, 860.0) and array.crs == "EPSG:32632"
    numpy.testing.assert_allclose(array.elevation_m, file.elevation_m, atol=1e-4)
    assert numpy.isnan(array.elevation_m[15, 5]), "rows run from the south"


def test_xarray_gives_back_the_map(hill):
    again = joulepath.Map.from_xarray(hill.to_xarray())
    assert (again.shape, again.origin_m, again.cell_size_m, again.crs) == (hill.shape, (0.0, 0.0), 0.5, hill.crs)
    numpy.testing.assert_allclose(again.elevation_m, hill.elevation_m, atol=1e-4)
    northern_first = hill.to_xarray().isel(y=slice(None, None, -1))
    numpy.testing.assert_allclose(joulepath.Map.from_xarray(northern_first).elevation_m, hill.elevation_m, atol=1e-4)
