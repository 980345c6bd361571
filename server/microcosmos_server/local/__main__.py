"""`python -m microcosmos_server.local`: start everything that `make run` starts."""

from microcosmos.loading import load

load("microcosmos_server.local.launcher").main()
