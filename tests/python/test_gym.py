"""Environments of gymnasium: what gymnasium asks of them, against its own vector environment."""

import copy
import warnings

import der
import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from der.gym import RodEnv, RodVectorEnv, Task  # noqa: E402
from der.gym.finger_reach import REACHING  # noqa: E402
from gymnasium.spaces import Box, Dict, Discrete, MultiBinary, MultiDiscrete, Tuple  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import AutoresetMode, SyncVectorEnv  # noqa: E402

ARM = {
    "title": "An arm on a motor, with a muscle",
    "rods": [
        {
            "name": "arm",
            "nodes": 7,
            "from": [0, 0],
            "to": [0.5, 0],
            "cross_section": {"circle": {"radius": 0.01}},
            "material": {"youngs_modulus": 3e7, "density": 1000},
        }
    ],
    "supports": [{"rod": "arm", "at": "start", "clamp": True, "prescribe": {"angle": 0}}],
    "actuation": [{"name": "muscle", "rod": "arm", "natural_curvature": 0}],
    "loads": [
        {"gravity": [0, -9.81]},
        {"damping": {"coefficient": 2}},
        {"name": "pull", "point_force": {"rod": "arm", "at": "end", "force": [0, 0]}},
    ],
    "start_from": "equilibrium",
    "time": {"duration": 0.1, "step": 0.005, "integrator": "implicit_euler"},
}
STATIC = {key: ARM[key] for key in ("title", "rods", "supports")} | {"analysis": "static"}

ADAPTIVE = ARM | {"time": {"duration": 1, "tolerance": 1e-3}}


def act(batch, actions):
    """Motor, muscle, a named load and a force: everything that can be set."""
    batch.prescribe(0, angle=0.2 * actions[:, 0])
    batch.set("muscle", 2.0 * actions[:, 1], over=0.01)
    batch.set("pull", 0.05 * actions[:, :2])
    batch.extra_force[:, -1, 1] = 0.1 * actions[:, 0]


def observe(batch):
    tips = np.concatenate([batch.positions[:, -1], batch.velocities[:, -1]], axis=1)
    return np.concatenate([tips, batch.drawn, batch.value("muscle")[:, None]], axis=1)


def reward(batch, actions):
    off = batch.positions[:, -1] - batch.drawn
    return -(off[:, 0] ** 2) - off[:, 1] ** 2 - 1e-3 * actions[:, 0] ** 2


def draw(generator):
    return generator.uniform([0.4, -0.1], [0.5, 0.1])


def noise(batch, member, generator):
    batch.velocities[member, 1:] += 0.05 * generator.standard_normal((6, 2))


def reaching(**changes):
    given = {
        "scene": copy.deepcopy(ARM),
        "action_space": Box(-1.0, 1.0, (2,), np.float64),
        "act": act,
        "observe": observe,
        "reward": reward,
        "draw": draw,
        "noise": noise,
        "steps_per_action": 2,
    }
    return Task(**given | changes)


def push(batch, actions):
    """Forces at which no step has a solution, where an action is close to 1."""
    batch.extra_force[:, -1, 0] = np.where(actions[:, 0] > 0.9, -1e12, 0.0)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_gymnasium_finds_no_fault(dtype):
    space = Box(-np.inf, np.inf, (7,), dtype)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_env(RodEnv(reaching(observation_space=space)), skip_render_check=True)
    complaints = [str(one.message) for one in caught]
    # Only what it says of every environment like those of MuJoCo, with unbounded observations.
    assert [text for text in complaints if "infinity" not in text and "registry" not in text] == []


def played(envs, actions, seed=7):
    """Everything that a vector environment returns."""
    said = [envs.reset(seed=seed)]
    said += [envs.step(row) for row in actions]
    return said


