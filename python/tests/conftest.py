"""How the tests run: the same examples each time, one thread of PyTorch's."""

import hypothesis

hypothesis.settings.register_profile("suite", deadline=None, derandomize=True, max_examples=60, database=None)
hypothesis.settings.load_profile("suite")
