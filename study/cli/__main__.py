"""`python -m study.cli`, the same as `segue`."""

import sys

from study.cli import main

sys.exit(main())