def assert_same(first, second):
    if isinstance(first, dict):
        assert first.keys() == second.keys()
        for key in first:
            assert_same(first[key], second[key])
    elif isinstance(first, tuple):
        assert len(first) == len(second)
        for one, other in zip(first, second, strict=True):
            assert_same(one, other)
    elif isinstance(first, np.ndarray) and first.dtype != object:
        assert first.dtype == second.dtype
        assert first.tobytes() == second.tobytes()
    elif isinstance(first, np.ndarray):
        for one, other in zip(first, second, strict=True):
            assert_same(one, other)
    else:
        assert first == second


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("threads", [1, 3])
def test_many_are_each_what_one_is(mode, threads):
    """Observations, rewards, ends, infos: bit for bit those of gymnasium's loop over `RodEnv`."""
    task, members = reaching(), 5
    actions = np.random.default_rng(1).uniform(-1, 1, (25, members, 2))
    loop = SyncVectorEnv([lambda: RodEnv(task)] * members, autoreset_mode=mode)
    envs = RodVectorEnv(task, members, threads, autoreset_mode=mode)
    for one, other in zip(played(envs, actions), played(loop, actions), strict=True):
        assert_same(one, other)
    assert envs.observation_space == loop.observation_space
    assert envs.action_space == loop.action_space
    assert envs.metadata["autoreset_mode"] is mode


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_one_that_fails_is_told_and_stops_no_other(mode):
    task, members = reaching(act=push), 4
    actions = np.zeros((8, members, 2))
    actions[2, 1, 0] = actions[5, 3, 0] = 1.0
    loop = SyncVectorEnv([lambda: RodEnv(task)] * members, autoreset_mode=mode)
    envs = RodVectorEnv(task, members, autoreset_mode=mode)
    said = played(envs, actions)
    for one, other in zip(said, played(loop, actions), strict=True):
        assert_same(one, other)
    observations, _, terminated, truncated, infos = said[3]
    assert terminated.tolist() == [False, True, False, False]
    assert not truncated.any()
    assert np.isfinite(observations).all()
    told = infos["final_info"] if mode is AutoresetMode.SAME_STEP else infos
    assert told["failure"][1] == "not_converged"
    assert told["failure_message"][1]
    assert told["_failure"].tolist() == [False, True, False, False]


def test_resets_by_hand():
    task, members = reaching(max_steps=3), 3
    first, others = np.array([True, False, False]), np.array([False, True, True])
    both = (
        RodVectorEnv(task, members, autoreset_mode="Disabled"),
        SyncVectorEnv([lambda: RodEnv(task)] * members, autoreset_mode=AutoresetMode.DISABLED),
    )

    def same(call):
        one, other = (call(envs) for envs in both)
        assert_same(one, other)
        return one

    def step():
        return same(lambda envs: envs.step(np.zeros((members, 2))))[3].tolist()

    same(lambda envs: envs.reset(seed=[3, 1, 5]))
    assert step() == step() == [False, False, False]
    same(lambda envs: envs.reset(seed=4, options={"reset_mask": first}))
    assert step() == [False, True, True]
    envs = both[0]
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"of \[1, 2\] have ended"):
        envs.step(np.zeros((members, 2)))
    same(lambda envs: envs.reset(options={"reset_mask": others}))
    assert step() == [False, False, False]
    assert step() == [True, False, False]
    with pytest.raises(ValueError, match="reset_mask is an array of 3 truth values"):
        envs.reset(options={"reset_mask": [0, 1, 1]})
    with pytest.raises(ValueError, match="2 seeds for 3"):
        envs.reset(seed=[0, 1])


def test_values_of_the_scene_differ():
    task = reaching()
    moduli = [1e7, 3e7]
    path = "rods.arm.material.youngs_modulus"
    envs = RodVectorEnv(task, 2, vary={path: moduli})
    many, _ = envs.reset(seed=2)
    for member, modulus in enumerate(moduli):
        scene = der.Scenario.from_dict(ARM).with_(**{path: modulus})
        one, _ = RodEnv(reaching(scene=scene)).reset(seed=2 + member)
        assert_same(many[member], one)


