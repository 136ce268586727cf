"""The batch sampler: in data loaders, killed and resumed, and in several processes."""

import contextlib
import copy
import io
import os
import pickle
import signal
import tracemalloc
import warnings

import numpy
import pytest

torch = pytest.importorskip("torch")

import train
from torch.utils.data import DataLoader, TensorDataset

import noisefloor
from noisefloor.torch import ImportanceBatchSampler, cross_entropy_importance

# Each is new, though PyTorch is loaded once for all.
PROCESSES = torch.multiprocessing.get_context("forkserver")
PROCESSES.set_forkserver_preload(["noisefloor.torch"])


def run(sampler, workers=0, stop=None, loader=None):
    """What the loader gives in an epoch; each item is its own number, whose square is its importance."""
    data, seen = TensorDataset(torch.arange(sampler._n)), []
    for (items,) in loader or DataLoader(data, batch_sampler=sampler, num_workers=workers):
        index, weight = sampler.batch()
        assert torch.equal(index, items)
        sampler.update(items.float() ** 2)
        seen.append((index, weight))
        if len(seen) == stop:
            break
    return seen


def run_techniques(sampler):
    """An epoch's batches, of several techniques."""
    batches = []
    for _ in sampler:
        index, weight = sampler.batch()
        sampler.update(torch.stack([index, index + 1], 1))
        batches.append((index, weight))
    return batches


def equal(a, b):
    """Whether batches are the same, weights included."""
    return len(a) == len(b) and all(torch.equal(x, y) for p, q in zip(a, b) for x, y in zip(p, q))


@pytest.mark.parametrize("workers", [0, 2])
def test_the_first_epoch_visits_all_items_and_later_ones_the_important(workers):
    sampler = ImportanceBatchSampler(500, 32, seed=1)
    first = run(sampler, workers)
    assert len(first) == len(sampler) == 16 and sampler.epoch == 1
    assert set(torch.cat([index for index, _ in first]).tolist()) == set(range(500))
    assert all((weight == 1).all() for _, weight in first)
    later = [run(sampler, workers) for _ in range(4)][-1]
    index, weight = (torch.cat(parts) for parts in zip(*later))
    assert sampler.epoch == 5
    assert index.float().mean() > 300 and weight.max() <= 5
    # Two-sided, one false alarm in 150,000 seeds, and the seed is fixed.
    value = weight * index
    assert abs(value.mean() - 249.5) < 4.5 * value.std() / len(value) ** 0.5


def test_without_warmup_or_weights_and_with_other_steps():
    sampler = ImportanceBatchSampler(100, 10, warmup=None, steps=3)
    batches = run(sampler)
    assert len(batches) == 3 and sampler.epoch == 1
    table = noisefloor.Table(100)
    assert numpy.array_equal(batches[0][0].numpy(), table.draw(10)[0])
    sampler = ImportanceBatchSampler(100, 10, steps=25, weighted=False)
    assert all((weight == 1).all() for _, weight in run(sampler))
    # 10 batches of warm-up, though the epoch has 25.
    assert set(torch.cat([index for index, _ in run(ImportanceBatchSampler(100, 10, steps=25))[:10]]).tolist()) == set(
        range(100)
    )


@pytest.mark.parametrize("workers", [0, 2])
@pytest.mark.parametrize("stop", [1, 9, 16, 21, 32])
def test_a_loaded_state_goes_on_with_the_same_batches(workers, stop):
    whole = ImportanceBatchSampler(500, 32, seed=4)
    expected = run(whole, workers) + run(whole, workers)
    sampler = ImportanceBatchSampler(500, 32, seed=4)
    seen = run(sampler, workers, stop)
    seen += run(sampler, workers, stop - 16) if stop > 16 else []
    file = io.BytesIO()
    torch.save(sampler.state_dict(), file)
    file.seek(0)
    resumed = ImportanceBatchSampler(500, 32, seed=77)
    resumed.load_state_dict(torch.load(file, weights_only=True))
    assert resumed.epoch == stop // 16
    while resumed.epoch < 2:
        seen += run(resumed, workers)
    assert equal(seen, expected)


