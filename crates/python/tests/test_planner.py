"""Questions over a map, held against the API's own documents."""

from __future__ import annotations

import numpy
import pytest

import joulepath

START, GOAL = (3.0, 10.0, 0.0), (27.0, 10.0)


def test_the_energy_minimal_path_goes_round_the_hill_and_the_shortest_over_it(planner):
    found = planner.compare(START, GOAL)
    assert found.energy.energy_j < 0.9 * found.distance.energy_j
    assert found.distance.distance_m < found.energy.distance_m
    assert found.saving_fraction == pytest.approx(1 - found.energy.energy_j / found.distance.energy_j)
    assert planner.plan(START, GOAL).energy_j == found.energy.energy_j


def test_columns_of_poses_are_the_documents(planner):
    path = planner.plan(START, GOAL)
    document = path.to_dict()
    assert len(document["poses"]) == path.poses.rows > 20
    for name, column in path.poses.items():
        told = [numpy.nan if pose[name] is None else pose[name] for pose in document["poses"]]
        numpy.testing.assert_array_equal(column, told)
    assert {"lon_deg", "lat_deg"} <= set(path.poses)
    assert path.poses["energy_j"][-1] == pytest.approx(path.energy_j)
    assert path.refined_poses is not None and path.refined_energy_j <= path.energy_j
    assert planner.plan(START, GOAL, refine=False).refined_poses is None


def test_places_are_tuples_arrays_or_the_documents_of_the_api(planner):
    energies_j = {
        planner.plan(start, goal).energy_j
        for start, goal in [
            (START, GOAL),
            (numpy.array(START), numpy.array(GOAL)),
            ({"x_m": 3.0, "y_m": numpy.float32(10.0), "heading_rad": 0.0}, {"x_m": 27, "y_m": 10}),
        ]
    }
    assert len(energies_j) == 1


def test_a_heavier_robot_needs_more(hill):
    husky = joulepath.Robot.builtin("husky-a200")
    light, heavy = (joulepath.Planner(hill, robot).plan(START, GOAL) for robot in (husky, husky.replace(mass_kg=140.0)))
    assert heavy.energy_j > 1.2 * light.energy_j


def test_a_matrix_has_the_plans_of_its_pairs(planner):
    places = [(3.0, 10.0), (27.0, 10.0), (15.0, 3.0)]
    found = planner.matrix(places)
    assert found.energy_j.shape == (3, 3) and numpy.all(numpy.diag(found.energy_j) == 0)
    one = planner.plan(places[0], places[1], refine=False, exact_ends=False)
    assert found.energy_j[0, 1] == pytest.approx(one.energy_j)
    assert found.to_xarray()["energy_j"].dims == ("source", "target")


def test_more_energy_reaches_more_ground(planner):
    found = planner.reachable((3.0, 10.0), energies_j=[300.0, 900.0])
    areas_m2 = [feature["properties"]["area_m2"] for feature in found.features]
    assert 0 < areas_m2[0] < areas_m2[1]
    frame = found.to_geodataframe()
    assert frame.crs == "EPSG:4326" and list(frame["energy_j"]) == [300.0, 900.0]


def test_battery_questions_answer(planner):
    there = planner.range(START, GOAL, charge=0.9, samples=200)
    both = planner.range(START, GOAL, charge=0.9, samples=200, return_=True)
    assert there.reachable and both.energy_j["p50"] > there.energy_j["p50"]
    mission = planner.mission(START, [GOAL, (15.0, 3.0)], samples=100)
    assert sorted(mission.order) == [0, 1] and mission.feasible


def test_alternatives_trade_time_for_energy(planner):
    paths = planner.alternatives(START, GOAL, against="distance", count=4).alternatives
    energies_j, lengths_m = ([getattr(path, name) for path in paths] for name in ("energy_j", "distance_m"))
    assert len(paths) >= 2 and numpy.all(numpy.diff(energies_j) * numpy.diff(lengths_m) < 0)


def test_paths_show_themselves(planner):
    path = planner.plan(START, GOAL)
    assert "<polyline" in path._repr_html_() and "energy_j" in path._repr_html_()
    frame = path.to_geodataframe()
    assert frame.crs == "EPSG:32632" and len(frame) == path.poses.rows and frame.geometry.iloc[0].has_z
    assert path.to_xarray()["x_m"].dims == ("pose",)


def test_paths_are_drawn(planner, tmp_path):
    import matplotlib

    matplotlib.use("agg")
    axes = planner.compare(START, GOAL).plot()
    axes.figure.savefig(tmp_path / "compared.png")
    assert len(axes.lines) == 6 and axes.get_xlabel() == "x [m]"