def test_an_episode_is_truncated_at_the_duration_of_its_scene():
    """20 steps of the scene, 3 in an action: the sixth ends at 0.09 s, a seventh were too long."""
    for task, actions in ((reaching(steps_per_action=3), 6), (reaching(max_steps=2), 2)):
        env = RodEnv(task)
        env.reset(seed=0)
        ends = [env.step(np.zeros(2))[2:4] for _ in range(actions)]
        assert ends == [(False, False)] * (actions - 1) + [(False, True)]
        assert env.batch.time[0] == pytest.approx(actions * task.steps_per_action * 0.005)
        with pytest.raises(gymnasium.error.ResetNeeded):
            env.step(np.zeros(2))


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_durations_and_steps_of_the_scene_differ(mode):
    """Each environment is truncated where a `RodEnv` of its own scene is."""
    own = {"time.duration": [0.02, 0.06, 0.04, 0.04], "time.step": [0.005, 0.005, 0.01, 0.0025]}
    actions = np.random.default_rng(1).uniform(-1, 1, (16, 4, 2))
    scenes = [
        der.Scenario.from_dict(ARM).with_(**dict(zip(own, values, strict=True)))
        for values in zip(*own.values(), strict=True)
    ]
    tasks = [reaching(scene=scene) for scene in scenes]
    loop = SyncVectorEnv([lambda task=task: RodEnv(task) for task in tasks], autoreset_mode=mode)
    envs = RodVectorEnv(reaching(), 4, vary=own, autoreset_mode=mode)
    said = played(envs, actions)
    for one, other in zip(said, played(loop, actions), strict=True):
        assert_same(one, other)
    first = [
        next(i for i, step in enumerate(said[1:], 1) if step[3][member]) for member in range(4)
    ]
    assert first == [2, 6, 2, 8]


def test_no_environment_has_a_tolerance():
    times = [ARM["time"], ADAPTIVE["time"]]
    with pytest.raises(ValueError, match="the scene of environment 1 has steps of other lengths"):
        RodVectorEnv(reaching(max_steps=3), 2, vary={"time": times})


def test_a_task_may_end_an_episode():
    def nothing(batch, actions):
        return np.zeros(len(batch))

    third = reaching(terminate=lambda batch: batch.played == 3, reward=nothing, draw=None)
    env = RodEnv(third)
    assert env.observation_space.shape == (5,)
    env.reset(seed=0)
    assert [env.step(np.zeros(2))[2] for _ in range(3)] == [False, False, True]


def tips(batch):
    return batch.positions[:, -1]


def test_what_is_returned_is_kept():
    """The engine's memory goes on; what was returned does not."""
    env = RodEnv(reaching(observe=tips))
    first, _ = env.reset(seed=0)
    kept = first.copy()
    second = env.step(np.ones(2))[0]
    assert np.array_equal(first, kept)
    assert not np.array_equal(first, second)


def test_actions_may_be_numbers():
    def turn(batch, actions):
        batch.prescribe(0, angle=0.1 * (actions - 1.0))

    task = reaching(action_space=Discrete(3), act=turn, reward=lambda batch, actions: 1.0 * actions)
    env, envs = RodEnv(task), RodVectorEnv(task, 2)
    env.reset(seed=0)
    envs.reset(seed=0)
    assert env.step(2)[1] == 2.0
    assert envs.step(np.array([2, 0]))[1].tolist() == [2.0, 0.0]