def test_a_refused_state_changes_nothing():
    sampler, same = (ImportanceBatchSampler(40, 4, seed=5, techniques=2, warmup=None) for _ in range(2))
    state = ImportanceBatchSampler(40, 4, seed=6, techniques=2, warmup=None).state_dict()
    damaged = state["tables"][1].clone()
    damaged[40] ^= 1
    for wrong, said in (
        ({**state, "tables": [state["tables"][0], damaged]}, "the state's table"),
        ({name: part for name, part in state.items() if name != "step"}, "the state has no 'step': it must be"),
        ({}, "the state has no 'n': it must be state_dict"),
    ):
        with pytest.raises(ValueError, match=said):
            sampler.load_state_dict(wrong)
    assert equal(run_techniques(sampler), run_techniques(same))


def test_a_state_is_loaded_in_place_and_leaves_what_the_constructor_was_told():
    state = ImportanceBatchSampler(1_000_000, 10, uniform_fraction=0.5, warmup=None).state_dict()
    sampler = ImportanceBatchSampler(1_000_000, 10, uniform_fraction=0.1, warmup=None)
    tracemalloc.start()
    sampler.load_state_dict(state)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 1e5
    assert abs(sampler._tables[0].uniform_fraction - 0.1) < 1e-6


def test_a_state_is_read_from_tensors_that_numpy_does_not_see():
    # As on another device, where `torch.load` may put them.
    sampler, other = ImportanceBatchSampler(100, 10, seed=2), ImportanceBatchSampler(100, 10)
    asked = [next(batches) for batches in [iter(sampler)] for _ in range(3)]
    state = sampler.state_dict()
    state["ahead"] = [(index, weight.requires_grad_(), first) for index, weight, first in state["ahead"]]
    other.load_state_dict(state)
    assert [next(batches) for batches in [iter(other)] for _ in range(3)] == asked


def test_copies_give_the_same_batches():
    sampler = ImportanceBatchSampler(100, 10, seed=2)
    run(sampler)
    copies = [copy.deepcopy(sampler), pickle.loads(pickle.dumps(sampler))]
    expected = run(sampler)
    assert all(equal(run(other), expected) for other in copies)


def test_spawned_workers_give_the_same_batches():
    data = TensorDataset(torch.arange(100))
    sampler, alone = ImportanceBatchSampler(100, 10, seed=2), ImportanceBatchSampler(100, 10, seed=2)
    loader = DataLoader(data, batch_sampler=sampler, num_workers=1, multiprocessing_context="spawn")
    assert [items.tolist() for (items,) in loader] == [index.tolist() for index, _ in run(alone)]


def test_neighbouring_seeds_share_no_draws():
    samplers = [ImportanceBatchSampler(1000, 8, seed=seed, techniques=4) for seed in range(3)]
    draws = {tuple(table.draw(8)[0]) for sampler in samplers for table in sampler._tables}
    assert len(draws) == 12


def test_workers_that_stay_give_the_same_batches():
    data, options = TensorDataset(torch.arange(500)), {"num_workers": 2, "prefetch_factor": 4}
    sampler, same = (ImportanceBatchSampler(500, 32, seed=4) for _ in range(2))
    staying = DataLoader(data, batch_sampler=sampler, persistent_workers=True, **options)
    for stop in (None, 5, None, None):
        fresh = DataLoader(data, batch_sampler=same, **options)
        assert equal(run(sampler, stop=stop, loader=staying), run(same, stop=stop, loader=fresh))
    assert sampler.epoch == same.epoch == 3


def test_leaving_an_epoch_begins_another():
    sampler = ImportanceBatchSampler(64, 8)
    run(sampler, 2, stop=3)
    assert len(run(sampler, 2)) == 8 and sampler.epoch == 1
    with pytest.raises(RuntimeError, match="there is none that it was not called for"):
        sampler.batch()


@pytest.mark.parametrize("workers", [0, 2])
def test_a_glance_at_a_batch_leaves_no_item_out(workers):
    sampler, loader = ImportanceBatchSampler(64, 8, seed=3), None
    loader = DataLoader(TensorDataset(torch.arange(64)), batch_sampler=sampler, num_workers=workers)
    next(iter(loader))
    assert set(torch.cat([index for index, _ in run(sampler, workers)]).tolist()) == set(range(64))


def test_batches_asked_for_beyond_the_first_visits_leave_no_item_out():
    sampler = ImportanceBatchSampler(80, 8, steps=25)
    asked = [next(batches) for batches in [iter(sampler)] for _ in range(13)]
    seen = [sampler.batch()[0].tolist() for _ in range(9)]
    next(iter(sampler))
    seen.append(sampler.batch()[0].tolist())
    assert seen == asked[:10] and set(sum(seen, [])) == set(range(80))


