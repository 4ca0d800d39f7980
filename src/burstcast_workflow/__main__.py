"""``python -m burstcast_workflow``: the command ``burstcast``."""

import sys

from burstcast_workflow.command_line import main

sys.exit(main())