@pytest.mark.parametrize(
    ("space", "good", "bad", "says"),
    [
        (Box(-1, 1, (2,)), [7.0, 0.0], [0.0, np.nan], "its numbers must be finite"),
        (Box(-1, 1, (2,)), [0, 1], [-np.inf, 0.0], "its numbers must be finite"),
        (Discrete(3), 2, 3, r"is 3: it must be one of Discrete\(3\)"),
        (Discrete(3), 0, -1, "is -1: it must be one of"),
        (
            Discrete(3),
            0,
            1.5,
            r"actions are whole numbers of Discrete\(3\), got an array of floats",
        ),
        (Discrete(3, start=-1), -1, 2, "must be one of"),
        (MultiDiscrete([2, 3]), [1, 2], [2, 0], r"must be one of MultiDiscrete\(\[2 3\]\)"),
        (MultiBinary(2), [True, False], [2, 0], "must be one of MultiBinary"),
        (Box(-1, 1, (2,)), [0.5, 0.5], ["a", "b"], "actions are numbers, got an array of <U"),
    ],
)
def test_actions_that_nobody_can_take(space, good, bad, says):
    """They moved nothing, or made a member fail; choices beyond the last one were taken."""

    def nothing(batch, actions):
        assert np.array_equal(actions[0], good)
        batch.extra_force[:] = 0.0

    task = reaching(action_space=space, act=nothing, reward=lambda batch, _: np.zeros(len(batch)))
    env, envs = RodEnv(task), RodVectorEnv(task, 2)
    env.reset(seed=0)
    envs.reset(seed=0)
    with pytest.raises(ValueError, match=says):
        env.step(bad)
    with pytest.raises(ValueError, match=says) as caught:
        envs.step([good, bad])
    if " array of " not in says:
        assert "the action of environment 1 is" in str(caught.value)
    assert not envs.batch.played.any()
    env.step(good)
    envs.step([good, good])


@pytest.mark.parametrize(
    ("ends", "good"),
    [
        (lambda batch: [True] * len(batch), True),
        (lambda batch: np.ones(len(batch), np.uint8), True),
        (lambda batch: np.ones(len(batch)), False),
        (lambda batch: np.full(len(batch), np.nan), False),
        (lambda batch: [2] * len(batch), False),
        (lambda batch: [None] * len(batch), False),
        (lambda batch: ["yes"] * len(batch), False),
    ],
)
def test_ends_are_truth_values(ends, good):
    env = RodEnv(reaching(terminate=ends))
    env.reset(seed=0)
    if good:
        assert env.step(np.zeros(2))[2] is True
    else:
        with pytest.raises(ValueError, match=r"terminate returned .*: it returns truth values"):
            env.step(np.zeros(2))


@pytest.mark.parametrize("action", [0.5, [0.5], [0.5, 0.5, 0.5], [[0.5, 0.5]]])
def test_actions_of_another_shape_are_refused(action):
    env = RodEnv(reaching())
    env.reset(seed=1)
    with pytest.raises(ValueError, match=r"an action has the shape \(2,\), got"):
        env.step(action)


@pytest.mark.parametrize("shape", [(), (2,), (3,), (1, 2), (2, 2), (3, 1), (3, 4)])
def test_actions_of_another_shape_are_refused_of_many(shape):
    envs = RodVectorEnv(reaching(), 3)
    envs.reset(seed=1)
    with pytest.raises(ValueError, match=r"actions have the shape \(3, 2\), one of each .* got"):
        envs.step(np.zeros(shape))
    assert not envs.batch.played.any()