@pytest.mark.parametrize("workers", [0, 2])
def test_a_batch_left_out_is_told(workers):
    data = TensorDataset(torch.arange(200))
    sampler = ImportanceBatchSampler(data, 8)
    loader = DataLoader(data, batch_sampler=sampler, num_workers=workers)
    for k, (items,) in enumerate(loader):
        if k != 5:
            assert torch.equal(sampler.batch()[0], items) == (k < 5)
    assert sampler.epoch == 0
    with pytest.warns(RuntimeWarning, match="called for 24 of 25 batches"):
        batches = iter(loader)
        next(batches)
    sampler.batch()
    next(batches)
    (items,) = next(batches)
    for _ in range(2):  # what is refused changes nothing
        with pytest.raises(RuntimeError, match="these are not the items of batch 2 of 25: batch.. was left out, or"):
            sampler.batch(items.int())
    sampler.batch()
    assert sampler.batch(items.numpy())[0].tolist() == items.tolist()
    with pytest.raises(ValueError, match=r"index\[0\] is 200: it must be 0 to 199"):
        next(batches)
        sampler.batch([200])


@pytest.mark.parametrize("workers", [0, 2])
def test_one_loop_at_a_time(workers):
    data = TensorDataset(torch.arange(200))
    sampler = ImportanceBatchSampler(data, 8)
    loader = DataLoader(data, batch_sampler=sampler, num_workers=workers)
    with pytest.raises(RuntimeError, match="another loop over this sampler has begun, or a state"):
        for (items,) in loader:
            sampler.batch(items)
            assert len(run(sampler, loader=loader)) == 25
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        for stop in (3, 1, None, 2, None):
            run(sampler, stop=stop, loader=loader)
    assert sampler.epoch == 3


@pytest.mark.parametrize("workers", [0, 2])
def test_a_glance_after_loading_keeps_the_place(workers):
    data = TensorDataset(torch.arange(200))
    sampler, same = ImportanceBatchSampler(data, 8, seed=3), ImportanceBatchSampler(data, 8)
    run(sampler, workers, stop=20)
    same.load_state_dict(sampler.state_dict())
    loader = DataLoader(data, batch_sampler=same, num_workers=workers)
    for _ in range(2):
        next(iter(loader))
    sampler.load_state_dict(sampler.state_dict())
    rest = run(same, loader=loader)
    assert len(rest) == 5 and equal(rest, run(sampler, workers)) and same.epoch == 1
    assert equal(run(same, loader=loader), run(sampler, workers))


def test_a_loop_that_forgets_batch_ends():
    sampler = ImportanceBatchSampler(64, 8)
    loader = DataLoader(TensorDataset(torch.arange(64)), batch_sampler=sampler)
    with pytest.raises(RuntimeError, match=r"batch\(\) was not called .* `epoch` stays 0"):
        while sampler.epoch < 2:
            for _ in loader:
                pass


def finish(checkpoint, workers, techniques, kill_after=None):
    """Trains in a process of its own; kills it after so many steps. Returns the last that it said."""
    hears, says = PROCESSES.Pipe(duplex=False)
    process = PROCESSES.Process(target=train.main, args=(checkpoint, workers, techniques, says.send))
    process.start()
    says.close()
    steps, said = 0, ""
    while said in ("", "step"):
        said = hears.recv()
        steps += 1
        if steps == kill_after:
            process.kill()
            break
    process.join()
    assert process.exitcode == (-signal.SIGKILL if kill_after else 0)
    return said


@pytest.mark.parametrize("workers, techniques", [(0, 1), (2, 1), (0, 2)])
def test_killed_runs_end_as_others_do(tmp_path, workers, techniques):
    """kill -9 in the first epoch, at its end, and in the third: the same network and tables to the bit."""
    expected = finish(str(tmp_path / "whole"), workers, techniques)
    killed = str(tmp_path / "killed"), workers, techniques
    for steps in (7, 25, 50):
        assert finish(*killed, steps) == "step"
    assert finish(*killed) == expected and len(expected) == 64


def importances(reduction, techniques=1, scale=None, split="sign"):
    """A step's logits and labels, and what the table then holds."""
    sampler = ImportanceBatchSampler(200, 20, warmup=None, uniform_fraction=1, techniques=techniques, momentum=0)
    for (items,) in DataLoader(TensorDataset(torch.arange(200)), batch_sampler=sampler):
        index, weight = sampler.batch()
        torch.manual_seed(1)
        logits = torch.randn(20, 10, requires_grad=True)
        target = items % 10
        losses = weight * torch.nn.functional.cross_entropy(logits, target, reduction="none")
        ((scale or 1.0) * getattr(losses, reduction)()).backward()
        sampler.update_from(logits, reduction=reduction, scale=scale, split=split)
        break
    return sampler, index, logits, target


