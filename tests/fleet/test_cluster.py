"""Work on two Ray nodes: nothing is lost, nothing comes twice, and nothing is handed over before there is room."""

import os
import signal
import threading
import time
import uuid

import pytest
from joulepath.fleet import FleetError, Ways
from joulepath.fleet.cluster import Lost, connected, spread
from nodes import OTHER


def outcomes(work, shared, pieces, **ways):
    with connected(Ways(**ways)) as ray:
        return list(spread(ray, Ways(**ways), work, shared, pieces))


def test_a_killed_worker_loses_nothing_and_counts_nothing_twice(cluster, tmp_path):
    def work(shared, piece):
        tries = len([name for name in os.listdir(shared) if name.startswith(f"{piece}-")])
        open(os.path.join(shared, f"{piece}-{uuid.uuid4()}"), "x").close()
        if piece == 2 and tries == 0:
            os.kill(os.getpid(), signal.SIGKILL)
        return piece * 10

    found = outcomes(work, str(tmp_path), range(5))
    assert sorted(found) == [(i, i * 10) for i in range(5)]
    tries = [name.partition("-")[0] for name in os.listdir(tmp_path)]
    assert tries.count("2") == 2


def test_a_piece_that_kills_its_worker_every_time_is_lost_by_name_and_alone(cluster):
    def work(shared, piece):
        if piece == 1:
            os.kill(os.getpid(), signal.SIGKILL)
        return piece

    found = dict(outcomes(work, None, range(3), retries=1))
    assert (found[0], found[2]) == (0, 2)
    assert isinstance(found[1], Lost) and "died every time" in str(found[1])


def test_what_is_out_of_reach_is_tried_again_and_what_is_wrong_is_not(cluster, tmp_path):
    def work(shared, piece):
        open(os.path.join(shared, f"{piece}-{uuid.uuid4()}"), "x").close()
        raise {0: OSError("no route to host"), 1: ValueError("no such thing")}[piece]

    found = dict(outcomes(work, str(tmp_path), range(2), retries=2))
    assert [str(found[i]) for i in range(2)] == ["OSError: no route to host", "ValueError: no such thing"]
    tries = [name.partition("-")[0] for name in os.listdir(tmp_path)]
    assert (tries.count("0"), tries.count("1")) == (3, 1)


def test_a_piece_that_hangs_is_lost_by_name_after_its_time_and_the_others_are_done(cluster):
    def work(shared, piece):
        if piece == 1:
            threading.Event().wait()
        if piece == 2:
            # Nothing reaches it: only the end of its worker ends it.
            signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGALRM])
            threading.Event().wait()
        return piece

    found = dict(outcomes(work, None, range(4), retries=0, task_timeout_s=1.0))
    assert (found[0], found[3]) == (0, 3)
    assert isinstance(found[1], Lost) and str(found[1]) == "it took longer than 1 s, the most that a task may take (task_timeout_s)"
    assert isinstance(found[2], Lost) and "took longer than 1 s" in str(found[2])


def test_no_more_is_under_way_than_may_be(cluster):
    handed, ended, most = 0, 0, 0

    def pieces():
        nonlocal handed
        for i in range(12):
            handed += 1
            yield i

    with connected(Ways(in_flight=3)) as ray:
        for _ in spread(ray, Ways(in_flight=3), lambda shared, piece: piece, None, pieces()):
            most = max(most, handed - ended)
            ended += 1
    assert (ended, most) == (12, 3)


def test_a_killed_node_loses_nothing_and_counts_nothing_twice(cluster):
    def work(shared, piece):
        import ray

        time.sleep(0.5)
        return ray.util.get_node_ip_address()

    with connected(Ways()) as ray:
        found = []
        for number, outcome in spread(ray, Ways(), work, None, range(16)):
            found.append(number)
            if outcome == OTHER and OTHER in cluster.nodes:
                cluster.kill(OTHER)
    assert OTHER not in cluster.nodes, "the second node was given work"
    assert sorted(found) == list(range(16))


@pytest.mark.parametrize("wrong", [{"cores_per_task": 0}, {"retries": -1}, {"in_flight": 0}, {"task_timeout_s": 0.0}, {"task_timeout_s": float("nan")}])
def test_ways_that_cannot_be_gone_are_refused(wrong):
    with pytest.raises(FleetError, match="must be (1 or more|a number of seconds above 0)"):
        Ways(**wrong).check()