def test_gymnasium_makes_them_by_name():
    task = reaching()
    gymnasium.register(
        id="der-test/Reaching-v0",
        entry_point=lambda: RodEnv(task),
        vector_entry_point=lambda num_envs: RodVectorEnv(task, num_envs),
    )
    try:
        env = gymnasium.make("der-test/Reaching-v0")
        envs = gymnasium.make_vec("der-test/Reaching-v0", num_envs=2)
        (one, _), (many, _) = env.reset(seed=3), envs.reset(seed=3)
        assert_same(one, many[0])
    finally:
        del gymnasium.registry["der-test/Reaching-v0"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"observe": lambda batch: batch.positions[0]}, r"observe returned the shape \(7, 2\)"),
        ({"observation_space": Box(-1, 1, (3,))}, r"has the shape \(7,\), but .* space is \(3,\)"),
        ({"scene": ADAPTIVE}, "equal time steps, .* give it 'step' in place of 'tolerance'"),
        ({"scene": ADAPTIVE, "max_steps": 3}, "an action lasts a number of equal time steps"),
        (
            {"scene": ARM | {"time": {"duration": 0.005, "step": 0.005}}},
            "environment 0 ends after 1 of the 2 time steps of an action: give it a longer",
        ),
        (
            {"scene": STATIC, "max_steps": 3},
            "an episode is a run over time, and the scene is static",
        ),
        ({"max_steps": 0}, "max_steps must be a whole number of at least 1, got 0"),
        ({"steps_per_action": -1}, "steps_per_action must be a whole number of at least 1, got -1"),
    ],
)
def test_tasks_that_cannot_be_played(changes, message):
    with pytest.raises(ValueError, match=message):
        RodVectorEnv(reaching(**changes), 2)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"steps_per_action": 2.5}, "steps_per_action must be a whole number of at least 1"),
        ({"max_steps": "3"}, "max_steps must be a whole number of at least 1, got '3'"),
        ({"act": 5}, "act must be a function, got 5"),
        ({"observe": None}, "observe must be a function, got None"),
        ({"draw": 5}, "draw must be a function, got 5"),
        ({"action_space": 5}, "action_space must be a space of gymnasium"),
        (
            {"action_space": Dict({"a": Box(0, 1)})},
            "one of arrays or numbers, .* as gymnasium.spaces",
        ),
        ({"action_space": Tuple([Discrete(2)])}, "action_space must be one of arrays or numbers"),
        ({"observation_space": 5}, "observation_space must be a Box of gymnasium, got 5"),
    ],
)
def test_what_makes_no_task(changes, message):
    with pytest.raises(TypeError, match=message):
        reaching(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"reward": lambda *_: ["a"]}, r"reward returned \['a'\], which is no array of numbers"),
        ({"draw": lambda _: "a"}, "draw returned 'a', which is no array of numbers"),
        ({"draw": lambda _: None}, "draw returned None: it returns numbers of one shape"),
        ({"draw": lambda generator: np.zeros(generator.integers(1, 9))}, r"as the \(\d,\) of its"),
    ],
)
def test_what_the_functions_of_a_task_do_not_return(changes, message):
    def play():
        base = {"observe": tips, "reward": lambda batch, _: np.zeros(len(batch)), "noise": None}
        env = RodEnv(reaching(**base | changes))
        for seed in range(9):
            env.reset(seed=seed)
        env.step(np.zeros(2))

    with pytest.raises(ValueError, match=message):
        play()


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"num_envs": 2.5}, TypeError, "num_envs must be a whole number of at least 1, got 2.5"),
        ({"num_envs": 0}, ValueError, "num_envs must be a whole number of at least 1, got 0"),
        ({"autoreset_mode": "x"}, ValueError, "must be one of 'NextStep', 'SameStep', 'Disabled'"),
        ({"vary": 5}, TypeError, "vary must be a dict of key paths"),
        ({"task": 5}, TypeError, "an environment plays a der.gym.Task, got 5"),
    ],
)
def test_what_makes_no_environment(arguments, error, message):
    with pytest.raises(error, match=message):
        RodVectorEnv(**{"task": reaching(), "num_envs": 2} | arguments)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"seed": 1.5}, TypeError, "seed must be a whole number or a list of them, got 1.5"),
        ({"seed": -1}, ValueError, "seed must be a whole number of at least 0, got -1"),
        ({"seed": [1, 2.5]}, TypeError, "a seed must be a whole number of at least 0, got 2.5"),
        ({"options": 5}, TypeError, r'options must be a dict such as \{"reset_mask"'),
    ],
)
def test_what_resets_nothing(arguments, error, message):
    with pytest.raises(error, match=message):
        RodVectorEnv(reaching(), 2).reset(**arguments)


def test_seeds_of_numpy():
    envs = RodVectorEnv(reaching(), 2)
    assert_same(envs.reset(seed=np.array([3, 4]))[0], envs.reset(seed=3)[0])


def test_observations_of_a_shape_that_changes_are_refused():
    def growing(batch):
        return np.zeros((len(batch), 1 + batch.played[0]))

    task = reaching(observe=growing)
    env, envs = RodEnv(task), RodVectorEnv(task, 3)
    env.reset(seed=0)
    envs.reset(seed=0)
    for one, action in ((env, np.zeros(2)), (envs, np.zeros((3, 2)))):
        with pytest.raises(ValueError, match=r"has the shape \(2,\), but .* first call is \(1,\)"):
            one.step(action)