def test_any_numbers_update():
    """Of any type and stride, NumPy's that PyTorch has not and read-only ones included."""
    norms, index = numpy.array([3.0, 1.0, 2.0]), numpy.array([4, 5, 6])
    fixed = norms.astype(numpy.float32)
    fixed.setflags(write=False)
    expected = noisefloor.Table(10, importance=numpy.full(10, norms.mean()))
    expected.update(index, norms, 0.0)
    for of, at in (
        (norms.tolist(), index.tolist()),
        (norms[::-1].copy()[::-1], index.astype(numpy.uint32)),
        (fixed, index[::-1].copy()[::-1]),
        (torch.tensor(norms, requires_grad=True), torch.tensor(index)),
        (torch.tensor(norms).bfloat16(), torch.tensor(index).int()),
    ):
        sampler = ImportanceBatchSampler(10, 2)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            sampler.update(of, at)
        assert numpy.array_equal(sampler._tables[0].probabilities(), expected.probabilities())


@pytest.mark.parametrize("warmup", ["epoch", None])
def test_first_importances_are_not_averaged_with_what_all_items_begin_with(warmup):
    sampler = ImportanceBatchSampler(10, 2, warmup=warmup)
    if warmup:
        next(iter(sampler))
        sampler.batch()
    q = numpy.array([1e-3, 9e-3] + 8 * [1e-3])
    sampler.update(q, range(10))
    assert numpy.allclose(sampler._tables[0].probabilities(), 0.8 * q / q.sum() + 0.02)
    run(sampler)
    run(sampler, stop=1)
    before = sampler._tables[0].probabilities(5) - 0.02
    sampler.update([0.0], [5])
    assert 0.29 < (sampler._tables[0].probabilities(5) - 0.02) / before < 0.4


@pytest.mark.parametrize("techniques, wrong", [(1, float("inf")), (1, float("nan")), (2, float("inf"))])
def test_what_overflows_is_left_out_where_the_loss_was_scaled(techniques, wrong):
    sampler = ImportanceBatchSampler(8, 4, techniques=techniques)
    batches = iter(sampler)

    def step(scale=None, bad=(), norm=2.0):
        next(batches)
        index, weight = sampler.batch()
        logits = torch.zeros(4, 2, requires_grad=True)
        ((scale or 1.0) * (weight * norm * logits[:, 0]).mean()).backward()
        logits.grad[list(bad)] = wrong
        sampler.update_from(logits, scale=scale)
        return index

    step(2.0)
    index = step(1.0, [1], norm=4.0)  # a scale of 1 is one, too
    q = numpy.full(8, 2.0)  # the mean of the first report, which an item left out keeps
    q[index[[0, 2, 3]]] = 4
    assert numpy.allclose(sampler._tables[0].probabilities(), 0.8 * q / q.sum() + 0.025)
    batches = iter(sampler)
    before = sampler.probabilities()
    with pytest.raises(ValueError, match=r"^logits.grad\[1\] is not finite: .*; scale=1.0 leaves such items out$"):
        step(bad=[1, 3])
    assert torch.equal(sampler.probabilities(), before)


@pytest.mark.parametrize("techniques", [1, 2])
def test_without_warmup_the_scale_of_norms_does_not_matter(techniques):
    """The first report says what the others count as; two tables may have scales of their own."""
    norms, found = numpy.random.default_rng(2).lognormal(size=1000), []
    for scales in ([1, 1], [100, 0.001], [0.001, 0.001]):
        sampler = ImportanceBatchSampler(1000, 50, warmup=None, seed=3, techniques=techniques)
        for _ in range(10):
            next(iter(sampler))
            index, _ = sampler.batch()
            sampler.update((norms[index, None] * scales)[:, :techniques].squeeze())
            # Continued, it is not the first report again.
            sampler.load_state_dict(sampler.state_dict())
        found.append([table.probabilities() for table in sampler._tables])
    p = numpy.array(found)
    assert numpy.allclose(p[1:], p[0], rtol=1e-3)
    # What most have, for they were not drawn, is the mean's.
    assert 0.7 < 1000 * numpy.median(p[0]) < 1.3 and p[0].max() > 3 * p[0].min()


