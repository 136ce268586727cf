"""How the tests run: the same examples each time."""

import hypothesis

hypothesis.settings.register_profile("suite", deadline=None, derandomize=True, max_examples=60, database=None)
hypothesis.settings.load_profile("suite")
