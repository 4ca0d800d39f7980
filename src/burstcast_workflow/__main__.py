"""``python -m burstcast_workflow``: the command ``burstcast``."""

import sys

from burstcast_workflow.commands.command_line import main

sys.exit(main())