def test_reports_of_nothing_are_not_the_first():
    sampler = ImportanceBatchSampler(10, 2, warmup=None, uniform_fraction=0)
    for importance in ([], [0.0, 0.0], [1e-45, 0.0, 0.0], [30.0, 50.0]):  # the mean of the third is 0 as float32
        sampler.update(importance, range(len(importance)))
    q = numpy.array([30.0, 50.0] + 8 * [40.0])
    assert numpy.allclose(sampler.probabilities(), q / q.sum())
    # Each of two tables has a first report of its own, and keeps it.
    sampler = ImportanceBatchSampler(10, 2, warmup=None, uniform_fraction=0, techniques=2)
    for index, importance in enumerate(([5.0, 0.0], [3.0, 2.0])):
        sampler.update([importance], [index])
    p = [table.probabilities() for table in sampler._tables]
    q = numpy.array([5.0, 3.0] + 8 * [5.0])
    assert numpy.allclose(p[0], q / q.sum()) and numpy.allclose(p[1], 0.1)


def test_a_loaded_state_ends_a_loop():
    sampler = ImportanceBatchSampler(200, 8, seed=3)
    batches = iter(sampler)
    next(batches)
    sampler.load_state_dict(sampler.state_dict())
    with pytest.raises(RuntimeError, match="or a state was loaded: one loop at a time"):
        next(batches)
    assert len(run(sampler)) == 25


def test_probabilities_are_of_the_next_draw():
    sampler = ImportanceBatchSampler(4, 2, techniques=2, uniform_fraction=0.5)
    sampler.update([[1, 4], [1, 0], [1, 0], [1, 0]], range(4))
    p = sampler.probabilities()
    assert p.dtype == torch.float32 and torch.allclose(p, torch.tensor([0.4375, 0.1875, 0.1875, 0.1875]))
    assert repr(sampler) == "ImportanceBatchSampler(4, 2, steps=2, techniques=2, seed=0)"


class Other(torch.Tensor):
    """A tensor of another's class."""


def test_any_tensor_is_read():
    """Of a class of one's own, with derivatives, seen through a change of sign; or refused by the argument's name."""
    plain, index = noisefloor.Table(10), torch.tensor([4, 5])
    plain.update(index, torch.tensor([3.0, 1.0]))
    norms = torch.tensor([3.0, 1.0], requires_grad=True)
    for of in (norms.as_subclass(Other), norms.bfloat16().as_subclass(Other), torch.complex(norms, -norms).conj().imag):
        table = noisefloor.Table(10)
        table.update(index, of)
        assert numpy.array_equal(table.probabilities(), plain.probabilities())
    for of in (norms.detach().to_sparse(), norms.to("meta"), [norms[0], norms[1]]):
        with pytest.raises(TypeError, match="importance is no array of numbers: "):
            plain.update(index, of)
    with pytest.raises(TypeError, match="importance holds complex64: real numbers"):
        plain.update(index, torch.complex(norms, norms).conj())


def test_one_output_may_have_an_axis_or_none():
    found = []
    for shape in ((20,), (20, 1), (20, 1, 1)):
        sampler = ImportanceBatchSampler(50, 20, warmup=None, seed=3)
        next(iter(sampler))
        sampler.batch()
        logits = torch.arange(20.0).reshape(shape).requires_grad_()
        (logits**2).mean().backward()
        sampler.update_from(logits)
        found.append(sampler._tables[0].probabilities())
    assert numpy.array_equal(found[0], found[1]) and numpy.array_equal(found[0], found[2])
    assert found[0].max() > 1.5 * found[0].min()


@pytest.mark.parametrize("reduction", ["mean", "sum"])
def test_gradients_of_logits_are_the_softmaxs(reduction):
    sampler, index, logits, target = importances(reduction, scale=8.0)
    norms = cross_entropy_importance(logits, target)
    derivative = torch.softmax(logits, 1) - torch.nn.functional.one_hot(target, 10)
    assert torch.allclose(norms, derivative.norm(dim=1), rtol=1e-5)
    table = noisefloor.Table(200, importance=numpy.full(200, norms.mean().item()), uniform_fraction=0)
    table.update(index, norms, 0.0)
    sampler._tables[0].uniform_fraction = 0
    assert numpy.allclose(sampler._tables[0].probabilities(), table.probabilities(), rtol=1e-4)


