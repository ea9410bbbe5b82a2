"""Processes, copies, and calls that are given up."""

import _thread
import copy
import multiprocessing
import pickle
import threading

import pytest

from lostmotion import Controllers, Joint, Motion, Plants, run_tests


def steps_in_child(queue):
    """Steps plants in another process."""
    try:
        plants = Plants("q1", n=64)
        plants.step(0.1, steps=100, record=())
        queue.put(plants.digests()[0])
    except RuntimeError as error:
        queue.put(str(error))


def answer_of_child(method):
    context = multiprocessing.get_context(method)
    queue = context.SimpleQueue()
    process = context.Process(target=steps_in_child, args=(queue,))
    process.start()
    process.join(60)
    hangs = process.is_alive()
    if hangs:
        process.kill()
    assert not hangs, "the child waits for threads of its parent"
    return queue.get()


def test_forked_child_is_refused_with_the_remedy():
    plants = Plants("q1", n=64)
    plants.step(0.1, steps=100, record=())
    answer = answer_of_child("fork")
    assert isinstance(answer, str) and "spawn" in answer and "fork" in answer
    assert answer_of_child("spawn") == plants.digests()[0]


def test_ctrl_c_while_waiting_stops_no_other_work():
    """A call waits for a thread's test; Ctrl-C gives up the call and leaves the test alone."""
    results = []
    other = threading.Thread(target=lambda: results.append(run_tests("hil/t1.toml", seed="1-3").passed))
    other.start()
    threading.Timer(0.5, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        run_tests("hil/random-plants.toml", full=True)
    other.join(300)
    assert results == [True]
    # The call that was given up does not run now.
    assert run_tests("hil/t1.toml", seed=1).passed


def test_joint_is_pickled_with_its_changes():
    joint = Joint("q1", {"half_backlash_um": 60})
    for same in (pickle.loads(pickle.dumps(joint)), copy.copy(joint), copy.deepcopy(joint)):
        assert (same.text, same.source, same.half_backlash_m) == (joint.text, joint.source, joint.half_backlash_m)


@pytest.mark.parametrize("kind", [Plants, Controllers])
@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, pickle.dumps], ids=["copy", "deepcopy", "pickle"])
def test_plants_and_controllers_refuse_a_copy_with_a_remedy(kind, duplicate):
    with pytest.raises(TypeError, match="make a new one"):
        duplicate(kind("q1", n=1))


def test_motions_are_compared_by_identity():
    import numpy as np

    motion = Motion(np.zeros(3))
    assert motion == motion and motion != Motion(np.zeros(3))
