"""What a run leaves in its folder: one short file per kind of output, found by itself.

An output is a callback (``model.callbacks``) that is made with the run's folder and the model.
"""

from collections.abc import Callable
from pathlib import Path

from viscopoint.discovery import Registry, import_all
from viscopoint.model.build import Model
from viscopoint.model.callbacks import Callback

Make = Callable[[Path, Model], Callback]
OUTPUTS: Registry[Make] = Registry()  # classes or functions of a run folder and a model

import_all(__name__)