@pytest.mark.parametrize("techniques, split", [(4, "sign"), (4, "norm"), (5, "norm"), (1, "norm")])
def test_several_techniques_are_of_groups_of_outputs(techniques, split):
    sampler, index, logits, target = importances("mean", techniques=techniques, split=split)
    derivative = (torch.softmax(logits, 1) - torch.nn.functional.one_hot(target, 10)).detach()
    for j, table in enumerate(sampler._tables):
        part = derivative[:, j::techniques]
        if split == "sign":
            part = (derivative if j % 2 == 0 else -derivative).clamp(min=0)[:, j // 2 :: 2]
        norms = part.norm(dim=1)
        other = noisefloor.Table(200, importance=numpy.full(200, norms.mean().item()), uniform_fraction=0)
        other.update(index, norms, 0.0)
        table.uniform_fraction = 0
        assert numpy.allclose(table.probabilities(), other.probabilities(), rtol=1e-4)


def test_a_large_ridge_gives_the_balance_heuristic():
    def drawn(**options):
        sampler = ImportanceBatchSampler(100, 10, warmup=None, techniques=2, seed=4, **options)
        sampler.update(numpy.random.default_rng(1).lognormal(size=(100, 2)), range(100))
        next(iter(sampler))
        index, weight = sampler.batch()
        mixture = numpy.mean([table.probabilities(index) for table in sampler._tables], 0)
        return numpy.abs(weight.numpy() * 100 * mixture - 1).max()

    assert drawn(ridge=1e8) < 1e-5 < 0.01 < drawn() < drawn(ridge=0.01)
    assert drawn(ridge=2) == drawn()


def test_several_techniques_weigh_and_learn():
    sampler = ImportanceBatchSampler(300, 32, techniques=4, seed=2)
    model = train.network(outputs=10)
    optimizer = torch.optim.SGD(model.parameters(), 0.05)
    data, means = TensorDataset(torch.randn(300, 8), torch.arange(300) % 10), []
    for _ in range(3):
        for x, y in DataLoader(data, batch_sampler=sampler):
            weight = sampler.batch()[1]
            train.step(model, optimizer, sampler, x, y, weight)
            means.append(weight.mean())
    assert abs(torch.stack(means[10:]).mean() - 1) < 0.1


def join(rank, world, file):
    """Meets the other processes."""
    torch.distributed.init_process_group("gloo", f"file://{file}", rank=rank, world_size=world)


def leave(results):
    """Ends this process, once what it says has been read."""
    results.close()
    results.join_thread()
    torch.distributed.barrier()
    # What PyTorch 1.13 does at its end can wait for ever for a process that has ended.
    os._exit(0)


def _replica(rank, world, file, workers, results):
    train.begin()
    join(rank, world, file)
    group = torch.distributed.new_group([0])
    if rank > 0:
        with pytest.raises(ValueError, match="process_group is .*: it must be one that this process belongs to"):
            ImportanceBatchSampler(train.ITEMS, train.BATCH, process_group=group)
    model = torch.nn.parallel.DistributedDataParallel(train.network())
    sampler = ImportanceBatchSampler(train.ITEMS, train.BATCH // world, seed=6)
    optimizer, seen = torch.optim.SGD(model.parameters(), 0.1), []
    for _ in range(2):
        for x, y in DataLoader(train.data(), batch_sampler=sampler, num_workers=workers):
            index, weight = sampler.batch()
            seen.append(index.tolist())
            train.step(model, optimizer, sampler, x, y, weight)
    results.put((rank, train.digest(model.module, sampler), seen))
    leave(results)


def together(target, world, *arguments):
    """What so many processes say of themselves, in the order of their ranks."""
    results = PROCESSES.Queue()
    processes = [PROCESSES.Process(target=target, args=(rank, world, *arguments, results)) for rank in range(world)]
    for process in processes:
        process.start()
    found = sorted(results.get(timeout=120) for _ in processes)
    for process in processes:
        process.join(60)
        process.kill()
    return found


@pytest.mark.parametrize("world, workers", [(2, 0), (2, 1), (4, 0)])
def test_replicas_stay_the_same_and_share_each_batch(tmp_path, world, workers):
    found = together(_replica, world, str(tmp_path / "meeting"), workers)
    assert len({digest for _, digest, _ in found}) == 1
    alone = ImportanceBatchSampler(train.ITEMS, train.BATCH, seed=6)
    first = [index for index, _ in run(alone)]
    shared = [torch.tensor(parts).T.flatten() for parts in zip(*(seen for _, _, seen in found))]
    assert equal([[batch] for batch in first], [[batch] for batch in shared[: len(first)]])


def _stray(rank, world, file, results):
    """What goes wrong in one process alone."""
    train.begin()
    early = ImportanceBatchSampler(640, 4)
    next(iter(early))
    join(rank, world, file)
    with pytest.raises(RuntimeError, match="make it after init_process_group"):
        early.batch()
    sampler = ImportanceBatchSampler(640, 4, warmup=None)
    batches = iter(sampler)

    def step(scale=None, bad=1.0):
        next(batches)
        index, weight = sampler.batch()
        logits = torch.ones(4, 1, requires_grad=True)
        ((scale or 1.0) * (weight * (index + 1) * logits[:, 0]).mean()).backward()
        logits.grad[2] *= bad if rank == 1 else 1
        sampler.update_from(logits, scale=scale)
        return index.tolist()

    step()
    left_out = step(2.0, float("inf"))[2]
    with pytest.raises(ValueError, match=r"^process 1's logits.grad\[2\] is not finite"):
        step(bad=float("nan"))
    with pytest.raises(ValueError, match=r"^process 1's importance\[3\] is nan: it must be"):
        sampler.update([1.0, 1.0, 1.0, float("nan") if rank == 1 else 1.0])
    results.put((rank, left_out, sampler._tables[0].probabilities().tolist()))
    if rank == 1:
        next(batches)
    step()
    for _ in range(2):
        with pytest.raises(RuntimeError, match="processes have parts of different batches"):
            step()
    leave(results)


def test_what_goes_wrong_in_one_process_is_known_to_all(tmp_path):
    (_, kept, p), (_, left_out, same) = together(_stray, 2, str(tmp_path / "meeting"))
    # Of the importances that all begin with, one is still that of most, and another is not.
    assert p == same and p[left_out] == max(p, key=p.count) != p[kept]


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda s: ImportanceBatchSampler(0, 1), "n is 0: it must be 1 to"),
        (lambda s: ImportanceBatchSampler(10, 0), "batch_size is 0"),
        (lambda s: ImportanceBatchSampler(10, 2, warmup="step"), "warmup is 'step': it must be one of 'epoch', None"),
        (lambda s: ImportanceBatchSampler(10, 6, techniques=4), "techniques is 4: it must be a divisor of the"),
        (lambda s: ImportanceBatchSampler(10, 6, momentum=2), "momentum is 2.0"),
        (lambda s: s.update(torch.ones(3)), r"importance has the shape \(3,\): it must be \(2,\)"),
        (lambda s: s.update(torch.tensor([1.0, float("nan")])), r"importance\[1\] is nan"),
        (lambda s: s.update(torch.tensor([1.0, 1e300], dtype=torch.float64)), r"importance\[1\] is 1e\+300"),
        (lambda s: s.update([1.0, 1e300]), r"importance\[1\] is 1e\+300"),
        (lambda s: s.update(torch.ones(2), [10, 1]), r"index\[0\] is 10: it must be 0 to 9"),
        (lambda s: s.update(1.0, 1), r"index has the shape \(\): it must be \(1,\)"),
        (lambda s: s.update_from(torch.ones(2, 3), scale=0), "scale is 0.0: it must be 1e-30 to 3.4e\\+38"),
        (lambda s: s.update_from(torch.ones(2, 3), scale="1"), "scale is '1': a number"),
        (lambda s: s.update(torch.tensor([1j, 1])), "importance holds complex64: real numbers"),
        (lambda s: s.update(None), "importance holds object: real numbers"),
        (lambda s: s.update_from(torch.ones(2, 3)), "call logits.retain_grad"),
        (lambda s: s.update_from((torch.ones(2, 3),)), "logits is a tuple: a tensor is expected"),
        (lambda s: s.update_from(differentiated(torch.float32, ())), r"logits has the shape \(\): \(batch_size, ...\)"),
        (lambda s: s.update_from(differentiated(torch.float32, (3,))), r"logits has the shape \(3,\): .* 2 items"),
        (lambda s: ImportanceBatchSampler("10", 2), "n is '10': an integer"),
        (lambda s: ImportanceBatchSampler([], 2), "n is 0: it must be 1 to"),
        (lambda s: ImportanceBatchSampler(10, 2, ridge=0), "ridge is 0.0: it must be 1e-08 to"),
        (lambda s: ImportanceBatchSampler(10, 2, process_group="all"), "process_group is given, but torch.distributed"),
        (lambda s: s.update_from(differentiated(torch.float32), split="half"), "split is 'half': it must be one of"),
        (lambda s: s.update_from(differentiated(torch.complex64)), "logits holds torch.complex64: real numbers"),
        (lambda s: s.load_state_dict(ImportanceBatchSampler(9, 2).state_dict()), "another sampler's: it has .*'n': 9"),
    ],
)
def test_refusals_name_argument_value_and_range(call, said):
    sampler = ImportanceBatchSampler(10, 2)
    next(iter(sampler))
    sampler.batch()
    with pytest.raises((ValueError, TypeError), match=said):
        call(sampler)


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), -1.0])
def test_a_refused_importance_of_one_technique_changes_no_other(bad):
    sampler = ImportanceBatchSampler(10, 2, techniques=2, warmup=None)
    next(iter(sampler))
    sampler.batch()
    before = [table.state_dict() for table in sampler._tables]
    with pytest.raises(ValueError, match=rf"importance\[0, 1\] is {bad}"):
        sampler.update(torch.tensor([[3.0, bad], [1.0, 1.0]]))
    logits = torch.ones(2, 3, requires_grad=True)
    logits.sum().backward()
    if bad != -1.0:
        logits.grad[0, 0] = bad
        with pytest.raises(ValueError, match=r"logits.grad\[0\] is not finite: the loss is not, or a GradScaler"):
            sampler.update_from(logits)
    after = [table.state_dict() for table in sampler._tables]
    assert all(numpy.array_equal(a["table"], b["table"]) for a, b in zip(before, after))


