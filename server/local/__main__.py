"""`python -m server.local`: start everything that `make run` starts."""

from .launcher import main

main()