def test_rewards_of_another_shape_are_refused():
    envs = RodVectorEnv(reaching(reward=lambda batch, actions: actions), 2)
    with pytest.raises(gymnasium.error.ResetNeeded):
        envs.step(np.zeros((2, 2)))
    envs.reset(seed=0)
    with pytest.raises(ValueError, match=r"reward returned the shape \(2, 2\) for 2 members"):
        envs.step(np.zeros((2, 2)))


def test_warnings_of_the_scene_come_once():
    scene = copy.deepcopy(ARM)
    scene["rods"].append({**ARM["rods"][0], "name": "other", "from": [0.5, 0], "to": [1, 0]})
    scene["supports"].append({"rod": "other", "at": "end", "clamp": True})
    with pytest.warns(der.DerWarning) as caught:
        RodEnv(reaching(scene=scene, noise=None))
    assert len(caught) == len(der.Scenario.from_dict(scene).warnings) == 1


def test_a_scene_without_a_start_is_refused():
    scene = copy.deepcopy(ARM)
    scene["loads"][2]["point_force"]["force"] = [-1e9, 0]
    with pytest.raises(der.DerError):
        RodVectorEnv(reaching(scene=scene), 2)


def test_pictures_of_an_environment():
    env = RodEnv(REACHING, render_mode="rgb_array")
    assert env.metadata["render_fps"] == pytest.approx(20.0)
    env.reset(seed=3)
    first = env.render()
    assert first.shape == (480, 480, 3)
    assert first.dtype == np.uint8
    np.testing.assert_array_equal(env.render(), first)
    for _ in range(4):
        env.step(np.array([-1.0, 0.5]))
    second = env.render()
    # The rod is blue and the ring of the target orange: one has moved, the other has not.
    blue = [here[..., 2] > here[..., 0] + 30.0 for here in (first, second)]
    orange = [here[..., 0] > here[..., 1:].max(axis=-1) + 80.0 for here in (first, second)]
    assert blue[0].sum() > 500
    assert (blue[0] != blue[1]).sum() > 500
    assert orange[0].sum() > 20
    # Within the line's width, since the rod may be drawn over it.
    np.testing.assert_allclose(*(np.argwhere(one).mean(axis=0) for one in orange), atol=3.0)
    assert RodEnv(REACHING).render() is None
    with pytest.raises(ValueError, match="render_mode must be 'rgb_array' or None, got 'human'"):
        RodEnv(REACHING, render_mode="human")


def test_pictures_in_space(helix):
    """A strip that falls along z from a clamp: its picture moves down, and its clamp stays."""
    task = Task(
        scene=helix,
        action_space=Box(-1.0, 1.0, (1,), np.float64),
        act=lambda batch, actions: None,
        observe=lambda batch: batch.positions[:, -1],
        reward=lambda batch, actions: np.zeros(len(batch)),
        marks=lambda batch: batch.positions[:, :1],
        steps_per_action=30,
    )
    env = RodEnv(task, render_mode="rgb_array")
    env.reset(seed=1)
    pictures = [env.render()]
    env.step(np.zeros(1))
    pictures.append(env.render())
    assert (pictures[0] != pictures[1]).sum() > 200
    orange = [picture[..., 0] > picture[..., 2] + 30.0 for picture in pictures]
    assert min(one.sum() for one in orange) > 20
    np.testing.assert_allclose(*(np.argwhere(one).mean(axis=0) for one in orange), atol=1.0)


def test_gymnasium_makes_the_finger():
    env = gymnasium.make("der/FingerReach-v0", render_mode="rgb_array")
    seen, _ = env.reset(seed=7)
    expected, _ = RodEnv(REACHING).reset(seed=7)
    np.testing.assert_array_equal(seen, expected)
    assert env.render().shape == (480, 480, 3)
    envs = gymnasium.make_vec("der/FingerReach-v0", num_envs=3)
    seen, _ = envs.reset(seed=7)
    np.testing.assert_array_equal(seen[0], expected)
    truncated = [envs.step(np.zeros((3, 2)))[3].all() for _ in range(20)]
    assert truncated == [False] * 19 + [True]