def differentiated(kind, shape=(2, 3)):
    """Outputs after a backward pass."""
    logits = torch.ones(shape, dtype=kind, requires_grad=True)
    logits.abs().sum().backward()
    return logits


@pytest.mark.parametrize(
    "techniques, split, said",
    [
        (1, "sign", None),
        (3, "sign", "techniques is 3: split must be 'norm' where it is odd"),
        (8, "sign", "techniques is 8: 3 outputs allow 6 with split='sign'"),
        (4, "norm", "techniques is 4: 3 outputs allow 3 with split='norm'"),
        (3, "norm", None),
    ],
)
def test_groups_have_outputs(techniques, split, said):
    sampler = ImportanceBatchSampler(48, 24, techniques=techniques)
    next(iter(sampler))
    sampler.batch()
    logits = torch.ones(24, 3, requires_grad=True)
    logits.sum().backward()
    with pytest.raises(ValueError, match=said) if said else contextlib.nullcontext():
        sampler.update_from(logits, split=split)


def test_labels_that_are_no_class_and_other_shapes_are_refused():
    for label in (-100, 3):
        with pytest.raises(ValueError, match=rf"target\[1\] is {label}: it must be 0 to 2"):
            cross_entropy_importance(torch.zeros(2, 3), torch.tensor([0, label]))
    logits, target = torch.arange(6.0).reshape(2, 3), torch.tensor([0, 2])
    for kind in (torch.uint8, torch.int16, torch.int32):
        same = cross_entropy_importance(logits, target.to(kind))
        assert torch.equal(same, cross_entropy_importance(logits, target))
    with pytest.raises(TypeError, match="target holds float32: integers are expected"):
        cross_entropy_importance(torch.zeros(2, 3), torch.zeros(2))
    with pytest.raises(TypeError, match="logits is a ndarray: a tensor is expected"):
        cross_entropy_importance(numpy.zeros((2, 3)), torch.tensor([0, 2]))
    with pytest.raises(TypeError, match="target is a list: a tensor is expected"):
        cross_entropy_importance(torch.zeros(2, 3), [0, 2])

    with pytest.raises(ValueError, match=r"logits has the shape \(2,\): it must be \(batch, classes\)"):
        cross_entropy_importance(torch.zeros(2), torch.tensor([0, 1]))
    for target in torch.tensor([0]), torch.zeros(2, 3):
        with pytest.raises(ValueError, match=r"target has the shape \(.*\): it must be \(2,\), a class"):
            cross_entropy_importance(torch.zeros(2, 3), target)


def test_what_comes_first_is_said():
    with pytest.raises(RuntimeError, match=r"call batch\(\) first"):
        ImportanceBatchSampler(10, 2).update(torch.ones(2))
